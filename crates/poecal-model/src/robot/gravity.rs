//! Weights that a robot carries.

use std::str::FromStr;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::{Body, JointKind, Robot};
use poecal_arm::lie::Screw;

/// Direction of gravity, and the weights whose moments bend the robot. Their masses are unknown: only products of mass, lever and
/// compliance are determined (theory.md §3, *Sag*).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gravity {
    /// Direction of gravity, in the base frame, of length 1.
    pub direction: Vector3<f64>,
    /// Weights; payloads are at the last one, at the tip.
    pub weights: Vec<Weight>,
    /// Screw and pivot ([`Robot::pivots`]) of each joint by which moments are computed, at zero joint values: those of the nominal model,
    /// whatever is estimated.
    pub axes: Vec<(Screw, Vector3<f64>)>,
}

/// Source of the direction of gravity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GravityDirection {
    /// Known direction in the base frame, of any length above 0.
    Known(Vector3<f64>),
    /// Direction with which the terms leave the least noise.
    Found,
}

impl Default for GravityDirection {
    /// Direction against z.
    fn default() -> Self {
        GravityDirection::Known(-Vector3::z())
    }
}

impl FromStr for GravityDirection {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text.trim() == "find" {
            return Ok(GravityDirection::Found);
        }
        let numbers: Vec<Option<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
        match numbers[..] {
            [Some(x), Some(y), Some(z)] if GravityDirection::is_direction(&Vector3::new(x, y, z)) => {
                Ok(GravityDirection::Known(Vector3::new(x, y, z)))
            }
            _ => Err(format!("found `{text}`, expected a direction of three numbers, like 0,0,-1, or find")),
        }
    }
}

impl GravityDirection {
    /// True if a vector has a direction.
    #[must_use]
    pub fn is_direction(vector: &Vector3<f64>) -> bool {
        (1e-100..=1e100).contains(&vector.norm())
    }
}

/// A mass of the model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mass {
    /// Body.
    pub body: Body,
    /// Centre at zero joint values, base frame, metres.
    pub place: Vector3<f64>,
    /// Mass, kg.
    pub kg: f64,
}

impl Mass {
    /// True if a number of kilograms is that of a mass.
    pub fn is_mass(kg: f64) -> bool {
        kg > 0.0 && kg <= 1e6
    }
}

/// Placeholder mass of programs that export models without known masses, kg; fewest links and their share with exactly this mass that are
/// evidence of it.
const PLACEHOLDER_KG: f64 = 1.0;
const FEWEST_PLACEHOLDERS: usize = 2;

impl Robot {
    /// Statement that most links of the model have a mass of exactly 1 kg, as in models that nobody weighed; sag is then computed with wrong weights.
    #[must_use]
    pub fn placeholder_masses(&self) -> Option<String> {
        let alike = self.masses.iter().filter(|it| it.kg == PLACEHOLDER_KG).count();
        (alike >= FEWEST_PLACEHOLDERS && 2 * alike > self.masses.len()).then(|| {
            format!(
                "{alike} of the {} moving links with a mass have exactly 1 kg, which looks like a placeholder: sag is fitted with these masses; state the real \
                 ones, or leave `<inertial>` out",
                self.masses.len()
            )
        })
    }
}

/// A weight on the robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Weight {
    /// Position: the name of a joint, or of the tip.
    pub name: String,
    /// Body.
    pub body: Body,
    /// Position at zero joint values, base frame, metres.
    pub place: Vector3<f64>,
}

impl Gravity {
    /// A weight at the pivot of each joint but the first, on the link that carries it, and at the tip.
    #[must_use]
    pub fn of_unit_weights(robot: &Robot, direction: Vector3<f64>) -> Self {
        let carried = (0..robot.joints.len()).filter(|&joint| robot.joints[joint].give_of.is_none());
        let pivots = robot.pivots();
        let at_joints = carried.filter_map(|joint| {
            let body = robot.body_before(joint);
            body.joint()?;
            Some(Weight { name: robot.joints[joint].name.clone(), body, place: *pivots.get(joint)? })
        });
        let tip = Weight { name: robot.tip_name.clone(), body: robot.tip_body(), place: robot.home.translation };
        let weights = at_joints.chain([tip]).collect();
        Gravity { direction: direction.normalize().map(|it| it + 0.0), weights, axes: axes(robot) }
    }
}

/// Screws and pivots of joints.
pub(crate) fn axes(robot: &Robot) -> Vec<(Screw, Vector3<f64>)> {
    robot.joints.iter().map(|joint| joint.screw).zip(robot.pivots()).collect()
}

impl Robot {
    /// A point of each joint's axis that is the same in all forms of the model, at zero joint values, base frame, metres. It is the point
    /// nearest to the pivot of the joint that it carries, for the last one to the tip; for a prismatic joint it is that pivot itself.
    #[must_use]
    pub fn pivots(&self) -> Vec<Vector3<f64>> {
        let on_the_way = self.joints_to(self.tip_body());
        let mut next: Vec<Option<Vector3<f64>>> = vec![None; self.joints.len()];
        if let Some(end) = self.tip_body().joint().and_then(|joint| next.get_mut(joint)) {
            *end = Some(self.home.translation);
        }
        for mount in &self.mounted {
            if let Some(end) = mount.body.joint().and_then(|joint| next.get_mut(joint)) {
                end.get_or_insert(self.base_from(mount).translation);
            }
        }
        let mut pivots = vec![Vector3::zeros(); self.joints.len()];
        for (index, joint) in self.joints.iter().enumerate().rev() {
            let toward = next[index].unwrap_or(joint.frame.translation);
            pivots[index] = match joint.kind {
                JointKind::Revolute if joint.give_of.is_none() => joint.screw.nearest_point(&toward),
                JointKind::Revolute | JointKind::Prismatic => toward,
            };
            if let Some(before) = self.body_before(index).joint().and_then(|before| next.get_mut(before)) {
                // If links branch, the chain to the tip counts, else the last branch.
                if before.is_none() || on_the_way.contains(&index) {
                    *before = Some(pivots[index]);
                }
            }
        }
        // Compliant joints are at the pivot of their joint.
        for index in 0..pivots.len() {
            if let Some(pivot) = self.joints[index].give_of.and_then(|of| pivots.get(of)).copied() {
                pivots[index] = pivot;
            }
        }
        pivots
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::tests::elbow;

    #[test]
    fn weights_are_at_the_pivots_but_the_first_and_at_the_tip() {
        let robot = elbow();
        assert_eq!(Gravity::of_unit_weights(&robot, -Vector3::z()).weights.len(), 6);
        let to_tip = robot.pivots()[5] - robot.home.translation;
        assert!(robot.joints[5].screw.direction().dot(&to_tip).abs() < 1e-15);
    }

    #[test]
    fn a_direction_of_gravity_is_three_numbers_or_to_be_found() {
        assert_eq!("0,0,-1".parse(), Ok(GravityDirection::default()));
        assert_eq!("find".parse(), Ok(GravityDirection::Found));
    }
}
