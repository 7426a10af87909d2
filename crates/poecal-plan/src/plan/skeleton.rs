//! The lines of a robot: between the frames of its joints, and to its targets.

use nalgebra::Vector3;

use poecal_arm::lie::Pose;
use poecal_model::robot::{Body, Mount, Robot};

/// Positions of the targets at joint frames of [`Robot::joint_poses`], the frame that orients each, and the body that holds it.
pub(crate) fn targets(robot: &Robot, readings: &[f64], frames: &[Pose]) -> Vec<(Vector3<f64>, Pose, Body)> {
    let mounted = &robot.mounted;
    if mounted.is_empty() {
        let tip = robot.forward_kinematics(readings);
        return vec![(tip.translation, tip, robot.tip_body())];
    }
    let at = |body: Body| body.joint().and_then(|joint| frames.get(joint)).copied();
    let seen = |it: &Mount| (at(it.body).unwrap_or_else(Pose::identity) * it.pose, it.body);
    mounted.iter().map(seen).map(|(pose, body)| (pose.translation, pose, body)).collect()
}

/// The lines between the frames of joints that move.
pub(crate) fn links(robot: &Robot, frames: &[Pose]) -> Vec<[Vector3<f64>; 2]> {
    let place = |joint: usize| frames.get(joint).map(|frame| frame.translation);
    let line = |joint: usize| Some([place(robot.body_before(joint).joint()?)?, place(joint)?]);
    (0..frames.len()).filter_map(line).collect()
}

/// The lines to the targets, from the frame of the last joint.
pub(crate) fn to_targets(robot: &Robot, readings: &[f64], frames: &[Pose]) -> Vec<[Vector3<f64>; 2]> {
    let last = robot.tip_body().joint().and_then(|joint| frames.get(joint));
    let line = |(place, ..): (Vector3<f64>, Pose, Body)| [last.map_or(place, |it| it.translation), place];
    targets(robot, readings, frames).into_iter().map(line).collect()
}

/// The lines of a robot in a configuration, metres in its base frame: from the base through the frames of the joints to the targets.
///
/// ```
/// use poecal_plan::plan::skeleton;
/// use poecal_model::simulate::elbow;
/// let robot = elbow();
/// let lines = skeleton(&robot, &[0.0; 6]);
/// let tip = robot.forward_kinematics(&[0.0; 6]).translation;
/// assert!((lines.last().unwrap()[1] - tip).norm() < 1e-12);
/// ```
#[must_use]
pub fn skeleton(robot: &Robot, readings: &[f64]) -> Vec<[Vector3<f64>; 2]> {
    let frames = robot.joint_poses(readings);
    let roots = (0..frames.len()).filter(|&joint| robot.body_before(joint) == Body::Base);
    let base = roots.filter_map(|joint| Some([Vector3::zeros(), frames.get(joint)?.translation]));
    let moving = links(robot, &frames).into_iter().chain(to_targets(robot, readings, &frames));
    base.chain(moving).collect()
}
