//! Start and results of a fit.

use crate::NoiseSource;
use poecal_fit::problem::Layout;
use poecal_fit::state::Estimate;
use poecal_model::measurement::Noise;
use poecal_numerics::solve::{NormalEquations, Summary, Termination};

/// Report of the minimisation.
#[derive(Clone, Debug, PartialEq)]
pub struct SolverReport {
    /// Iterations of the full fit, re-weighted rounds included.
    pub iterations: usize,
    /// Reason of its end.
    pub termination: Termination,
    /// Number of further starts.
    pub restarts: usize,
    /// Mean square whitened residual by iteration.
    pub trace: Vec<f64>,
    /// Joint offsets (radians or metres): joint value minus reading, if the formulation has offsets. They are not identifiable beside the screws
    /// (lou2009 Proposition 1); the calibrated robot has them in its screws.
    pub joint_offsets: Option<Vec<f64>>,
}

/// Device frame and targets with nominal screws, and the noise estimated from their residuals.
#[derive(Clone)]
pub(crate) struct RegisteredStart {
    pub(crate) registered: Estimate,
    pub(crate) noise: Noise,
    pub(crate) source: NoiseSource,
}

/// A fit in progress.
pub(crate) struct OngoingFit {
    pub(crate) estimate: Estimate,
    pub(crate) normal: NormalEquations,
    pub(crate) report: SolverReport,
}

impl OngoingFit {
    /// Begins with one minimisation.
    pub(crate) fn new((estimate, normal, summary): (Estimate, NormalEquations, Summary)) -> Self {
        let report = SolverReport {
            iterations: summary.iterations,
            termination: summary.termination,
            restarts: 0,
            trace: summary.trace,
            joint_offsets: None,
        };
        OngoingFit { estimate, normal, report }
    }

    /// Continues with another minimisation.
    pub(crate) fn update(&mut self, (estimate, normal, summary): (Estimate, NormalEquations, Summary)) {
        (self.estimate, self.normal) = (estimate, normal);
        self.report.iterations += summary.iterations;
        self.report.termination = summary.termination;
        self.report.trace.extend(summary.trace);
    }
}

/// A finished fit.
#[derive(Clone)]
pub(crate) struct FinishedFit {
    pub(crate) estimate: Estimate,
    pub(crate) normal: NormalEquations,
    pub(crate) layout: Layout,
    pub(crate) noise: Noise,
    pub(crate) noise_source: NoiseSource,
    pub(crate) report: SolverReport,
}
