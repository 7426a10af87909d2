//! Block bootstrap: scatter of predictions if neighbourhoods of rows are drawn with replacement. The only assumption is that
//! neighbourhoods are independent.

use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::clusters::clusters;
use super::view::FitView;
use super::{covariance, factor, position_information};
use crate::state::sample_rows;
use poecal_model::simulate::random;
use poecal_numerics::linalg;
use poecal_numerics::solve::LeastSquares;

/// Largest number of rows of the bootstrap: more are sampled.
const SAMPLE: usize = 2000;
/// Approximate number of rows of a neighbourhood; largest and smallest number of neighbourhoods.
const NEIGHBOURHOOD: usize = 4;
const MOST: usize = 200;
const LEAST: usize = 10;
/// Number of bootstrap samples.
const DRAWINGS: usize = 400;

/// Scatter of predictions at the measured configurations, root mean square distance in metres (theory.md §9 (45)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bootstrap {
    /// Number of bootstrap samples.
    pub drawings: usize,
    /// Scatter over the bootstrap samples.
    pub sigma_m: f64,
    /// Scatter by the covariance, for residuals that are white noise.
    pub formal_sigma_m: f64,
}

/// Draws neighbourhoods of rows with replacement. Each bootstrap sample is refitted by one step with the common factor of
/// all rows (theory.md §9 (45)). `None` if the rows are too few.
#[must_use]
pub fn bootstrap(view: &FitView<'_>, seed: u64) -> Option<Bootstrap> {
    let rows = sample_rows(view.rows, SAMPLE);
    let count = (rows.len() / NEIGHBOURHOOD).min(MOST);
    if count < LEAST {
        return None;
    }
    let whole = view.problem(rows.clone()).normal(view.estimate);
    let n = whole.dim();
    if n == 0 || whole.residuals <= n {
        return None;
    }
    let variance = view.variance;
    let factor = factor(&whole.gram, n, view.prior, variance)?;
    let sample = FitView { rows: &rows, ..*view };
    let units = clusters(&sample, count);
    let steps: Vec<Vec<f64>> = units
        .iter()
        .map(|unit| linalg::cholesky_solve(&factor, &view.problem(unit.clone()).normal(view.estimate).gradient))
        .collect();
    let information = position_information(view, &rows);
    let mut generator = ChaCha8Rng::seed_from_u64(seed ^ 0x0062_6f6f_7473);
    let mean: Vec<f64> = (0..n).map(|k| steps.iter().map(|step| step[k]).sum::<f64>() / units.len() as f64).collect();
    let mut squares = 0.0;
    for _ in 0..DRAWINGS {
        let mut step = vec![0.0; n];
        for _ in 0..units.len() {
            let drawn = ((random::uniform_number(&mut generator) * units.len() as f64) as usize).min(units.len() - 1);
            step.iter_mut().zip(&steps[drawn]).zip(&mean).for_each(|((sum, own), mean)| *sum += own - mean);
        }
        squares += quadratic(&information, &step);
    }
    // The factors are for the degrees of freedom of the unknowns, for those of the mean, and for more rows than the sample.
    let freedom = whole.residuals as f64 / (whole.residuals - n) as f64;
    let units = units.len() as f64;
    let share = rows.len() as f64 / view.rows.len() as f64;
    let covariance = covariance(&factor, variance)?;
    let formal: f64 = covariance.iter().zip(&information).map(|(c, q)| c * q).sum();
    Some(Bootstrap {
        drawings: DRAWINGS,
        sigma_m: (squares / DRAWINGS as f64 * freedom * units / (units - 1.0) * share).sqrt(),
        formal_sigma_m: (formal * share).sqrt(),
    })
}

/// `δᵀ Q δ`.
fn quadratic(matrix: &[f64], step: &[f64]) -> f64 {
    matrix
        .chunks_exact(step.len())
        .zip(step)
        .map(|(row, a)| a * row.iter().zip(step).map(|(q, b)| q * b).sum::<f64>())
        .sum()
}
