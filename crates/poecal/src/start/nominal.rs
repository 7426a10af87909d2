//! The model as delivered, from which every search begins, and the length that makes radians comparable with metres.

use crate::estimate::{Estimate, Packed};
use crate::lie::Pose;
use crate::measurement::Dataset;
use crate::robot::{JointKind, Robot};

/// How many metres a radian counts: a third of how far the arm and the strokes found in the data reach.
#[must_use]
pub fn radian_m(robot: &Robot, packed: &Packed) -> f64 {
    let strokes: f64 = (0..robot.joints.len())
        .filter(|&joint| robot.joints[joint].kind == JointKind::Prismatic)
        .map(|joint| {
            let values = (0..packed.rows()).map(|row| packed.joint(row, joint).0);
            let (least, most) =
                values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), value| (a.min(value), b.max(value)));
            (most - least).max(0.0)
        })
        .sum();
    (robot.arm_m() + strokes) / 3.0
}

/// The model as delivered: nominal screws, each target where the model has it or else at the tip, device at the base.
#[must_use]
pub fn delivered(robot: &Robot, data: &Dataset) -> Estimate {
    let base_from_target = data
        .targets
        .iter()
        .map(|name| {
            let known = robot.targets.iter().find(|(target, _)| Some(target) == name.as_ref());
            robot.home * known.map_or_else(Pose::identity, |(_, tip_from_target)| *tip_from_target)
        })
        .collect();
    Estimate::new(robot, base_from_target, Pose::identity())
}
