//! The results of a calibration.

use std::path::Path;

use super::{NewFile, Written, check_folder, robot_files, write_files};
use crate::calibration::Calibration;
use crate::error::Result;
use crate::io::calibration_file::{CalibrationFile, Inputs};
use crate::io::model::Model;
use crate::io::residuals;
use crate::measurement::Dataset;

/// Every name that a calibration may write.
const OWN_NAMES: [&str; 4] = ["calibration.json", "calibrated.urdf", "calibrated.toml", "residuals.csv"];

/// Writes a calibration's files. They are written beside the folder first, read back and compared with the fitted robot on 1,000
/// configurations, and only then put in place.
///
/// # Errors
/// [`ErrorKind::File`](crate::ErrorKind::File) if something cannot be written; [`ErrorKind::Export`](crate::ErrorKind::Export) if
/// a file read back differs from the fit by more than 1e-9 m or rad. Nothing is left behind then.
pub fn write(
    folder: &Path,
    force: bool,
    model: &Model,
    data: &Dataset,
    calibration: &Calibration,
    inputs: Inputs,
) -> Result<Written> {
    check_folder(folder, force)?;
    let mut robot = calibration.robot.clone();
    robot.targets = calibration
        .targets
        .iter()
        .filter_map(|target| target.name.clone().map(|name| (name, target.tip_from_target)))
        .collect();
    let json = CalibrationFile::new(calibration, data, inputs).to_text()?;
    let mut notes = Vec::new();
    let mut files = vec![NewFile::of_robot("calibration.json".to_owned(), json, &calibration.robot)];
    files.extend(robot_files("calibrated", model, &robot, &mut notes)?);
    files.push(NewFile::new("residuals.csv", residuals::text(data, calibration)));
    write_files(folder, &files, &OWN_NAMES, notes)
}
