//! How much each row decides its own prediction, and how far it is off when that is allowed for (theory.md §6 (34d), (34e)).

use rayon::prelude::*;

use crate::estimate::Estimate;
use crate::linalg::{self, Small, WIDTH};
use crate::problem::Problem;
use crate::solve::Normal;

/// Rows that one thread takes at a time.
const CHUNK: usize = 1024;
/// Share of the largest diagonal element that rounding makes of the normal equations' small eigenvalues.
const ROUNDING: f64 = 1e-13;
/// What a row keeps of its own variance at least: one that decides its prediction alone leaves no residual to judge it by.
const LEAST_REDUNDANCY: f64 = 1e-3;

/// What a row means to a fit, and the fit to it.
///
/// ```
/// let row = poecal::analysis::Influence { leverage: 0.1, studentized: 1.7 };
/// assert!(row.leverage < 1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Influence {
    /// Mean variance of the row's prediction in units of its noise: for a row fitted with weight 1 the mean diagonal of its block of
    /// the hat matrix, from 0 to 1; for others it may exceed that.
    pub leverage: f64,
    /// Length of the residual in units of its own standard deviation: the root of a χ² of as many degrees of freedom as the row has
    /// numbers.
    pub studentized: f64,
}

/// Influence of some rows on a fit with this normal information; `weights` by which they were fitted, one a row (0: not fitted).
/// `problem` is without weights. Residual components are divided by `scale(row, component)` first.
#[must_use]
pub fn influence(
    problem: &Problem<'_>,
    estimate: &Estimate,
    normal: &Normal,
    rows: &[u32],
    weights: &[f64],
    scale: impl Fn(u32, usize) -> f64 + Sync,
) -> Vec<Influence> {
    let n = normal.dim();
    let largest = (0..n).map(|i| normal.gram[i * n + i]).fold(0.0, f64::max);
    let factor = linalg::cholesky(&normal.gram, n, (ROUNDING * largest).max(f64::MIN_POSITIVE));
    let chunks: Vec<Vec<Influence>> = rows
        .par_chunks(CHUNK)
        .zip(weights.par_chunks(CHUNK))
        .map(|(rows, weights)| {
            let mut weights = weights.iter();
            let mut columns = Vec::new();
            let mut found = Vec::with_capacity(rows.len());
            problem.for_rows(estimate, rows, |row, jacobian, residual| {
                let weight = weights.next().copied().unwrap_or(1.0);
                let mut scaled = [0.0; WIDTH];
                for (k, (scaled, e)) in scaled.iter_mut().zip(residual).enumerate() {
                    *scaled = e / scale(row, k);
                }
                let hat = factor.as_ref().map(|factor| linalg::hat(factor, jacobian, &mut columns));
                found.push(row_influence(&hat.unwrap_or_default(), &scaled, residual.len(), weight));
            });
            found
        })
        .collect();
    chunks.into_iter().flatten().collect()
}

/// Of one row of `dim` numbers with `H = J N⁻¹ Jᵀ`: `t² = eᵀ (I - wH)⁻¹ (I + (1 - w)H)⁻¹ e`.
fn row_influence(hat: &Small, residual: &[f64; WIDTH], dim: usize, weight: f64) -> Influence {
    let leverage = (0..dim).map(|i| hat[i][i]).sum::<f64>() / dim.max(1) as f64;
    let solved = |x: [f64; WIDTH], share: f64, diagonal: f64| {
        let mut matrix = hat.map(|row| row.map(|h| share * h));
        (0..dim).for_each(|i| matrix[i][i] += diagonal);
        linalg::solve_small(matrix, x, dim).unwrap_or(x)
    };
    let left_out = solved(*residual, -weight, 1.0 + LEAST_REDUNDANCY);
    let judged = if weight < 1.0 { solved(left_out, 1.0 - weight, 1.0) } else { left_out };
    Influence { leverage, studentized: linalg::dot(residual, &judged).max(0.0).sqrt() }
}
