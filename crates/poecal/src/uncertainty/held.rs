//! How well unknowns are known when others are held.

use super::{View, covariance};
use crate::linalg;

/// Covariance (row-major) of the `kept` unknowns of a fit with all others held: `κ s² H⁻¹` with the rows and columns of `H = N + s²Λ` that
/// were kept (theory.md §9 (39b)). From the upper triangle of N; κ is the `scatter`. `None` if a number is not finite.
pub(crate) fn held_covariance(
    view: &View<'_>,
    gram: &[f64],
    n: usize,
    scatter: f64,
    kept: &[usize],
) -> Option<Vec<f64>> {
    let all = view.prior.with(gram, view.variance);
    let part: Vec<f64> = kept
        .iter()
        .flat_map(|&i| kept.iter().map(move |&j| i.min(j) * n + i.max(j)))
        .map(|at| all[at])
        .collect();
    covariance(&linalg::cholesky(&part, kept.len(), 0.0)?, view.variance * scatter)
}
