//! Registration of data with gross errors.

use super::registration::{Registration, free_parameters};
use super::stations::register;
use crate::state::Estimate;
use poecal_numerics::distributions::median;
use poecal_numerics::solve::{Options, minimize};

/// Largest number of reweightings of a robust registration.
const REWEIGHTINGS: usize = 20;

/// Registers data with gross errors in up to a third of the rows. First comes the ordinary registration, then the sum of distances
/// instead of squares by reweighting. The same follows once more from the better two thirds of the rows. The lower median distance wins
/// (theory.md §6 (34c)).
#[must_use]
pub fn register_robustly(problem: &Registration<'_>, start: &Estimate) -> Estimate {
    let (first, first_median, distances) = least_distances(problem, register(problem, start).0);
    let mut order: Vec<usize> = (0..distances.len()).collect();
    order.sort_by(|&a, &b| distances[a].total_cmp(&distances[b]));
    order.truncate(2 * order.len() / 3);
    order.sort_unstable();
    let rows: Vec<u32> = order.iter().map(|&k| problem.rows[k]).collect();
    let better = Registration { rows: &rows, ..*problem };
    let (second, second_median, _) = least_distances(problem, register(&better, start).0);
    // A later start must be clearly better, so that rounding does not choose between equal ones.
    if second_median < first_median * (1.0 - 1e-6) { second } else { first }
}

/// Reweights a registration by the inverse whitened distance of each row. Returns it with the median of the distances, and the distances.
fn least_distances(problem: &Registration<'_>, start: Estimate) -> (Estimate, f64, Vec<f64>) {
    let free = free_parameters(problem, problem.rows);
    let options = Options { iterations: 5, trust: 10.0, ..Options::default() };
    let unweighted = |rows: &[u32]| problem.least_squares(rows.to_vec(), free.clone());
    let mut estimate = start;
    let mut weights = vec![0.0; problem.session.data.len()];
    let mut median = f64::INFINITY;
    for _ in 0..REWEIGHTINGS {
        let (distances, found) = distances(problem, &estimate);
        if found >= median * (1.0 - 1e-3) {
            break;
        }
        median = found;
        for (&row, distance) in problem.rows.iter().zip(&distances) {
            weights[row as usize] = 1.0 / distance.max(median).max(f64::MIN_POSITIVE);
        }
        let weighted = unweighted(problem.rows).with_weights(&weights);
        estimate = minimize(&weighted, estimate, &options).0;
    }
    let (distances, median) = distances(problem, &estimate);
    (estimate, median, distances)
}

/// Whitened distance of each row of a registration from an estimate.
#[must_use]
pub fn row_distances(problem: &Registration<'_>, estimate: &Estimate) -> Vec<f64> {
    distances(problem, estimate).0
}

/// Whitened distance of each row, and the median of them all.
fn distances(problem: &Registration<'_>, estimate: &Estimate) -> (Vec<f64>, f64) {
    let Registration { session, rows, noise, .. } = problem;
    let distances = session.map_squares(rows, estimate, |observation, squares| {
        let whitened = session.whiten_squares(observation, squares.map(|(squares, _)| squares), *noise);
        whitened.iter().map(|(_, square)| square).sum::<f64>().sqrt()
    });
    let median = median(distances.iter().copied()).unwrap_or(0.0);
    (distances, median)
}
