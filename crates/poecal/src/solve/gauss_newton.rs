//! Plain Gauss-Newton: the iterated least squares of okamura1996 and lou2009, for comparison. Every step is taken as it is.

use super::levenberg_marquardt::{ROUNDING, dot, norm};
use super::{LeastSquares, Normal, Options, Summary, Termination};
use crate::linalg;

/// Minimises from `start` by full steps. It ends where the part of the step that the retraction keeps is nothing, which with
/// constraints put right after each step need not be a minimum (docs/theory.md §5 (22d)). It may diverge.
pub(super) fn gauss_newton<P: LeastSquares>(
    problem: &P,
    start: P::State,
    options: &Options,
) -> (P::State, Normal, Summary) {
    let mut state = start;
    let mut normal = problem.normal(&state);
    let mut trace = vec![normal.mean_square()];
    let mut iterations = 0;
    let termination = loop {
        let Some(step) = full_step(&normal) else { break Termination::NotFinite };
        let kept = kept(problem, &step);
        let predicted = normal.predicted_reduction(&kept);
        if norm(&kept) < options.step || normal.mean_square() < problem.rounding() {
            break Termination::StepVanished;
        }
        if predicted.abs() < options.decrement * normal.mean_square() {
            break Termination::Optimum;
        }
        if iterations >= options.iterations {
            break Termination::IterationLimit;
        }
        iterations += 1;
        state = problem.retract(&state, &step);
        normal = problem.normal(&state);
        trace.push(normal.mean_square());
    };
    (state, normal, Summary { iterations, termination, trace })
}

/// The solution of the normal equations; where they are singular, that of least length (but for rounding). `None` if a number is
/// not finite.
fn full_step(normal: &Normal) -> Option<Vec<f64>> {
    let n = normal.dim();
    let scale = (0..n).map(|i| normal.gram[i * n + i]).fold(0.0, f64::max);
    if n == 0 || scale == 0.0 {
        return Some(vec![0.0; n]);
    }
    let factor = linalg::cholesky(&normal.gram, n, ROUNDING * scale)?;
    let step = linalg::cholesky_solve(&factor, &normal.gradient);
    (normal.cost.is_finite() && dot(&step, &step).is_finite()).then_some(step)
}

/// What the retraction keeps of a step, to first order.
pub(super) fn kept<P: LeastSquares>(problem: &P, step: &[f64]) -> Vec<f64> {
    let mut kept = step.to_vec();
    problem.keep(&mut kept);
    kept
}
