//! Residuals of nearest neighbours: what they have in common is no noise.

use nalgebra::Vector3;

use super::clusters::SIGNIFICANT;
use super::view::View;
use crate::estimate::sample_rows;

/// Rows whose nearest neighbour is looked for, and rows among which it is.
const PROBES: usize = 400;
const NEIGHBOURS: usize = 4000;

/// Whether the residuals of one target in neighbouring configurations are alike beyond chance: of positions, and of rotations.
pub(super) fn alike(view: &View<'_>) -> (bool, bool) {
    let pool = sample_rows(view.rows, NEIGHBOURS);
    let errors = view.errors(&pool, view.estimate);
    let spans = view.spans(view.rows);
    let target = |row: u32| view.data.observations[row as usize].target;
    let step = pool.len().div_ceil(PROBES).max(1);
    let scaled: Vec<f64> = pool.iter().flat_map(|&row| scaled(view, &spans, row)).collect();
    let joints = scaled.len() / pool.len().max(1);
    let values = |at: usize| &scaled[at * joints..(at + 1) * joints];
    let (mut position, mut rotation) = (Shared::default(), Shared::default());
    for (a, &probe) in pool.iter().enumerate().step_by(step) {
        let mut nearest: Option<(usize, f64)> = None;
        for (b, &row) in pool.iter().enumerate() {
            if b == a || target(row) != target(probe) {
                continue;
            }
            let distance = values(a).iter().zip(values(b)).map(|(a, b)| (a - b).powi(2)).sum();
            if nearest.is_none_or(|(_, least)| distance < least) {
                nearest = Some((b, distance));
            }
        }
        let Some((b, _)) = nearest else { continue };
        position.add(&errors[a].position_m, &errors[b].position_m);
        if let (Some(a), Some(b)) = (&errors[a].rotation_rad, &errors[b].rotation_rad) {
            rotation.add(a, b);
        }
    }
    (position.is_significant(), rotation.is_significant())
}

/// The joint values of a row, each against how far it moves; of joints that do not move, nothing.
fn scaled(view: &View<'_>, spans: &[f64], row: u32) -> impl Iterator<Item = f64> {
    let each = view.values(row).iter().zip(spans).filter(|(_, span)| **span > 0.0);
    each.map(|(value, span)| value / span)
}

/// Products of neighbours' residuals.
#[derive(Default)]
struct Shared {
    products: f64,
    squares: f64,
    pairs: usize,
}

impl Shared {
    fn add(&mut self, a: &Vector3<f64>, b: &Vector3<f64>) {
        self.products += a.dot(b);
        self.squares += 0.5 * (a.norm_squared() + b.norm_squared());
        self.pairs += 1;
    }

    /// In white noise the correlation of that many components has a standard deviation of one over the root of their number.
    fn is_significant(&self) -> bool {
        self.products > SIGNIFICANT / (3.0 * self.pairs as f64).sqrt() * self.squares
    }
}
