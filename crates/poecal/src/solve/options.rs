//! How to minimise, and what a minimisation did.

use super::Termination;

/// By which steps to minimise.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Damped steps, taken only if they lower the cost.
    #[default]
    LevenbergMarquardt,
    /// Full steps, taken as they are: the iterated least squares of lou2009. It may diverge.
    GaussNewton,
}

impl Method {
    /// The stable word used in files and on the command line.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Method::LevenbergMarquardt => "levenberg-marquardt",
            Method::GaussNewton => "gauss-newton",
        }
    }
}

/// How to minimise.
///
/// ```
/// let options = poecal::solve::Options { iterations: 20, ..Default::default() };
/// assert!(options.acceleration);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// By which steps.
    pub method: Method,
    /// Most iterations (evaluations of the Jacobian after the first).
    pub iterations: usize,
    /// Ends when the predicted reduction of the undamped step is below this times the mean squared residual.
    pub decrement: f64,
    /// Ends when the undamped step is shorter than this (scaled units: metres).
    pub step: f64,
    /// Standard deviation of a first, weak belief that the start is right (scaled units: metres): the first damping is
    /// `mean squared residual / trust²`. It shrinks with the residual, so that convergence stays quadratic.
    pub trust: f64,
    /// Whether to follow curvature: geodesic acceleration and the full Hessian.
    pub acceleration: bool,
    /// Whether close to the optimum steps may go on with the `JᵀJ` of an earlier state, where the problem gives
    /// [residuals and gradient](super::LeastSquares::gradient) apart from it. Without, each iteration builds `JᵀJ` anew: slower, with the
    /// same optimum.
    pub reuse: bool,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            method: Method::default(),
            iterations: 200,
            decrement: 1e-7,
            step: 1e-14,
            trust: 0.3,
            acceleration: true,
            reuse: true,
        }
    }
}

/// What a minimisation did.
///
/// ```
/// # use poecal::solve::{Summary, Termination};
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
