//! The report of a reproduction.

use std::fs;
use std::path::Path;

use super::{NewFile, Written, check_folder, write_files};
use crate::error::Result;

/// Names that a reproduction may write, beside its figures.
const OWN_NAMES: [&str; 3] = ["report.html", "report.md", "results.json"];

/// Writes a reproduction's files, each a name and a text as [`reproduction_files`](crate::report::reproduction_files) makes them,
/// whole or not at all. With `force`, figures of an earlier run that are not written again go.
///
/// # Errors
/// [`ErrorKind::File`](crate::ErrorKind::File) if something cannot be written; nothing is left behind then.
pub fn write_reproduction(folder: &Path, force: bool, files: &[(String, String)]) -> Result<Written> {
    check_folder(folder, force)?;
    let earlier = earlier_figures(folder);
    let own_names: Vec<&str> = OWN_NAMES.into_iter().chain(earlier.iter().map(String::as_str)).collect();
    let files: Vec<NewFile> = files.iter().map(|(name, text)| NewFile::new(name, text.clone())).collect();
    write_files(folder, &files, &own_names, Vec::new())
}

/// Figures in the folder; none if there is no folder, or it cannot be listed (then writing says so).
fn earlier_figures(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    names.filter(|name| name.starts_with("figure-") && name.ends_with(".svg")).collect()
}
