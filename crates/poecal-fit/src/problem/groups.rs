//! Rows of a problem by instrument, target and form, as they are packed for the kernels.

use super::kernel_columns::KernelColumns;
use super::scatter::GramScatter;
use crate::state::Linkage;
use poecal_numerics::kernels::{PackedRows, SimdLevel};

/// Sums over rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Accumulate {
    /// Cost, gradient and `JᵀJ`.
    All,
    /// The same sums; `JᵀJ` may lack the curvature of the logarithm, where that saves time.
    GaussNewton,
    /// Cost and gradient.
    Gradient,
}

/// Groups of rows of a problem.
#[derive(Clone, Debug)]
pub(crate) struct FastRows {
    pub(crate) groups: Vec<(KernelGroup, GramScatter)>,
    pub(crate) level: SimdLevel,
    /// Linkage of the state at which it was built; its joints are those of every other state.
    pub(crate) linkage: Linkage,
    /// A step along which residuals are replaced by their second derivative.
    pub(crate) second: Option<SecondDifference>,
}

/// A step, by the frames ahead of a state and behind it.
#[derive(Clone, Debug)]
pub(crate) struct SecondDifference {
    pub(crate) ahead: Linkage,
    pub(crate) behind: Linkage,
    /// Distance of these frames, as a share of the step.
    pub(crate) fraction: f64,
}

#[derive(Clone, Debug)]
pub(crate) struct KernelGroup {
    pub(crate) arranged: KernelColumns,
    pub(crate) rows: Vec<u32>,
    /// True if its rows stay packed.
    pub(crate) keeps: bool,
    /// Chunks of packed rows, if they stay packed.
    pub(crate) packed: Vec<PackedRows>,
}
