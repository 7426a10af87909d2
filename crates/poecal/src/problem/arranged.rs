//! Columns of a group of rows as the kernels have them, and their places in a step.

use super::form::Form;
use crate::estimate::{ClockTerm, Passed, RangeTerm, Sight};
use crate::lanes::Plan;
use crate::parameters::OtherScrew;
use crate::robot::Term;

/// Columns of one group of rows: their order in the kernels, and their places in a step.
#[derive(Clone, Debug)]
pub(super) struct ColumnMap {
    pub(super) sight: Sight,
    pub(super) form: Form,
    pub(super) plan: Plan,
    /// Places of the plan's translation and rotation columns in a step.
    pub(super) shift_places: Vec<Place>,
    pub(super) turn_places: Vec<Place>,
    pub(super) given_places: Vec<Place>,
    /// Screws in another parameterisation, with the scale of each of their unknowns.
    pub(super) screws: Vec<(OtherScrew, Vec<f64>)>,
    /// Terms of the range that are unknown, the last of the given columns, with the scale of each.
    pub(super) ranges: Vec<(RangeTerm, f64)>,
    /// Joint and factor of each of the plan's terms, and its column in a step over that of the kernels.
    pub(super) terms: Vec<(Passed, ValueFactor, f64)>,
}

/// What the column of a joint's value is multiplied by in each row, for an unknown that moves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ValueFactor {
    /// The function of a term.
    Term(Term),
    /// The joint's rate by a clock.
    Clock(ClockTerm),
}

/// Place of a column in a step, and its sign: the same unknown may move a target twice, and against its own direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub(super) at: usize,
    pub(super) sign: f64,
}

impl Place {
    /// Of a column that is no unknown.
    pub(super) const NONE: Place = Place { at: usize::MAX, sign: 1.0 };

    /// Whether the column is an unknown.
    pub(super) fn is_unknown(self) -> bool {
        self.at != usize::MAX
    }
}
