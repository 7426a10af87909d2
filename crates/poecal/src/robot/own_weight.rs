//! Gears, bearings and links that give under the robot's own weight.

use std::borrow::Cow;

use super::joint::JointKind;
use super::term_model::{Situation, TermModel, unit_of_value};
use crate::unit::Unit;

/// What a joint gives under the moment of all masses of its model, `θ ← θ + c Σ m z·((p - o) × ĝ)/Σ m ℓ` with the masses m at p
/// ([`Robot::masses`](super::Robot)), the axis z through o and the longest lever ℓ of each; of a prismatic joint `c z·ĝ`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct OwnWeight;

impl TermModel for OwnWeight {
    fn name(&self) -> Cow<'static, str> {
        "masses".into()
    }

    fn formula(&self) -> Cow<'static, str> {
        "the moment about the joint of the links' masses, over the largest".into()
    }

    fn unit(&self, kind: JointKind) -> Unit {
        unit_of_value(kind)
    }

    fn basis(&self, joint: usize, at: &Situation<'_>) -> f64 {
        at.moments.map_or(0.0, |moments| moments.of_masses(joint))
    }

    /// 0.1°, or 0.2 mm, under the largest moment.
    fn deviation(&self, kind: JointKind) -> f64 {
        match kind {
            JointKind::Revolute => 0.1f64.to_radians(),
            JointKind::Prismatic => 2e-4,
        }
    }
}
