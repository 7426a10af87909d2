//! The files from which a calibration was made, if they still exist.

use std::path::{Path, PathBuf};

use super::CalibrationFile;
use poecal_storage::hashes::sha256;

impl CalibrationFile {
    /// The measurement files of the calibration with their original bytes. They are searched as its inputs name them, then by these names in the
    /// folder of the file `at`, and in the one above it. `None` unless all are found.
    #[must_use]
    pub fn own_measurements(&self, at: &Path) -> Option<Vec<PathBuf>> {
        let found = self.inputs.measurements.iter().map(|name| {
            let expected = self.inputs.sha256.get(name)?;
            let mut all = places(name, at).into_iter();
            all.find(|path| sha256(path).ok().flatten().as_ref() == Some(expected))
        });
        let found: Option<Vec<PathBuf>> = found.collect();
        found.filter(|all| !all.is_empty())
    }

    /// True if the model's file exists, and its bytes differ from those that were calibrated.
    #[must_use]
    pub fn has_another_model(&self, at: &Path) -> bool {
        let Some(expected) = self.inputs.sha256.get(&self.inputs.model) else { return false };
        let all = places(&self.inputs.model, at);
        // Not by its name alone: a file of another robot may have this name.
        let mut found = all[..3].iter().filter_map(|path| sha256(path).ok().flatten()).peekable();
        found.peek().is_some() && found.all(|it| it != *expected)
    }
}

/// Possible paths of a file that a calibration names: as it is named, or by its name from the folder of the calibration or the one above.
fn places(name: &str, at: &Path) -> [PathBuf; 5] {
    let folder = at.parent().unwrap_or(Path::new(""));
    let above = folder.parent().unwrap_or(Path::new(".."));
    let above = if folder.as_os_str().is_empty() { Path::new("..") } else { above };
    let named = Path::new(name);
    let last = named.file_name().map(Path::new).unwrap_or(named);
    [named.to_owned(), folder.join(named), above.join(named), folder.join(last), above.join(last)]
}
