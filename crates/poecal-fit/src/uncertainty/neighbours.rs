//! Correlation of the residuals of nearest neighbours, which noise does not have.

use nalgebra::Vector3;

use super::clusters::SIGNIFICANT;
use super::view::FitView;
use crate::state::{sample_rows, turn_to_first};
use poecal_model::measurement::ByQuantity;

/// Number of rows whose nearest neighbour is sought, and of rows among which it is sought.
const PROBES: usize = 400;
const NEIGHBOURS: usize = 4000;

/// For each quantity, true if the residuals of one subject in neighbouring configurations are correlated significantly (theory.md §9,
/// *Neighbours*).
pub(crate) fn correlated_quantities(view: &FitView<'_>) -> ByQuantity<bool> {
    let pool = sample_rows(view.rows, NEIGHBOURS);
    let mut errors = view.session.errors(&pool, view.estimate);
    turn_to_first(view.session.data, &pool, view.estimate, &mut errors);
    let spans = view.spans(view.rows);
    let subjects: Vec<_> = pool.iter().map(|&row| view.session.data.subject(row)).collect();
    let step = pool.len().div_ceil(PROBES).max(1);
    let joints = scale_values(view, &spans, &pool);
    let mut sums: ByQuantity<PairSums> = ByQuantity::default();
    let mut distances = vec![0.0; pool.len()];
    for a in (0..pool.len()).step_by(step) {
        square_distances(&joints, a, &mut distances);
        let (mut nearest, mut least) = (None, f64::INFINITY);
        for (b, &distance) in distances.iter().enumerate() {
            if distance < least && b != a && subjects[b] == subjects[a] {
                (nearest, least) = (Some(b), distance);
            }
        }
        let Some(b) = nearest else { continue };
        for (quantity, sums) in sums.values_mut() {
            let measured = |row: usize| errors[row].length(quantity).map(|_| errors[row].vector(quantity));
            let count = |row: usize| errors[row].part(quantity).len();
            let components = count(a).min(count(b));
            if let Some((a, b)) = measured(a).zip(measured(b)) {
                sums.add(&a, &b, components);
            }
        }
    }
    sums.map(|sums| sums.is_significant())
}

/// Values of each joint that moves, over its sampled range.
fn scale_values(view: &FitView<'_>, spans: &[f64], rows: &[u32]) -> Vec<Vec<f64>> {
    let moving = spans.iter().enumerate().filter(|(_, span)| **span > 0.0);
    moving.map(|(joint, span)| rows.iter().map(|&row| view.values(row)[joint] / span).collect()).collect()
}

/// Squared distance of all configurations from one, joint after joint: the innermost loop is over rows, side by side.
fn square_distances(joints: &[Vec<f64>], from: usize, distances: &mut [f64]) {
    distances.fill(0.0);
    for values in joints {
        let here = values[from];
        for (distance, value) in distances.iter_mut().zip(values) {
            *distance += (here - value) * (here - value);
        }
    }
}

/// Sums of products of neighbours' residuals.
#[derive(Clone, Copy, Default)]
struct PairSums {
    products: f64,
    squares: f64,
    components: usize,
}

impl PairSums {
    fn add(&mut self, a: &Vector3<f64>, b: &Vector3<f64>, components: usize) {
        self.products += a.dot(b);
        self.squares += 0.5 * (a.norm_squared() + b.norm_squared());
        self.components += components;
    }

    /// True if the correlation is significant. In white noise that of m components has the standard deviation `1/√m`.
    fn is_significant(&self) -> bool {
        self.products > SIGNIFICANT / (self.components as f64).sqrt() * self.squares
    }
}
