//! Information of measurements with a prior.

use super::view::PriorInformation;
use poecal_numerics::linalg::{self, Factor};

/// Rounding of the normal equations, as a share of their largest diagonal element.
pub(super) const ROUNDING: f64 = 1e-15;

/// Factor of `JᵀJ + variance · prior`, the H of theory.md §9 (39).
pub(super) fn factor(gram: &[f64], n: usize, prior: &PriorInformation, variance: f64) -> Option<Factor> {
    let both = prior.added_to(gram, variance);
    let largest = (0..n).map(|k| both[k * n + k]).fold(0.0, f64::max);
    linalg::cholesky(&both, n, ROUNDING * largest)
}
