//! Identity of files named by different paths.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::disk::{self, Disk};
use poecal_numerics::error::{ErrorKind, Result};

/// Canonical path of an existing file. Other paths stay unchanged, for the reader's error.
#[must_use]
pub fn canonical_path(path: &Path) -> PathBuf {
    disk::current_disk().canonical_path(path).unwrap_or_else(|_| path.to_owned())
}

/// True if two paths lead to the same file, also by links.
pub fn are_same(disk: &dyn Disk, one: &Path, other: &Path) -> bool {
    let (Ok(one_found), Ok(other_found)) = (disk.follow(one), disk.follow(other)) else { return false };
    match (one_found.identity, other_found.identity) {
        (Some(one), Some(other)) => one == other,
        _ => disk.canonical_path(one).ok() == disk.canonical_path(other).ok(),
    }
}

/// Refuses a measurement file that is named twice: its rows would count twice.
///
/// # Errors
/// [`ErrorKind::Option`].
pub fn refuse_repeats(paths: &[PathBuf]) -> Result<()> {
    let mut seen = HashSet::new();
    refuse(
        paths.iter().find(|path| !seen.insert(canonical_path(path))),
        "found this measurement file named twice, expected every file once, since the same rows \
         twice are not more data: leave one out",
    )
}

/// Refuses a file for both training and validation.
///
/// # Errors
/// [`ErrorKind::Option`].
pub fn refuse_fitted(judges: &[PathBuf], fitted: &[PathBuf]) -> Result<()> {
    let fitted: HashSet<PathBuf> = fitted.iter().map(|path| canonical_path(path)).collect();
    refuse(
        judges.iter().find(|path| fitted.contains(&canonical_path(path))),
        "found this file to be fitted and in --validate, expected one of the two, since a fit is \
         judged by rows that it did not see: leave one out",
    )
}

/// Refuses a file, if there is one.
fn refuse(path: Option<&PathBuf>, message: &str) -> Result<()> {
    path.map_or(Ok(()), |path| Err(ErrorKind::Option.error(message).in_file(path)))
}
