//! Output of a check.

use super::contents::REPORT;
use super::{FilePlace, FolderPlace, NewFile, Page, Written, write_files};
use crate::error::Result;
use crate::io::validation::{JudgedRows, Validation};

/// Output of a check.
#[derive(Debug)]
pub struct ValidationResults<'a> {
    /// For `validation.json`.
    pub found: &'a Validation,
    /// For `errors.csv`.
    pub rows: JudgedRows<'a>,
    /// `report.html`, if wanted.
    pub report: Option<Page>,
}

/// Writes a check's files, completely or not at all; the report to the place `elsewhere` if there is one.
///
/// # Errors
/// [`ErrorKind::File`](crate::ErrorKind::File) if something cannot be written, [`ErrorKind::Export`](crate::ErrorKind::Export) if the check
/// cannot be written as JSON. Nothing is left behind then.
pub fn write_validation(
    place: FolderPlace,
    elsewhere: Option<FilePlace>,
    results: ValidationResults<'_>,
) -> Result<Written> {
    let ValidationResults { found, rows, mut report } = results;
    let mut files =
        vec![NewFile::new("validation.json", found.to_text()?), NewFile::new("errors.csv", rows.text())];
    let elsewhere = elsewhere.and_then(|file| report.take().map(|page| (file, page)));
    files.extend(report.map(|page| NewFile::of_page(REPORT, page)));
    write_files(place, &files, elsewhere, Vec::new())
}
