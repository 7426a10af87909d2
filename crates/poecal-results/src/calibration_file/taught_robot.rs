//! The nominal robot with the base and tool that a program on the actual robot teaches.

use super::CalibrationFile;
use poecal_arm::lie::Pose;
use poecal_calibrate::DeviceFrameKnowledge;
use poecal_model::offsets::{TaughtFrames, with_tool_of};
use poecal_model::robot::{Joint, Robot};
use poecal_numerics::error::Result;

/// Configurations over which base and tool are fitted.
const CONFIGURATIONS: usize = 96;
/// Range of a joint without limits in the file, to each side of zero (rad, m).
const UNKNOWN: f64 = 1.0;

/// The nominal robot with the base and the tool of the actual one, `base_from_tip = base · nominal base_from_tip · tool`. It is the meaning of a
/// program for the nominal robot with the tip of the actual one ([`CalibrationFile::taught_robot`]).
#[derive(Clone, Debug)]
pub struct TaughtRobot {
    /// The robot.
    pub robot: Robot,
    /// The nominal base in the actual one.
    pub base: Pose,
    /// The actual tip in the nominal one.
    pub tool: Pose,
}

impl CalibrationFile {
    /// The nominal robot with the base and tool of an actual one, the calibrated or the corrected robot of this file. Tips of both are then of the
    /// same object, and their difference is that of the joints. The actual tip is the measured target, mostly a reflector; the nominal one is the
    /// flange of its model. The position of the measuring device is arbitrary unless it was known. Both are fitted over the sampled range by least
    /// squares; a base that is known (`--device-frame base`) is that of the model.
    ///
    /// # Errors
    /// As [`CalibrationFile::robot`] and [`Robot::arm`].
    pub fn taught_robot(&self, actual: &Robot) -> Result<TaughtRobot> {
        let nominal = self.nominal_robot()?;
        let as_it_is = || TaughtRobot { robot: nominal.clone(), base: Pose::identity(), tool: Pose::identity() };
        let Some(own) = with_tool_of(actual, &nominal) else { return Ok(as_it_is()) };
        let factors: Vec<f64> = actual.factors.iter().map(|it| it.reference).collect();
        let ((nominal_arm, readings), (actual_arm, others)) = (own.arm(&[])?, actual.arm(&factors)?);
        let names = actual.reading_names();
        if readings != others || own.joint_reading_names() != actual.joint_reading_names() {
            return Ok(as_it_is());
        }
        let range = |reading: &usize| {
            let name = names.get(*reading);
            let sampled = self.coverage.iter().find(|it| Some(&it.joint) == name);
            sampled.map_or([-UNKNOWN, UNKNOWN], |it| [it.sampled_min, it.sampled_max])
        };
        let ranges: Vec<[f64; 2]> = readings.iter().map(range).collect();
        // Evenly spread: fractional parts of multiples of square roots.
        let configuration = |index: usize| -> Vec<f64> {
            let share = |k: usize| (0.5 + index as f64 * (k as f64 + 2.0).sqrt() * 1.618).fract();
            ranges.iter().enumerate().map(|(k, [low, high])| low + (high - low) * share(k)).collect()
        };
        let tips: Vec<(Pose, Pose)> = (0..CONFIGURATIONS)
            .map(configuration)
            .map(|q| (nominal_arm.forward_kinematics(&q), actual_arm.forward_kinematics(&q)))
            .collect();
        let base_is_known = self.frame() == DeviceFrameKnowledge::Base;
        let taught = TaughtFrames::from_tips(&tips, nominal_arm.reach_m() / 3.0, base_is_known);
        let base = taught.base;
        let tool = nominal.home.inverse() * own.home * taught.tool;
        let joints = nominal.joints.iter().map(|joint| Joint {
            screw: joint.screw.transform(&base),
            frame: base * joint.frame,
            ..joint.clone()
        });
        let robot = Robot { joints: joints.collect(), home: base * nominal.home * tool, ..nominal.clone() };
        Ok(TaughtRobot { robot, base, tool })
    }
}
