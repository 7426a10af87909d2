//! Plain Gauss-Newton: the iterated least squares of okamura1996 and lou2009. Every step is accepted as it is.

use poecal_numerics::solve::{LeastSquares, NormalEquations, Options, Summary, Termination};

/// Minimises from `start` by full steps; returns the final state, its normal information and a summary. It ends if the part of the step that the
/// retraction keeps vanishes, which with constraints restored after each step need not be a minimum (docs/theory.md §5 (22d)). It may diverge. It
/// uses the options `iterations`, `decrement` and `step`.
pub fn gauss_newton<P: LeastSquares>(
    problem: &P,
    start: P::State,
    options: &Options,
) -> (P::State, NormalEquations, Summary) {
    let mut state = start;
    let mut normal = problem.normal(&state);
    let mut trace = vec![normal.mean_square()];
    let mut iterations = 0;
    let termination = loop {
        let Some(step) = normal.full_step() else { break Termination::NotFinite };
        let mut kept = step.clone();
        problem.project_constraints(&mut kept);
        let length = kept.iter().map(|s| s * s).sum::<f64>().sqrt();
        if length < options.step || normal.mean_square() < problem.rounding() {
            break Termination::StepVanished;
        }
        if normal.predicted_reduction(&kept).abs() < options.decrement * normal.mean_square() {
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
