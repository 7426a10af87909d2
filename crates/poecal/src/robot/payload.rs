//! Gears, bearings and links that give under a payload that is read.

use std::borrow::Cow;

use super::joint::JointKind;
use super::term_model::{Situation, TermModel, unit_of_value};
use crate::unit::Unit;

/// What a joint gives under a payload, `θ ← θ + c f z·((p - o) × ĝ)/ℓ` with the payload f ([`Robot::factors`](super::Robot)) at the place p of
/// the last weight, the axis z through o and the longest lever ℓ as in [`Sag`](super::Sag). How heavy the payload is being known, c is a
/// compliance: an angle each kilogram at full lever.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Payload {
    /// Index of the payload among the robot's factors.
    pub index: usize,
}

impl TermModel for Payload {
    fn name(&self) -> Cow<'static, str> {
        format!("payload{}", self.index + 1).into()
    }

    fn formula(&self) -> Cow<'static, str> {
        format!(
            "factor {} * the moment about the joint of a unit weight at the last link, over the largest",
            self.index + 1
        )
        .into()
    }

    fn unit(&self, kind: JointKind) -> Unit {
        unit_of_value(kind)
    }

    fn basis(&self, joint: usize, at: &Situation<'_>) -> f64 {
        let payload = at.factors.get(self.index).copied().unwrap_or_default();
        payload * at.moments.map_or(0.0, |moments| moments.of_last(joint))
    }

    /// 0.01°, or 0.02 mm, each kilogram.
    fn deviation(&self, kind: JointKind) -> f64 {
        match kind {
            JointKind::Revolute => 0.01f64.to_radians(),
            JointKind::Prismatic => 2e-5,
        }
    }
}
