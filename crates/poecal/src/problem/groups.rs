//! The rows of a problem by instrument, target and form, as they are packed for the kernels.

use super::arranged::ColumnMap;
use super::scatter::GramScatter;
use crate::estimate::Linkage;
use crate::lanes::{PackedRows, SimdLevel};

/// Sums over rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Accumulate {
    /// Cost, gradient and `JᵀJ`.
    All,
    /// The same; `JᵀJ` may lack the curvature of the logarithm, where that saves time.
    GaussNewton,
    /// Cost and gradient.
    Gradient,
}

/// The groups of rows of a problem.
#[derive(Clone, Debug)]
pub(super) struct Fast {
    pub(super) groups: Vec<(Group, GramScatter)>,
    pub(super) level: SimdLevel,
    /// Of the state at which it was built: its joints are those of every other.
    pub(super) linkage: Linkage,
    /// A step along which residuals are replaced by their second derivative.
    pub(super) second: Option<SecondDifference>,
}

/// A step, by the frames ahead of a state and behind it.
#[derive(Clone, Debug)]
pub(super) struct SecondDifference {
    pub(super) ahead: Linkage,
    pub(super) behind: Linkage,
    /// Share of the step that they are away.
    pub(super) fraction: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Group {
    pub(super) arranged: ColumnMap,
    pub(super) rows: Vec<u32>,
    /// Whether its rows stay packed.
    pub(super) keeps: bool,
    /// Chunks of packed rows, if they stay packed.
    pub(super) packed: Vec<PackedRows>,
}
