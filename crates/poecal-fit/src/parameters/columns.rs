//! The contract of every error parameter: columns of target motion, and the retraction that applies a step.

use nalgebra::Vector3;

use crate::state::{Estimate, RowChain};
use poecal_arm::lie::{Freedom, TargetTwist};
use poecal_numerics::unit::Unit;

/// One unknown of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name within its parameter; empty if it is the only one.
    pub name: &'static str,
    /// Unit of the step.
    pub unit: Unit,
    /// True if a step translates the target without rotating it.
    pub shifts_only: bool,
}

impl Column {
    /// Column of a translation of the target, metres.
    #[must_use]
    pub const fn shift(name: &'static str) -> Column {
        Column { name, unit: Unit::Metre, shifts_only: true }
    }

    /// Column of a rotation of the target, radians.
    #[must_use]
    pub const fn turn(name: &'static str) -> Column {
        Column { name, unit: Unit::Radian, shifts_only: false }
    }

    /// Column of a direction along which the target moves, radians.
    #[must_use]
    pub const fn direction(name: &'static str) -> Column {
        Column { name, unit: Unit::Radian, shifts_only: true }
    }
}

/// Motions of a frame: translations along its axes, rotations about them.
const FRAME: [Column; 6] = [
    Column::shift("x"),
    Column::shift("y"),
    Column::shift("z"),
    Column::turn("rx"),
    Column::turn("ry"),
    Column::turn("rz"),
];

/// Columns of every set of these motions.
const OF_SETS: [[Column; 6]; Freedom::SETS] = {
    let mut all = [FRAME; Freedom::SETS];
    let mut set = 0;
    while set < Freedom::SETS {
        let (mut motion, mut count) = (0, 0);
        while motion < 6 {
            if set >> motion & 1 == 1 {
                all[set][count] = FRAME[motion];
                count += 1;
            }
            motion += 1;
        }
        set += 1;
    }
    all
};

/// Columns of the observable motions of a frame.
pub(crate) const fn of_freedom(freedom: Freedom) -> &'static [Column] {
    OF_SETS[freedom.index()].split_at(freedom.count()).0
}

/// Force `f` at a target's origin and torque `τ`, device axes: the whitened residual pulled back through the measurement
/// (theory.md §6 (31a)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrench {
    /// Force.
    pub force: Vector3<f64>,
    /// Torque.
    pub torque: Vector3<f64>,
}

/// Subject of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterSubject {
    /// The instrument (station) of this index.
    Instrument(usize),
    /// The joint of this index.
    Joint(usize),
    /// The target of this index.
    Target(usize),
    /// Range of the instrument of this index.
    Range(usize),
    /// The clock of the instrument of this index.
    Clock(usize),
}

/// Interface of a parameter with at most six unknowns: columns of the Jacobian, second derivatives, retraction.
pub trait ParameterColumns {
    /// Subject of its unknowns.
    fn subject(&self) -> ParameterSubject;

    /// Unknowns in order.
    fn columns(&self) -> &'static [Column];

    /// Writes, for one row, the target twist per unit of each unknown: translation of the target's origin and rotation, both in the
    /// device's axes (theory.md §4 (14)). `out` has one place for each unknown and is not cleared.
    fn target_twists(&self, chain: &RowChain, target: usize, out: &mut [TargetTwist]);

    /// Writes the second derivative of the target's motion by each pair of these unknowns, contracted with a wrench on the target:
    /// `out[a * dim + b] = f · ∂²p/∂a∂b + τ · ∂²r/∂a∂b` (theory.md §6 (31b)). Pairs with unknowns of other parameters follow from
    /// the twists alone. `out` is all zero before.
    fn curvature(&self, _chain: &RowChain, _wrench: &Wrench, _out: &mut [f64]) {}

    /// True if [`ParameterColumns::curvature`] is implemented. Without it the solver does not use the full Hessian.
    fn has_curvature(&self) -> bool {
        true
    }

    /// Projects a step onto the constraints that the retraction restores, to first order. Without constraints it is the identity.
    fn project_constraints(&self, _step: &mut [f64]) {}

    /// Applies a step (metres, radians) to an estimate.
    fn retract(&self, estimate: &mut Estimate, step: &[f64]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_has_the_columns_of_the_motions_that_are_seen() {
        for set in 0..Freedom::SETS {
            let freedom = Freedom::from_motions((0..6).filter(|motion| set >> motion & 1 == 1));
            let seen: Vec<Column> = freedom.motions().iter().map(|&motion| FRAME[motion]).collect();
            assert_eq!(of_freedom(freedom), seen, "{freedom:?}");
        }
        assert_eq!(of_freedom(Freedom::plane(2)).iter().map(|it| it.name).collect::<Vec<_>>(), ["z", "rx", "ry"]);
    }
}
