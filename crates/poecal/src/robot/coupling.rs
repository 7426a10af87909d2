//! Joints that others turn.

use std::borrow::Cow;

use super::joint::JointKind;
use super::term_model::{Situation, TermModel};
use crate::unit::Unit;

/// What another joint turns or slides a joint, as a share of the other's value: `θ ← θ + c θ'`. Wrists whose gears lie in one another, and
/// parallel links.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Coupling {
    /// Index of the other joint.
    pub joint: usize,
}

impl TermModel for Coupling {
    fn name(&self) -> Cow<'static, str> {
        format!("coupled{}", self.joint + 1).into()
    }

    fn formula(&self) -> Cow<'static, str> {
        format!("the value of joint {}, counted from the base", self.joint + 1).into()
    }

    fn unit(&self, _: JointKind) -> Unit {
        Unit::One
    }

    fn basis(&self, _: usize, at: &Situation<'_>) -> f64 {
        at.values.get(self.joint).copied().unwrap_or_default()
    }

    /// 2 %: the ratio of a last stage of gears.
    fn deviation(&self, _: JointKind) -> f64 {
        2e-2
    }
}
