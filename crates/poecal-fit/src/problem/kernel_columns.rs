//! Columns of a group of rows in the order of the kernels, and their places in a step.

use super::form::RowForm;
use crate::parameters::OtherScrew;
use crate::state::{ClockTerm, PassedJoint, RangeTerm, Sight};
use poecal_model::robot::Term;
use poecal_numerics::kernels::KernelPlan;

/// Columns of one group of rows: their order in the kernels, and their places in a step.
#[derive(Clone, Debug)]
pub(crate) struct KernelColumns {
    pub(crate) sight: Sight,
    pub(crate) form: RowForm,
    pub(crate) plan: KernelPlan,
    /// Places of the plan's translation and rotation columns in a step.
    pub(crate) shift_places: Vec<StepColumn>,
    pub(crate) turn_places: Vec<StepColumn>,
    pub(crate) given_places: Vec<StepColumn>,
    /// Screws in another parameterisation, with the scale of each of their unknowns.
    pub(crate) screws: Vec<(OtherScrew, Vec<f64>)>,
    /// Unknown terms of the range, the last of the supplied columns, with the scale of each.
    pub(crate) ranges: Vec<(RangeTerm, f64)>,
    /// Joint and factor of each of the plan's terms, and its column in a step over that of the kernels.
    pub(crate) terms: Vec<(PassedJoint, ValueFactor, f64)>,
}

/// Factor on the column of a joint's value in each row, for an unknown that moves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ValueFactor {
    /// Function of a term.
    Term(Term),
    /// Rate of the joint, by a clock.
    Clock(ClockTerm),
}

/// Place of a column in a step, and its sign: the same unknown may move a target twice, and against its own direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StepColumn {
    pub(crate) at: usize,
    pub(crate) sign: f64,
}

impl StepColumn {
    /// Place of a column that is no unknown.
    pub(crate) const NONE: StepColumn = StepColumn { at: usize::MAX, sign: 1.0 };

    /// True if the column is an unknown.
    pub(crate) fn is_unknown(self) -> bool {
        self.at != usize::MAX
    }
}
