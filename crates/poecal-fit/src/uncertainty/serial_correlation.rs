//! Correlation of residuals along the order of the rows.

use std::collections::BTreeMap;

use super::clusters::SIGNIFICANT;
use super::view::FitView;
use poecal_model::measurement::Quantity;

/// Fewest pairs for a judgement.
const PAIRS: usize = 20;
/// Correlation of a joint's values in consecutive rows above which the configurations follow a path. The robot's errors then follow it
/// too, and a correlation of residuals is no evidence of drift.
const ORDERED: f64 = 0.5;

/// Correlation of the residuals of one subject in consecutive rows, if it is significant and no joint follows the order of the rows. In
/// white noise the correlation of m components has the standard deviation `1/√m` (theory.md §9, *Order*).
pub(crate) fn correlation(view: &FitView<'_>) -> Option<f64> {
    let mut rows = view.rows.to_vec();
    rows.sort_unstable();
    if is_ordered(view, &rows) {
        return None;
    }
    let errors = view.session.errors(&rows, view.estimate);
    let mut last: BTreeMap<(usize, Option<usize>), (usize, u32)> = BTreeMap::new();
    let (mut products, mut squares, mut components) = (0.0, 0.0, 0usize);
    for (at, &row) in rows.iter().enumerate() {
        let observation = view.session.observation(row);
        let before = last.insert(view.session.data.subject(row), (at, observation.source.file));
        let Some((before, file)) = before else { continue };
        // Rows of one configuration share the robot's error.
        let is_elsewhere = view.values(rows[before]).iter().zip(view.values(row)).any(|(a, b)| (a - b).abs() > 1e-3);
        if file != observation.source.file || !is_elsewhere {
            continue;
        }
        if errors[before].leading_quantity() != errors[at].leading_quantity() {
            continue;
        }
        let (a, b) = (&errors[before].lead(), &errors[at].lead());
        products += a.dot(b);
        squares += 0.5 * (a.norm_squared() + b.norm_squared());
        components += errors[at].leading_quantity().map_or(0, Quantity::components);
    }
    let correlation = products / squares;
    let is_chance = correlation * (components as f64).sqrt() < SIGNIFICANT;
    (components >= 3 * PAIRS && !is_chance && correlation.is_finite()).then_some(correlation)
}

/// True if some joint moves little from row to row.
fn is_ordered(view: &FitView<'_>, rows: &[u32]) -> bool {
    let count = rows.len().max(1) as f64;
    let joints = view.session.robot.joints.len();
    (0..joints).any(|joint| {
        let value = |row: &u32| view.values(*row)[joint];
        let mean = rows.iter().map(value).sum::<f64>() / count;
        let squares: f64 = rows.iter().map(|row| (value(row) - mean).powi(2)).sum();
        let products: f64 = rows.windows(2).map(|pair| (value(&pair[0]) - mean) * (value(&pair[1]) - mean)).sum();
        squares > 0.0 && products > ORDERED * squares
    })
}
