//! Errors that repeat with each turn of a shaft.

use std::borrow::Cow;

use super::joint::JointKind;
use super::term_model::{Situation, TermModel, unit_of_value};
use crate::unit::Unit;

/// A harmonic of a joint's own value, `θ ← θ + c sin kθ` or `c cos kθ`: eccentric gears and encoders. Of a give
/// ([`Joint::give_of`](super::Joint)) it is of the value of the joint that gives, whose bearing wobbles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Harmonic {
    /// Periods a turn, k.
    pub order: u8,
    /// Cosine, or sine.
    pub cosine: bool,
}

impl TermModel for Harmonic {
    fn name(&self) -> Cow<'static, str> {
        format!("{}{}", if self.cosine { "cos" } else { "sin" }, self.order).into()
    }

    fn formula(&self) -> Cow<'static, str> {
        format!("{}({} q)", if self.cosine { "cos" } else { "sin" }, self.order).into()
    }

    fn unit(&self, kind: JointKind) -> Unit {
        unit_of_value(kind)
    }

    fn basis(&self, joint: usize, at: &Situation<'_>) -> f64 {
        let turned = f64::from(self.order) * at.values.get(joint).copied().unwrap_or_default();
        if self.cosine { turned.cos() } else { turned.sin() }
    }

    /// 0.1°, or 0.2 mm: the largest that users of encoders report.
    fn deviation(&self, kind: JointKind) -> f64 {
        match kind {
            JointKind::Revolute => 0.1f64.to_radians(),
            JointKind::Prismatic => 2e-4,
        }
    }
}
