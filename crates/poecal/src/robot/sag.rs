//! Gears, bearings and links that give under weight.

use std::borrow::Cow;

use super::joint::JointKind;
use super::term_model::{Situation, TermModel, unit_of_value};
use crate::unit::Unit;

/// What a joint gives under the moment of one weight about its axis: `θ ← θ + c z·((p - o) × ĝ)/ℓ` with the axis z through o, the weight at p
/// and ℓ the longest lever of all weights of that joint; of a prismatic joint `c z·ĝ`. A weight that the joint does not carry has no moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Sag {
    /// Index of the weight ([`Gravity::weights`](super::Gravity)).
    pub weight: usize,
}

impl TermModel for Sag {
    fn name(&self) -> Cow<'static, str> {
        format!("sag{}", self.weight + 1).into()
    }

    fn formula(&self) -> Cow<'static, str> {
        format!("the moment about the joint of weight {}, over the largest", self.weight + 1).into()
    }

    fn unit(&self, kind: JointKind) -> Unit {
        unit_of_value(kind)
    }

    fn basis(&self, joint: usize, at: &Situation<'_>) -> f64 {
        at.moments.map_or(0.0, |moments| moments.of(joint, self.weight))
    }

    /// 0.1°, or 0.2 mm, under the largest moment.
    fn deviation(&self, kind: JointKind) -> f64 {
        match kind {
            JointKind::Revolute => 0.1f64.to_radians(),
            JointKind::Prismatic => 2e-4,
        }
    }
}
