//! Counts of the controller of a calibrated robot.

use super::CalibrationFile;
use poecal_calibrate::Level;
use poecal_model::robot::{Controller, Robot, ThirdAxis, level};
use poecal_numerics::error::Result;

/// Motion of the second joint (rad) from which on the rows determine the zero of the third axis' count. With a wrong zero, a tenth of a forearm is in
/// the residuals.
const SHOWS: f64 = 0.17;

/// Counts of the controller of a calibrated robot, as far as they are known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ControllerCounts {
    /// Mapping from the controller's counts to the model's readings; `None` if they are equal.
    pub controller: Option<Controller>,
    /// True if neither the mapping nor the rows determine from where the third axis counts.
    pub is_third_axis_open: bool,
}

impl CalibrationFile {
    /// Counts of the controller for the joints of `robot`, a robot of this file: by its mapping, or by the one stated now.
    ///
    /// # Errors
    /// As [`Controller::with_third_axis`].
    pub fn controller_counts(&self, robot: &Robot, stated: Option<ThirdAxis>) -> Result<ControllerCounts> {
        if let Some(stated) = stated {
            let kept = self.controller.clone().unwrap_or_else(|| Controller::from_robot(robot));
            let controller = Some(kept.with_third_axis(robot, stated)?);
            return Ok(ControllerCounts { controller, is_third_axis_open: false });
        }
        let controller = self.controller.clone();
        Ok(ControllerCounts { is_third_axis_open: self.is_third_axis_open(robot), controller })
    }

    fn is_third_axis_open(&self, robot: &Robot) -> bool {
        let Some((second, third, _)) = level(robot) else { return false };
        let is_stated = self.controller.as_ref().is_some_and(|kept| {
            kept.third_axis.is_some() || kept.readings.iter().any(|it| it.reading == third && it.columns.len() > 1)
        });
        let is_second = |joint: &&poecal_model::robot::Joint| joint.reading.name == second;
        let joint = robot.joints.iter().find(is_second).map(|joint| joint.name.as_str());
        let covered = self.coverage.iter().find(|it| Some(it.joint.as_str()) == joint);
        let shows = covered.is_some_and(|it| it.sampled_max - it.sampled_min >= SHOWS);
        let is_good = self.verdict.as_ref().is_none_or(|it| it.level != Level::DoNotUse);
        !(is_stated || shows && is_good)
    }
}
