//! Options and summary of a minimisation.

use super::Termination;

/// Units by which steps are measured, and damped.
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
    /// Units of the problem's unknowns, which are comparable.
    #[default]
    Given,
    /// Norms of the columns of the Jacobian (after more1978): for unknowns that are not comparable. A column that is zero except for
    /// rounding then counts as much as any other.
    Columns {
        /// First damping, as a share of the columns' squared norms: 1e-3 unless the start is known to be good or bad. It takes the
        /// place of [`Options::trust`].
        damping: f64,
    },
}

/// Options of a minimisation.
///
/// ```
/// let options = poecal_numerics::solve::Options { iterations: 20, ..Default::default() };
/// assert!(options.acceleration);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Largest number of iterations (evaluations of the Jacobian after the first).
    pub iterations: usize,
    /// Threshold of convergence: it ends when the predicted reduction of the undamped step is below this times the mean squared residual.
    pub decrement: f64,
    /// Shortest undamped step, below which it ends (scaled units: metres).
    pub step: f64,
    /// Shortest rejected step, below which it ends (scaled units: metres): such a step is only rounding.
    pub rejected_step: f64,
    /// Standard deviation of a weak prior at the start (scaled units: metres): the first damping is `mean squared
    /// residual / trust²`. It shrinks with the residual, so that convergence stays quadratic.
    pub trust: f64,
    /// Units by which steps are measured.
    pub scaling: Scaling,
    /// True if steps follow curvature: geodesic acceleration and the full Hessian.
    pub acceleration: bool,
    /// Smallest part of a step that is tried if the acceleration shortens it. A step that would be shortened more is rejected at once,
    /// since a more damped one goes farther. Zero tries all.
    pub shortest: f64,
    /// True if steps close to the optimum may continue with the `JᵀJ` of an earlier state. The problem must supply [residuals and
    /// gradient](super::LeastSquares::gradient) apart from it. Otherwise each iteration builds a new `JᵀJ`: slower, with the same
    /// optimum.
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

/// Summary of a minimisation.
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
    /// Reason of the end.
    pub termination: Termination,
    /// Mean squared whitened residual at the start and after each iteration.
    pub trace: Vec<f64>,
}
