//! Nonlinear least squares on a manifold. It knows no robots: a problem gives normal information and applies steps.

mod gauss_newton;
mod levenberg_marquardt;
mod normal;
mod options;
mod reuse;
mod termination;
mod warm_start;

pub use levenberg_marquardt::minimize;
pub use normal::Normal;
pub use options::{Method, Options, Summary};
pub use termination::Termination;
pub use warm_start::{WarmStart, minimize_warm};

/// A problem `min ½ Σ e(x)²` whose unknowns are scaled so that one unit of each is comparable (metres, and radians times a length).
pub trait LeastSquares {
    /// A point of the manifold.
    type State: Clone;

    /// Number of unknowns of a step.
    fn dim(&self) -> usize;

    /// Residuals and their derivatives, as normal information.
    fn normal(&self, state: &Self::State) -> Normal;

    /// The same with a `JᵀJ` that may differ by a share that is quadratic in the residuals, where that spares time: for steps.
    fn nearly_normal(&self, state: &Self::State) -> Normal {
        self.normal(state)
    }

    /// The same without `JᵀJ`, which is left empty: for steps with an older one. `None` where that would save nothing.
    fn gradient(&self, _state: &Self::State) -> Option<Normal> {
        None
    }

    /// `Jᵀ e''(δ, δ)`: the residuals' second derivative along a step, projected (theory.md §6 (31)).
    fn second_order(&self, state: &Self::State, step: &[f64]) -> Vec<f64>;

    /// `-Σ e ∇²f` (upper triangle): what the Hessian has beside `JᵀJ` (theory.md §6 (31a)); `None` where it is not known.
    fn curvature(&self, state: &Self::State) -> Option<Vec<f64>>;

    /// Sets to zero what the retraction drops of a step, to first order: nothing, unless unknowns are constrained.
    fn keep(&self, _step: &mut [f64]) {}

    /// Mean squared whitened residual that is nothing but rounding: below it there is nothing left to fit.
    fn rounding(&self) -> f64;

    /// The state after a step.
    fn retract(&self, state: &Self::State, step: &[f64]) -> Self::State;
}
