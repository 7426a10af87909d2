//! The report of a reproduction.

use super::{FolderPlace, NewFile, Written, write_files};
use crate::error::Result;

/// Whether a reproduction may write a file of this name.
pub(super) fn is_own(name: &str) -> bool {
    let figure = name.strip_prefix("figure-").and_then(|rest| rest.strip_suffix(".svg"));
    ["report.html", "report.md", "results.json"].contains(&name)
        || figure.is_some_and(|figure| figure.chars().all(|c| c.is_ascii_alphanumeric() || c == '-'))
}

/// Writes a reproduction's files, each a name and a text as [`reproduction_files`](crate::report::reproduction_files) makes them,
/// whole or not at all. Figures of an earlier run that are not written again go.
///
/// # Errors
/// [`ErrorKind::File`](crate::ErrorKind::File) if something cannot be written; nothing is left behind then.
pub fn write_reproduction(place: FolderPlace, files: &[(String, String)]) -> Result<Written> {
    let files: Vec<NewFile> = files.iter().map(|(name, text)| NewFile::new(name, text.clone())).collect();
    write_files(place, &files, None, Vec::new())
}
