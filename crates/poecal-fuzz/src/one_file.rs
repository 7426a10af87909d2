//! A disk with one file or a few, for functions that read only by path.

use std::sync::Arc;

use poecal_storage::disk::{self, PresetFiles};

/// Result of some work with a single file of this text at a path.
pub(crate) fn with_file<T>(path: &str, text: &str, work: impl FnOnce() -> T) -> T {
    with_files(&[(path, text.as_bytes())], work)
}

/// Result of some work with only these files of bytes at these paths.
pub(crate) fn with_files<T>(files: &[(&str, &[u8])], work: impl FnOnce() -> T) -> T {
    let files = files.iter().map(|(path, bytes)| ((*path).into(), bytes.to_vec())).collect();
    disk::run_on_disk(Arc::new(PresetFiles::new(files, None)), work)
}
