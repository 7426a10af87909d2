//! Uncertainty of unknowns if others are held.

use super::{FitView, inflated_by};

/// Covariance (row-major) of the `kept` unknowns of a fit with all others held: (39) with the rows and columns of N and Λ that were kept
/// (theory.md §9 (39b)). It is computed from the upper triangle of N; κ is the `scatter`. `None` if a number is not finite.
pub fn held_covariance(view: &FitView<'_>, gram: &[f64], n: usize, scatter: f64, kept: &[usize]) -> Option<Vec<f64>> {
    let part = |all: &[f64]| -> Vec<f64> {
        let places = kept.iter().flat_map(|&i| kept.iter().map(move |&j| i.min(j) * n + i.max(j)));
        places.map(|at| all[at]).collect()
    };
    let prior = (part(&view.prior.normal.gram), view.prior.is_fitted);
    inflated_by((&part(gram), kept.len()), (&prior.0, prior.1), view.variance, scatter)
}
