//! The contract of every term of joint values.

use std::borrow::Cow;

use super::joint::JointKind;
use super::statics::Moments;
use crate::unit::Unit;

/// One configuration, as terms of joint values depend on it.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    /// Values of all joints without terms, radians or metres.
    pub values: &'a [f64],
    /// Moments of the weights that the robot carries, if it has any.
    pub moments: Option<&'a Moments>,
    /// The robot's factors, from their references.
    pub factors: &'a [f64],
}

impl<'a> Situation<'a> {
    /// These values of all joints, without weights and factors.
    #[must_use]
    pub fn of(values: &'a [f64]) -> Self {
        Situation { values, moments: None, factors: &[] }
    }
}

/// Interface of a term: the function b of a configuration, and what its coefficient c is.
pub trait TermModel {
    /// Its name.
    fn name(&self) -> Cow<'static, str>;

    /// The function b in words and signs, with q for the joint's value.
    fn formula(&self) -> Cow<'static, str>;

    /// Unit of the coefficient for a joint of this kind.
    fn unit(&self, kind: JointKind) -> Unit;

    /// The function b of a joint.
    fn basis(&self, joint: usize, at: &Situation<'_>) -> f64;

    /// Standard deviation of the coefficient over robots, its prior, in the unit of the coefficient.
    fn deviation(&self, kind: JointKind) -> f64;
}

/// The unit of a joint's value.
pub(super) fn unit_of_value(kind: JointKind) -> Unit {
    match kind {
        JointKind::Revolute => Unit::Radian,
        JointKind::Prismatic => Unit::Metre,
    }
}
