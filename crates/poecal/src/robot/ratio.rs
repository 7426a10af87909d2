//! Error of a gear's ratio.

use std::borrow::Cow;

use super::joint::JointKind;
use super::term_model::{Situation, TermModel};
use crate::unit::Unit;

/// What a joint turns or slides too far, as a share of its reading: `θ ← θ + c θ`.
pub(super) struct Ratio;

impl TermModel for Ratio {
    fn name(&self) -> Cow<'static, str> {
        "ratio".into()
    }

    fn formula(&self) -> Cow<'static, str> {
        "q".into()
    }

    fn unit(&self, _: JointKind) -> Unit {
        Unit::One
    }

    fn basis(&self, joint: usize, at: &Situation<'_>) -> f64 {
        at.values.get(joint).copied().unwrap_or_default()
    }

    /// 0.5 %: a belt, or a tooth more or less of a gear with two hundred.
    fn deviation(&self, _: JointKind) -> f64 {
        5e-3
    }
}
