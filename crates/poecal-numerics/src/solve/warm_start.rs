//! Minimisation that begins close to a known optimum, with its factorised `JᵀJ`.

use super::levenberg_marquardt::minimize;
use super::normal::ROUNDING;
use super::reuse::{converges_fast, is_final_step};
use super::{LeastSquares, NormalEquations, Options, Summary, Termination};
use crate::linalg::{self, Factor};

/// A state with its normal information and the factor of its `JᵀJ`.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_numerics::solve;
/// # }
/// use poecal::solve::{NormalEquations, WarmStart};
/// let mut normal = NormalEquations::new(1);
/// normal.add_rows(&[2.0], &[0.1], 0);
/// let start = WarmStart::new("a state", normal);
/// assert_eq!(start.state(), &"a state");
/// ```
#[derive(Clone, Debug)]
pub struct WarmStart<S> {
    state: S,
    normal: NormalEquations,
    /// Factor; `None` if `JᵀJ` is singular.
    factor: Option<Factor>,
}

impl<S> WarmStart<S> {
    /// Factorises the `JᵀJ` of a state.
    #[must_use]
    pub fn new(state: S, normal: NormalEquations) -> Self {
        let n = normal.dim();
        let scale = (0..n).map(|i| normal.gram[i * n + i]).fold(0.0, f64::max);
        let factor = linalg::cholesky(&normal.gram, n, ROUNDING * scale);
        WarmStart { state, normal, factor }
    }

    /// The state.
    #[must_use]
    pub fn state(&self) -> &S {
        &self.state
    }
}

/// Minimises from a state close to the optimum by undamped steps with the frozen `JᵀJ` of that state, which need residuals and gradients
/// alone; ends as [`minimize`] does. If such steps do not converge fast, or do not lower the cost, [`minimize`] continues from the best
/// state. Without [`Options::reuse`] it is [`minimize`] throughout.
pub fn minimize_warm<P: LeastSquares>(
    problem: &P,
    start: &WarmStart<P::State>,
    options: &Options,
) -> (P::State, NormalEquations, Summary) {
    let mut state = start.state.clone();
    let Some(factor) = start.factor.as_ref().filter(|_| options.reuse) else {
        return minimize(problem, state, options);
    };
    let Some(mut normal) = problem.gradient(&state) else { return minimize(problem, state, options) };
    let mut last_reduction = f64::INFINITY;
    let mut trace: Vec<f64> = Vec::new();
    loop {
        trace.push(normal.mean_square());
        let step = linalg::cholesky_solve(factor, &normal.gradient);
        let predicted = 0.5 * linalg::dot(&step, &normal.gradient);
        let threshold = options.decrement * normal.mean_square();
        let is_short = linalg::dot(&step, &step).sqrt() < options.step;
        let is_converged = is_short || predicted < threshold;
        if is_converged || is_final_step(predicted, last_reduction, threshold) {
            normal.gram.clone_from(&start.normal.gram);
            if !is_converged {
                state = problem.retract(&state, &step);
                normal.take_final_step(predicted);
                trace.push(normal.mean_square());
            }
            let termination = if is_short { Termination::StepVanished } else { Termination::Optimum };
            let summary = Summary { iterations: trace.len() - 1, termination, trace };
            return (state, normal, summary);
        }
        let next = problem.retract(&state, &step);
        let after = problem
            .gradient(&next)
            .filter(|after| after.cost < normal.cost && converges_fast(predicted, last_reduction));
        let Some(after) = after else { break };
        last_reduction = predicted;
        (state, normal) = (next, after);
    }
    let (state, normal, mut summary) = minimize(problem, state, options);
    summary.iterations += trace.len() - 1;
    summary.trace.splice(0..0, trace);
    (state, normal, summary)
}
