//! Output of a calibration.

use super::contents::REPORT;
use super::{NewFile, PagePieces, ReservedFile, ReservedFolder, WrittenFiles, robot_files, write_files};
use crate::calibration_file::CalibrationFile;
use crate::model::Model;
use crate::residuals::ResidualRows;
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;

/// Output of a calibration beside its models.
#[derive(Clone, Debug)]
pub struct Results<'a> {
    /// Contents of `calibration.json`.
    pub file: CalibrationFile,
    /// Contents of `residuals.csv`.
    pub residuals: ResidualRows<'a>,
    /// `report.html`, if wanted.
    pub report: Option<PagePieces>,
}

/// Writes a calibration's files, of the calibrated robot with its targets. They are written to a staging folder first, read back and compared with
/// the robot on 1,000 configurations, and only then put in place. The report is written to `elsewhere` if there is one.
///
/// # Errors
/// [`ErrorKind::File`](poecal_numerics::error::ErrorKind::File) if something cannot be written;
/// [`ErrorKind::Export`](poecal_numerics::error::ErrorKind::Export) if a file read back differs from the fit by more than 1e-9 m or rad.
/// Nothing is left behind then.
pub fn write(
    place: ReservedFolder,
    elsewhere: Option<ReservedFile>,
    model: &Model,
    robot: &Robot,
    results: Results<'_>,
) -> Result<WrittenFiles> {
    let mut notes = Vec::new();
    let json = results.file.to_text()?;
    // As in the file: every later path from it to a URDF produces the same text.
    let as_written = results.file.robot()?;
    let mut files = vec![NewFile::of_robot("calibration.json".to_owned(), json, robot)];
    files.extend(robot_files("calibrated", model, &as_written, &mut notes)?);
    files.push(NewFile::of_rows("residuals.csv", results.residuals));
    let mut report = results.report;
    let elsewhere = elsewhere.and_then(|file| report.take().map(|page| (file, page)));
    files.extend(report.map(|page| NewFile::of_page(REPORT, page)));
    write_files(place, &files, elsewhere, notes)
}
