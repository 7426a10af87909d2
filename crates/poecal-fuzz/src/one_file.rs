//! A disk that has a file or a few: of what is read by its path alone.

use std::sync::Arc;

use poecal_storage::disk::{self, GivenFiles};

/// What some work gives where a file of this text is at a path, and nothing else.
pub(crate) fn with_file<T>(path: &str, text: &str, work: impl FnOnce() -> T) -> T {
    with_files(&[(path, text.as_bytes())], work)
}

/// What some work gives where files of these bytes are at these paths, and nothing else.
pub(crate) fn with_files<T>(files: &[(&str, &[u8])], work: impl FnOnce() -> T) -> T {
    let files = files.iter().map(|(path, bytes)| ((*path).into(), bytes.to_vec())).collect();
    disk::on(Arc::new(GivenFiles::new(files, None)), work)
}
