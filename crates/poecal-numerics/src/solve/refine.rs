//! The last digits: steps that are judged by the gradient, since rounding of the cost hides their reductions (theory.md §6, *The last
//! digits*; hager2005).

use super::{LeastSquares, NormalEquations};
use crate::linalg;

/// Largest relative increase of the cost that may be rounding.
const SAME_COST: f64 = 1e-9;

/// Largest ratio of a step's predicted reduction to that of the step before: larger ones are rounding of the gradient.
const LARGEST_RATIO: f64 = 0.7;

/// Takes undamped steps from the optimum by the cost, as long as their predicted reductions fall; returns their number. They are
/// solved with `hessian` (upper triangle) plus `floor` on its diagonal.
pub(crate) fn refine<P: LeastSquares>(
    problem: &P,
    state: &mut P::State,
    normal: &mut NormalEquations,
    hessian: &[f64],
    floor: f64,
    most: usize,
) -> usize {
    let Some(factor) = linalg::cholesky(hessian, problem.dim(), floor) else { return 0 };
    let undamped = |normal: &NormalEquations| {
        let step = linalg::cholesky_solve(&factor, &normal.gradient);
        let predicted = 0.5 * linalg::dot(&step, &normal.gradient);
        (step, predicted)
    };
    let (mut step, mut predicted) = undamped(normal);
    for count in 0..most {
        let next = problem.retract(state, &step);
        let after = problem.nearly_normal(&next);
        let (next_step, next_predicted) = undamped(&after);
        let is_same_cost = after.cost <= normal.cost * (1.0 + SAME_COST);
        if !(is_same_cost && next_predicted < LARGEST_RATIO * predicted) {
            return count;
        }
        (*state, *normal, step, predicted) = (next, after, next_step, next_predicted);
    }
    most
}
