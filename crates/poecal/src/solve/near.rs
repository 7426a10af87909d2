//! Minimisation close to a known optimum, with its factorised `JᵀJ`.

use super::levenberg_marquardt::{FAST, ROUNDING, is_sure, minimize};
use super::{LeastSquares, Normal, Options, Summary, Termination};
use crate::linalg::{self, Factor};

/// A state with its normal information and the factor of its `JᵀJ`.
///
/// ```
/// use poecal::solve::{Near, Normal};
/// let mut normal = Normal::new(1);
/// normal.add_rows(&[2.0], &[0.1], 0);
/// let near = Near::new("a state", normal);
/// assert_eq!(near.state(), &"a state");
/// ```
#[derive(Clone, Debug)]
pub struct Near<S> {
    state: S,
    normal: Normal,
    /// None where `JᵀJ` is singular.
    factor: Option<Factor>,
}

impl<S> Near<S> {
    /// Factorises.
    #[must_use]
    pub fn new(state: S, normal: Normal) -> Self {
        let n = normal.dim();
        let scale = (0..n).map(|i| normal.gram[i * n + i]).fold(0.0, f64::max);
        let factor = linalg::cholesky(&normal.gram, n, ROUNDING * scale);
        Near { state, normal, factor }
    }

    /// The state.
    #[must_use]
    pub fn state(&self) -> &S {
        &self.state
    }
}

/// Minimises from a state close to the optimum by full steps with the `JᵀJ` of that state, which need residuals and gradients alone;
/// ends as [`minimize`] does. Where such steps do not converge fast, or do not lower the cost, [`minimize`] goes on from the best state.
pub fn minimize_near<P: LeastSquares>(
    problem: &P,
    near: &Near<P::State>,
    options: &Options,
) -> (P::State, Normal, Summary) {
    let mut state = near.state.clone();
    let mut promised = f64::INFINITY;
    let mut trace: Vec<f64> = Vec::new();
    let Some(factor) = &near.factor else { return minimize(problem, state, options) };
    let Some(mut normal) = problem.gradient(&state) else { return minimize(problem, state, options) };
    loop {
        trace.push(normal.mean_square());
        let step = linalg::cholesky_solve(factor, &normal.gradient);
        let promise = 0.5 * linalg::dot(&step, &normal.gradient);
        let end = options.decrement * normal.mean_square();
        let is_short = linalg::dot(&step, &step).sqrt() < options.step;
        let is_last = is_short || promise < end;
        if is_last || is_sure(promise, promised, end) {
            normal.gram.clone_from(&near.normal.gram);
            if !is_last {
                state = problem.retract(&state, &step);
                normal.end(promise);
                trace.push(normal.mean_square());
            }
            let termination = if is_short { Termination::StepVanished } else { Termination::Optimum };
            let summary = Summary { iterations: trace.len() - 1, termination, trace };
            return (state, normal, summary);
        }
        let next = problem.retract(&state, &step);
        let after =
            problem.gradient(&next).filter(|after| after.cost < normal.cost && promise < FAST * promised);
        let Some(after) = after else { break };
        promised = promise;
        (state, normal) = (next, after);
    }
    let (state, normal, mut summary) = minimize(problem, state, options);
    summary.iterations += trace.len() - 1;
    summary.trace.splice(0..0, trace);
    (state, normal, summary)
}
