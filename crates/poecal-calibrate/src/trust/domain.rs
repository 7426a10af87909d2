//! Domain of expected errors: a robot, its rows and its nominal model.

use poecal_fit::analysis::JointCoverage;
use poecal_fit::state::{Estimate, Session};
use poecal_model::robot::Robot;

/// The robot and the rows for which errors are expected.
pub(crate) struct Domain<'a> {
    pub(crate) session: &'a Session<'a>,
    /// Fitted rows.
    pub(crate) rows: &'a [u32],
    pub(crate) coverage: &'a [JointCoverage],
    /// The nominal robot, and the nominal model with targets and devices fitted.
    pub(crate) nominal: (&'a Robot, &'a Estimate),
    pub(crate) seed: u64,
}
