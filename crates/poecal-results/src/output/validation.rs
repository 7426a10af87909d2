//! Output of a check.

use std::path::{Path, PathBuf};

use super::contents::{Contents, REPORT};
use super::{ExistingFiles, NewFile, PagePieces, ReservedFile, ReservedFolder, WrittenFiles, write_files};
use crate::validation::{JudgedRows, Validation};
use poecal_numerics::error::Result;

/// Destinations of the output of a check.
#[derive(Debug)]
pub struct ValidationOutputs {
    folder: Option<ReservedFolder>,
    /// A report outside that folder.
    report: Option<(ReservedFile, PathBuf)>,
    /// True if a report is wanted in it.
    is_among: bool,
}

impl ValidationOutputs {
    /// Reserves a folder, if one is named, with the report in it if that is wanted, or at a path of its own. `say` receives messages about remains of
    /// interrupted runs.
    ///
    /// # Errors
    /// As [`ReservedFolder::reserve`] and [`ReservedFile::reserve`].
    pub fn reserve(
        folder: Option<&Path>,
        (is_wanted, elsewhere): (bool, Option<&Path>),
        existing: ExistingFiles,
        inputs: &[&Path],
        say: &mut dyn FnMut(String),
    ) -> Result<Self> {
        let folder = folder.map(|path| ReservedFolder::reserve(path, Contents::Validation, existing, inputs, say));
        let folder = folder.transpose()?;
        let place = match (elsewhere, &folder) {
            (Some(path), Some(folder)) => folder.reserve_report(path, inputs, say)?,
            (Some(path), None) => Some(ReservedFile::reserve(path, existing, inputs, say)?),
            (None, _) => None,
        };
        let report = place.zip(elsewhere.map(Path::to_owned));
        Ok(ValidationOutputs { folder, is_among: is_wanted && report.is_none(), report })
    }

    /// Writes a check's files, completely or not at all, with its page if a report is wanted. Returns the summary of the folder's files, and the path
    /// of a report outside it.
    ///
    /// # Errors
    /// [`ErrorKind::File`](poecal_numerics::error::ErrorKind::File) if something cannot be written,
    /// [`ErrorKind::Export`](poecal_numerics::error::ErrorKind::Export) if the check cannot be written as JSON. Nothing is left behind then.
    pub fn write(
        self,
        found: &Validation,
        rows: JudgedRows<'_>,
        page: impl FnOnce() -> PagePieces,
    ) -> Result<(Option<WrittenFiles>, Option<PathBuf>)> {
        let (elsewhere, path) = self.report.unzip();
        let Some(folder) = self.folder else {
            elsewhere.map(|place| place.write(page())).transpose()?;
            return Ok((None, path));
        };
        let mut files =
            vec![NewFile::new("validation.json", found.to_text()?), NewFile::new("errors.csv", rows.text())];
        let mut report = (self.is_among || elsewhere.is_some()).then(page);
        let elsewhere = elsewhere.and_then(|file| report.take().map(|page| (file, page)));
        files.extend(report.map(|page| NewFile::of_page(REPORT, page)));
        Ok((Some(write_files(folder, &files, elsewhere, Vec::new())?), path))
    }
}
