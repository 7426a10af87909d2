//! Joint offset.

use std::borrow::Cow;

use super::joint::JointKind;
use super::term_model::{Situation, TermModel, unit_of_value};
use crate::unit::Unit;

/// Where the reading of a joint is zero, `θ ← θ + c` (lou2009: Δθ).
pub(super) struct Offset;

impl TermModel for Offset {
    fn name(&self) -> Cow<'static, str> {
        "offset".into()
    }

    fn formula(&self) -> Cow<'static, str> {
        "1".into()
    }

    fn unit(&self, kind: JointKind) -> Unit {
        unit_of_value(kind)
    }

    fn basis(&self, _: usize, _: &Situation<'_>) -> f64 {
        1.0
    }

    /// An encoder that was mounted anew: 5° or 20 mm.
    fn deviation(&self, kind: JointKind) -> f64 {
        match kind {
            JointKind::Revolute => 5f64.to_radians(),
            JointKind::Prismatic => 0.02,
        }
    }
}
