//! The contract of every error parameter: columns of target motion, and the retraction that applies a step.

use crate::estimate::{Chain, Estimate};
use crate::measurement::TargetTwist;

/// Unit of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Metres.
    Metre,
    /// Radians.
    Radian,
}

/// One unknown of a parameter.
///
/// ```
/// use poecal::parameters::{Column, Unit};
/// let column = Column { unit: Unit::Metre, shifts_only: true };
/// assert!(column.shifts_only);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// Unit of the step.
    pub unit: Unit,
    /// Whether a step only shifts the target and never turns it.
    pub shifts_only: bool,
}

/// What a parameter provides.
pub trait Columns {
    /// Its unknowns in order.
    fn columns(&self) -> &'static [Column];

    /// Writes, for one row, the target's motion per unit of each unknown: shift of the target's origin and turn, both in the
    /// device's axes. `out` has one place an unknown and is not cleared.
    fn target_twists(&self, chain: &Chain, target: usize, out: &mut [TargetTwist]);

    /// Applies a step (metres, radians) to an estimate.
    fn retract(&self, estimate: &mut Estimate, step: &[f64]);
}
