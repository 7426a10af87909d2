//! The delivered model, as the reference of visits.

use super::options::TrackOptions;
use crate::calibration_file::CalibrationFile;
use poecal_calibrate::AcceptedModel;
use poecal_model::measurement::{ByQuantity, Noise, Quantity};
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;

/// A delivered model.
pub(crate) struct VisitModel {
    /// The file whose entries are those of the delivered model.
    pub(crate) file: CalibrationFile,
    pub(crate) robot: Robot,
    pub(crate) noise: Noise,
    /// The joints that have readings: all but the compliant ones.
    pub(crate) joints: Vec<usize>,
    pub(crate) is_corrected: bool,
}

impl VisitModel {
    /// Model of a calibration, with the noise of a visit if that is stated.
    pub(crate) fn from_calibration(file: &CalibrationFile, options: &TrackOptions) -> Result<Self> {
        let corrected = file.corrected_file();
        let is_corrected = corrected.is_some();
        let file = corrected.unwrap_or_else(|| file.clone());
        let robot = file.robot()?;
        let usual = file.noise()?;
        let noise = match options.repeatability_m {
            None => usual,
            Some(sigma_m) => {
                let share = sigma_m / usual[Quantity::Position];
                ByQuantity::from_fn(
                    |quantity| {
                        if quantity == Quantity::Position { sigma_m } else { usual[quantity] * share }
                    },
                )
            }
        };
        let joints = (0..robot.joints.len()).filter(|&joint| robot.joints[joint].give_of.is_none()).collect();
        Ok(VisitModel { file, robot, noise, joints, is_corrected })
    }

    /// Error of the calibration itself, metres for each coordinate or distance.
    pub(crate) fn own_m(&self) -> f64 {
        1e-3 * self.own_rms()
    }

    /// Error of the calibration itself, millimetres or degrees.
    pub(crate) fn own_rms(&self) -> f64 {
        let model = if self.is_corrected { AcceptedModel::Corrected } else { AcceptedModel::Calibrated };
        self.file.own_rms(model)
    }
}
