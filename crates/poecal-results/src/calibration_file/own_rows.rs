//! The files that a calibration was made of, where they still are.

use std::path::{Path, PathBuf};

use super::CalibrationFile;
use poecal_storage::hashes::sha256;

impl CalibrationFile {
    /// The measurement files of the calibration with the bytes that it was made of: as its inputs name them, or by these names from the folder
    /// of the file `at`, or of the one above it. `None` unless all are found.
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

    /// Whether the model's file is there, and has other bytes than those that were calibrated.
    #[must_use]
    pub fn has_another_model(&self, at: &Path) -> bool {
        let Some(expected) = self.inputs.sha256.get(&self.inputs.model) else { return false };
        let all = places(&self.inputs.model, at);
        // Not by its name alone: another robot's may lie there.
        let mut found = all[..3].iter().filter_map(|path| sha256(path).ok().flatten()).peekable();
        found.peek().is_some() && found.all(|it| it != *expected)
    }
}

/// Where a file that a calibration names may be: as it is named, or by its name from the folder of the calibration or the one above.
fn places(name: &str, at: &Path) -> [PathBuf; 5] {
    let folder = at.parent().unwrap_or(Path::new(""));
    let above = folder.parent().unwrap_or(Path::new(".."));
    let above = if folder.as_os_str().is_empty() { Path::new("..") } else { above };
    let named = Path::new(name);
    let last = named.file_name().map(Path::new).unwrap_or(named);
    [named.to_owned(), folder.join(named), above.join(named), folder.join(last), above.join(last)]
}
