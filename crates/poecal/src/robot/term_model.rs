//! The contract of every term of joint values.

use super::joint::JointKind;
use crate::unit::Unit;

/// Interface of a term: the function b of the joint values, and what its coefficient c is.
pub trait TermModel {
    /// Its name.
    fn name(&self) -> &'static str;

    /// Unit of the coefficient for a joint of this kind.
    fn unit(&self, kind: JointKind) -> Unit;

    /// The function b of a joint, from the values of all joints without terms, radians or metres.
    fn basis(&self, joint: usize, values: &[f64]) -> f64;

    /// Standard deviation of the coefficient over robots, its prior, in the unit of the coefficient.
    fn deviation(&self, kind: JointKind) -> f64;
}
