//! Configurations that are wrong as a whole: read before the arm settled, or paired with another row.

use std::ops::Range;

use nalgebra::DMatrix;

use super::rows::{Optimum, SessionRows};
use poecal_numerics::distributions::median;
use poecal_numerics::linalg;

/// Factor on the median beyond which errors are wrong; a configuration of several rows is wrong if most of them exceed half of that. With fewer
/// numbers than a pose has, the factor is doubled: single large errors are more common, and are judged as rows too.
const WRONG: f64 = 5.0;
const FEW_NUMBERS: usize = 6;
/// Share of that bound below which all errors stay if nothing is wrong.
const NEAR: f64 = 0.6;
/// Rounds of weighting configurations, and the number of them that only reduce weights gradually.
const ROUNDS: usize = 12;
const GENTLE: usize = 4;
/// Largest share of the configurations that may be wrong.
const MOST: f64 = 0.2;

/// Weights of the runs without the wrong ones, and the optimum with them. None is left out if too many would be.
pub(crate) fn without_wrong(rows: &SessionRows) -> Option<(Vec<f64>, Optimum)> {
    let all = vec![1.0; rows.runs.len()];
    let whole = rows.optimum(&all)?;
    let (mut weights, mut optimum) = (all.clone(), None);
    for round in 0..ROUNDS {
        let sizes = sizes(rows, optimum.as_ref().unwrap_or(&whole), &weights);
        let usual = median(sizes.iter().copied())?.max(f64::MIN_POSITIVE);
        let bound = |run: &Range<usize>| if rows.numbers(run).len() < FEW_NUMBERS { 2.0 * WRONG } else { WRONG };
        let ratios: Vec<f64> = sizes.iter().zip(&rows.runs).map(|(size, run)| size / usual / bound(run)).collect();
        // If no error comes near the bound, nothing is wrong.
        if round == 0 && ratios.iter().all(|ratio| *ratio < NEAR) {
            return Some((all, whole));
        }
        let next: Vec<f64> = if round < GENTLE {
            ratios.iter().map(|ratio| (0.5 / ratio).min(1.0)).collect()
        } else {
            ratios.iter().map(|ratio| f64::from(u8::from(*ratio <= 1.0))).collect()
        };
        if next == weights {
            break;
        }
        weights = next;
        optimum = Some(rows.optimum(&weights)?);
    }
    let Some(optimum) = optimum else { return Some((all, whole)) };
    let lengths = lengths(rows, &optimum);
    let usual = median(lengths.iter().copied())?;
    for (run, weight) in rows.runs.iter().zip(&mut weights).filter(|(_, weight)| **weight == 0.0) {
        let far = run.clone().filter(|&row| lengths[row] > 0.5 * WRONG * usual).count();
        if 2 * far <= run.len() {
            *weight = 1.0;
        }
    }
    let wrong = weights.iter().filter(|weight| **weight == 0.0).count();
    if wrong == 0 || wrong as f64 > MOST * weights.len() as f64 {
        return Some((all, whole));
    }
    let optimum = rows.optimum(&weights)?;
    Some((weights, optimum))
}

/// Root mean square of each row's residuals.
fn lengths(rows: &SessionRows, optimum: &Optimum) -> Vec<f64> {
    let of = |at: usize| {
        let (begin, end) = (rows.starts[at], rows.starts[at + 1]);
        (optimum.residual.rows(begin, end - begin).norm_squared() / (end - begin).max(1) as f64).sqrt()
    };
    (0..rows.rows.len()).map(of).collect()
}

/// Root mean square of each run's residuals by the fit of the others, relative to its expectation.
fn sizes(rows: &SessionRows, optimum: &Optimum, weights: &[f64]) -> Vec<f64> {
    let each = rows.runs.iter().zip(weights).map(|(run, weight)| {
        let numbers = rows.numbers(run);
        let n = numbers.len();
        let own = optimum.residual.rows(numbers.start, n).into_owned();
        let whitened = optimum.whitened.rows(numbers.start, n);
        let fitted = whitened * whitened.transpose();
        // Variance of a fitted run, reduced by the fit; for another run, increased by the uncertainty of the fit.
        let expected =
            if *weight > 0.0 { DMatrix::identity(n, n) - fitted * *weight } else { DMatrix::identity(n, n) + fitted };
        let square = linalg::solve_symmetric(expected, &own).map_or(0.0, |it| own.dot(&it));
        (square / n.max(1) as f64).sqrt()
    });
    each.collect()
}
