//! Input of an analysis.

use crate::problem::Layout;
use crate::state::{Estimate, Session};
use poecal_model::measurement::Noise;

/// Input of an analysis: session, rows, unknowns.
///
/// An example is [`super::identify`].
#[derive(Clone, Copy, Debug)]
pub struct AnalysisSetup<'a> {
    /// Robot and measurements.
    pub session: Session<'a>,
    /// Rows of the fit.
    pub rows: &'a [u32],
    /// Estimate at which the information was computed.
    pub estimate: &'a Estimate,
    /// Unknowns.
    pub layout: &'a Layout,
    /// Noise of rows that state none.
    pub noise: Noise,
}
