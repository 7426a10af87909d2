//! Joint offsets and the equivalent screws: a robot with offsets written without, and the offsets that explain best the difference
//! of one robot from another (theory.md §8, lou2009 equations 11 to 15).

mod changes;
mod fit;
mod options;
mod prediction;
mod screws;
mod start;
mod taught_frames;
mod tip_offsets;

pub use changes::{ChangeBySteps, Changes, JointChange, direction};
pub use options::{EndConstraint, OffsetOptions};
pub use prediction::TipError;
pub use screws::into_screws;
pub use taught_frames::{TaughtFrames, with_tool_of};

use crate::robot::{JointKind, Robot};
use fit::{OffsetState, RobotPair};
use poecal_arm::lie::{Pose, rotation};
use poecal_numerics::error::Result;
use prediction::PredictionSample;
use screws::check_same_joints;
use tip_offsets::TipFit;

/// Difference of a joint's screw that offsets do not explain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointScrewResidual {
    /// Angle between the directions, radians.
    pub tilt_rad: f64,
    /// Distance of the axis from the actual joint's origin, metres; `None` for a prismatic joint.
    pub shift_m: Option<f64>,
}

/// Difference of the home pose that offsets do not explain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HomeResidual {
    /// Distance of the tips at zero, metres.
    pub position_m: f64,
    /// Angle between the tip frames at zero, radians.
    pub rotation_rad: f64,
}

/// Offsets with which one robot comes nearest to another, and the remaining differences.
#[derive(Clone, Debug, PartialEq)]
pub struct OffsetExplanation {
    /// Options of the comparison.
    pub options: OffsetOptions,
    /// Offset of each joint's value, radians in (-π, π] or metres.
    pub offsets: Vec<f64>,
    /// Joints (by index) whose offsets are not determined, alone or in combination; theirs are the smallest that explain as much.
    pub undetermined: Vec<usize>,
    /// Motion of the nominal robot in the base frame; the identity if the base is kept.
    pub base_motion: Pose,
    /// `tip_from_tip` from the nominal tip to the actual one; the identity if the tip is kept.
    pub tip_motion: Pose,
    /// Remaining difference of each joint.
    pub joints: Vec<JointScrewResidual>,
    /// Remaining difference of the home pose; `None` if the tip is free.
    pub home: Option<HomeResidual>,
    /// Error of the nominal robot's tip relative to the actual one's, with the best base and tip if these are free.
    pub without_offsets: TipError,
    /// The same error with the offsets applied.
    pub with_offsets: TipError,
}

/// Offsets, and motions of base and tip if these are free, with which the tip of `nominal` comes nearest to that of `actual`. They are the least
/// squares of its positions and of its rotations, at a tenth of a metre. The configurations are random within the limits of `nominal` (theory.md §8
/// (38d)). The start is the state with the nearest screws and home pose (38b), which also determines the parts without effect on the tip. Offsets may
/// be of any size. The result is the improvement by a controller that takes offsets, a base and a tool, and nothing else.
///
/// # Errors
/// [`ErrorKind::Option`](poecal_numerics::error::ErrorKind::Option) if the robots do not have the same joints (number, names in order,
/// kinds and readings), or have branches.
pub fn explain(nominal: &Robot, actual: &Robot, options: &OffsetOptions) -> Result<OffsetExplanation> {
    explain_offsets(nominal, actual, options, true)
}

/// The same offsets by the screws alone, (38b): the start of [`explain`].
///
/// # Errors
/// As [`explain`].
pub fn explain_screws(nominal: &Robot, actual: &Robot, options: &OffsetOptions) -> Result<OffsetExplanation> {
    explain_offsets(nominal, actual, options, false)
}

fn explain_offsets(
    nominal: &Robot,
    actual: &Robot,
    options: &OffsetOptions,
    at_tip: bool,
) -> Result<OffsetExplanation> {
    check_same_joints(nominal, actual)?;
    let (nominal, actual) = (&nominal.without_offsets(), &actual.without_offsets());
    let comparison = RobotPair::new(nominal, actual, options);
    let found = comparison.best_state();
    let unmoved = comparison.best_without_offsets();
    let undetermined = comparison.undetermined_joints(&found);
    let predictions = PredictionSample::new(nominal, actual, options);
    let nearest = |moves_offsets: bool, state: OffsetState| {
        let length_m = comparison.length_m;
        let fit = TipFit { nominal, predictions: &predictions, options, moves_offsets, length_m };
        if at_tip {
            return fit.find_nearest(state);
        }
        fit.compare_tip(&state).map(|(tip_motion, left)| (state, tip_motion, left))
    };
    let (found, tip_motion, with_offsets) = nearest(true, found)?;
    let (_, _, without_offsets) = nearest(false, unmoved)?;
    let (joints, home) = remainder(&comparison, &found);
    Ok(OffsetExplanation {
        options: *options,
        undetermined,
        offsets: found.offsets,
        base_motion: found.base,
        tip_motion,
        joints,
        home,
        without_offsets,
        with_offsets,
    })
}

fn remainder(comparison: &RobotPair<'_>, found: &OffsetState) -> (Vec<JointScrewResidual>, Option<HomeResidual>) {
    let (screws, home) = comparison.move_robot(found);
    let actual = comparison.actual;
    let joints = screws.iter().zip(&actual.joints).map(|(screw, joint)| {
        let (direction, goal) = (screw.direction(), joint.screw.direction());
        let tilt_rad = direction.cross(&goal).norm().atan2(direction.dot(&goal));
        let origin = joint.screw.nearest_point(&joint.frame.translation);
        let shift_m = (joint.kind == JointKind::Revolute).then(|| (screw.nearest_point(&origin) - origin).norm());
        JointScrewResidual { tilt_rad, shift_m }
    });
    let home = (comparison.options.tip == EndConstraint::Kept).then(|| HomeResidual {
        position_m: (home.translation - actual.home.translation).norm(),
        rotation_rad: rotation::log(&(home.rotation * actual.home.rotation.transpose())).norm(),
    });
    (joints.collect(), home)
}
