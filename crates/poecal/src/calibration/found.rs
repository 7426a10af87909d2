//! What a fit comes to.

use super::NoiseSource;
use crate::estimate::Estimate;
use crate::measurement::Noise;
use crate::problem::Layout;
use crate::solve::{Normal, Summary, Termination};

/// The minimisation: steps, end, convergence.
#[derive(Clone, Debug, PartialEq)]
pub struct SolverReport {
    /// Iterations of the full fit, re-weighted rounds included.
    pub iterations: usize,
    /// Why it ended.
    pub termination: Termination,
    /// Further starts that were tried.
    pub restarts: usize,
    /// Mean square whitened residual by iteration.
    pub trace: Vec<f64>,
    /// Joint offsets (radians or metres): joint value minus reading, where the formulation has offsets. They are not
    /// identifiable beside the screws (lou2009 Proposition 1); the calibrated robot has them in its screws.
    pub joint_offsets: Option<Vec<f64>>,
}

/// A fit under way.
pub(super) struct Found {
    pub(super) estimate: Estimate,
    pub(super) normal: Normal,
    pub(super) report: SolverReport,
}

impl Found {
    /// What one minimisation found.
    pub(super) fn new((estimate, normal, summary): (Estimate, Normal, Summary)) -> Self {
        let report = SolverReport {
            iterations: summary.iterations,
            termination: summary.termination,
            restarts: 0,
            trace: summary.trace,
            joint_offsets: None,
        };
        Found { estimate, normal, report }
    }

    /// What one more minimisation made of it.
    pub(super) fn follow(&mut self, (estimate, normal, summary): (Estimate, Normal, Summary)) {
        (self.estimate, self.normal) = (estimate, normal);
        self.report.iterations += summary.iterations;
        self.report.termination = summary.termination;
        self.report.trace.extend(summary.trace);
    }
}

/// A finished fit.
pub(super) struct Fitted {
    pub(super) estimate: Estimate,
    pub(super) normal: Normal,
    pub(super) layout: Layout,
    pub(super) noise: Noise,
    pub(super) noise_source: NoiseSource,
    pub(super) report: SolverReport,
}
