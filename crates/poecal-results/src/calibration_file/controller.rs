//! What the controller of a calibrated robot counts.

use super::CalibrationFile;
use poecal_calibrate::Level;
use poecal_model::robot::{Controller, Robot, ThirdAxis, level};
use poecal_numerics::error::Result;

/// How far (rad) the second joint must have moved for the rows to show from where the third counts: taken wrongly, a tenth of a forearm is in
/// the residuals.
const SHOWS: f64 = 0.17;

/// What the controller of a calibrated robot counts, as far as it is known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Counted {
    /// How the model's readings are made of those that are counted; `None` where they are the same.
    pub controller: Option<Controller>,
    /// Whether neither the mapping nor the rows show from where the third axis counts.
    pub is_third_axis_open: bool,
}

impl CalibrationFile {
    /// What the controller counts for the joints of `robot`, a robot of this file: what the mapping said, or what is stated now.
    ///
    /// # Errors
    /// As [`Controller::with_third_axis`].
    pub fn counted(&self, robot: &Robot, stated: Option<ThirdAxis>) -> Result<Counted> {
        if let Some(stated) = stated {
            let kept = self.controller.clone().unwrap_or_else(|| Controller::plain(robot));
            let controller = Some(kept.with_third_axis(robot, stated)?);
            return Ok(Counted { controller, is_third_axis_open: false });
        }
        let controller = self.controller.clone();
        Ok(Counted { is_third_axis_open: self.is_third_axis_open(robot), controller })
    }

    fn is_third_axis_open(&self, robot: &Robot) -> bool {
        let Some((second, third, _)) = level(robot) else { return false };
        let is_stated = self.controller.as_ref().is_some_and(|kept| {
            kept.third_axis.is_some()
                || kept.readings.iter().any(|it| it.reading == third && it.columns.len() > 1)
        });
        let is_second = |joint: &&poecal_model::robot::Joint| joint.reading.name == second;
        let joint = robot.joints.iter().find(is_second).map(|joint| joint.name.as_str());
        let covered = self.coverage.iter().find(|it| Some(it.joint.as_str()) == joint);
        let shows = covered.is_some_and(|it| it.sampled_max - it.sampled_min >= SHOWS);
        let is_good = self.verdict.as_ref().is_none_or(|it| it.level != Level::DoNotUse);
        !(is_stated || shows && is_good)
    }
}
