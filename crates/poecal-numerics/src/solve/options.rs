//! How to minimise, and what a minimisation did.

use super::Termination;

/// By which units steps are measured, and damped.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_numerics::solve;
/// # }
/// use poecal::solve::{Options, Scaling};
/// let options = Options { scaling: Scaling::Columns { damping: 1e-3 }, ..Options::default() };
/// assert!(options.reuse);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Scaling {
    /// Those that the problem gives its unknowns, which are comparable.
    #[default]
    Given,
    /// The norms of the columns of the Jacobian (after more1978): for unknowns that are not comparable. A column that is zero but for
    /// rounding then counts as much as any other.
    Columns {
        /// First damping, as a share of the columns' squared norms: 1e-3 unless the start is known to be good or bad. It takes the
        /// place of [`Options::trust`].
        damping: f64,
    },
}

/// How to minimise.
///
/// ```
/// let options = poecal_numerics::solve::Options { iterations: 20, ..Default::default() };
/// assert!(options.acceleration);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Most iterations (evaluations of the Jacobian after the first).
    pub iterations: usize,
    /// Ends when the predicted reduction of the undamped step is below this times the mean squared residual.
    pub decrement: f64,
    /// Ends when the undamped step is shorter than this (scaled units: metres).
    pub step: f64,
    /// Ends when a step shorter than this was rejected (scaled units: metres): it is rounding itself.
    pub rejected_step: f64,
    /// Standard deviation of a first, weak belief that the start is right (scaled units: metres): the first damping is
    /// `mean squared residual / trust²`. It shrinks with the residual, so that convergence stays quadratic.
    pub trust: f64,
    /// By which units steps are measured.
    pub scaling: Scaling,
    /// Whether to follow curvature: geodesic acceleration and the full Hessian.
    pub acceleration: bool,
    /// Smallest part of a step that is tried where the acceleration shortens it; a step that would be shortened more is rejected at once,
    /// since a more damped one goes farther. Zero tries all.
    pub shortest: f64,
    /// Whether close to the optimum steps may go on with the `JᵀJ` of an earlier state, where the problem gives
    /// [residuals and gradient](super::LeastSquares::gradient) apart from it. Without, each iteration builds `JᵀJ` anew: slower, with the
    /// same optimum.
    pub reuse: bool,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            iterations: 200,
            decrement: 1e-7,
            step: 1e-14,
            rejected_step: 1e-9,
            trust: 0.3,
            scaling: Scaling::Given,
            acceleration: true,
            shortest: 0.0,
            reuse: true,
        }
    }
}

/// What a minimisation did.
///
/// ```
/// # use poecal_numerics::solve::{Summary, Termination};
/// let summary = Summary { iterations: 4, termination: Termination::Optimum, trace: vec![] };
/// assert!(summary.termination.is_success());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Iterations: accepted and rejected steps.
    pub iterations: usize,
    /// Why it ended.
    pub termination: Termination,
    /// Mean squared whitened residual at the start and after each iteration.
    pub trace: Vec<f64>,
}
