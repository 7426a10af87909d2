//! Terms of joint values, which URDF cannot hold.

use std::borrow::Cow;

use crate::proof::Difference;
use poecal_model::robot::{JointTerm, Robot};

/// Number of configurations on which the loss is measured.
const CONFIGURATIONS: usize = 1000;

/// The robot in the form that URDF can hold: joint offsets within the screws, which changes nothing, and without other terms of joint values. A
/// note states the loss.
pub fn holdable<'a>(robot: &'a Robot, notes: &mut Vec<String>) -> Cow<'a, Robot> {
    if robot.terms.is_empty() {
        return Cow::Borrowed(robot);
    }
    let mut plain = robot.without_offsets();
    if !plain.terms.is_empty() {
        let name = |it: &JointTerm| {
            let joint = plain.joints.get(it.joint).map_or("", |joint| joint.name.as_str());
            format!("{joint}.{}", it.term)
        };
        let left: Vec<String> = plain.terms.iter().map(name).collect();
        plain.terms.clear();
        let lost = Difference::from_robots(robot, &plain, CONFIGURATIONS).position_m * 1e3;
        notes.push(format!(
            "URDF has no place for {}: without, the tip is off by up to {lost:.3} mm; calibration.json and the TOML model have it",
            left.join(", ")
        ));
    }
    Cow::Owned(plain)
}
