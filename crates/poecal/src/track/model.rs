//! The model that is delivered, as visits are compared by it.

use super::options::TrackOptions;
use crate::calibration::AcceptedModel;
use crate::error::Result;
use crate::io::calibration_file::CalibrationFile;
use crate::measurement::{ByQuantity, Noise, Quantity};
use crate::robot::Robot;

/// A model that is delivered.
pub(super) struct Model {
    /// The file whose entries are those of the delivered model.
    pub(super) file: CalibrationFile,
    pub(super) robot: Robot,
    pub(super) noise: Noise,
    /// The joints that have readings: all but the gives.
    pub(super) joints: Vec<usize>,
    pub(super) is_corrected: bool,
}

impl Model {
    /// Of a calibration, with the noise of a visit where that is stated.
    pub(super) fn of(file: &CalibrationFile, options: &TrackOptions) -> Result<Self> {
        let corrected = file.corrected();
        let is_corrected = corrected.is_some();
        let file = corrected.unwrap_or_else(|| file.clone());
        let robot = file.robot()?;
        let usual = file.noise()?;
        let noise = match options.repeatability_m {
            None => usual,
            Some(sigma_m) => {
                let share = sigma_m / usual[Quantity::Position];
                ByQuantity::from_fn(|quantity| {
                    if quantity == Quantity::Position { sigma_m } else { usual[quantity] * share }
                })
            }
        };
        let joints = (0..robot.joints.len()).filter(|&joint| robot.joints[joint].give_of.is_none()).collect();
        Ok(Model { file, robot, noise, joints, is_corrected })
    }

    /// Error of the calibration itself, metres a coordinate or distance.
    pub(super) fn own_m(&self) -> f64 {
        let model = if self.is_corrected { AcceptedModel::Corrected } else { AcceptedModel::Calibrated };
        1e-3 * self.file.own_rms(model)
    }
}
