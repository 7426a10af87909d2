//! The files that a calibration was made of, where they still are.

use std::path::{Path, PathBuf};

use super::CalibrationFile;
use crate::io::hashes::sha256;

impl CalibrationFile {
    /// The measurement files of the calibration with the bytes that it was made of: as its inputs name them, or by these names from the folder
    /// of the file `at`, or of the one above it. `None` unless all are found.
    #[must_use]
    pub fn own_measurements(&self, at: &Path) -> Option<Vec<PathBuf>> {
        let folder = at.parent().unwrap_or(Path::new(""));
        let above = folder.parent().unwrap_or(Path::new(".."));
        let above = if folder.as_os_str().is_empty() { Path::new("..") } else { above };
        let found = self.inputs.measurements.iter().map(|name| {
            let expected = self.inputs.sha256.get(name)?;
            let named = Path::new(name);
            let last = named.file_name().map(Path::new).unwrap_or(named);
            let all = [
                named.to_owned(),
                folder.join(named),
                above.join(named),
                folder.join(last),
                above.join(last),
            ];
            all.into_iter().find(|path| sha256(path).ok().flatten().as_ref() == Some(expected))
        });
        let found: Option<Vec<PathBuf>> = found.collect();
        found.filter(|all| !all.is_empty())
    }
}
