//! Rows that follow each other: whether what the fit leaves hangs together in time.

use super::clusters::SIGNIFICANT;
use super::view::View;

/// Fewest pairs by which it is judged.
const PAIRS: usize = 20;

/// Correlation of the residuals of one target in rows that follow each other in the data, if it is no chance: in white noise that of so
/// many components has a standard deviation of one over the root of their number.
pub(super) fn correlation(view: &View<'_>) -> Option<f64> {
    let mut rows = view.rows.to_vec();
    rows.sort_unstable();
    let errors = view.errors(&rows, view.estimate);
    let mut last: Vec<Option<(usize, u32)>> = vec![None; view.data.targets.len()];
    let (mut products, mut squares, mut components) = (0.0, 0.0, 0usize);
    for (at, &row) in rows.iter().enumerate() {
        let observation = &view.data.observations[row as usize];
        let Some(last) = last.get_mut(observation.target) else { continue };
        let before = last.replace((at, observation.source.file));
        let Some((before, file)) = before else { continue };
        // Rows of one configuration err alike for another reason.
        let is_elsewhere =
            view.values(rows[before]).iter().zip(view.values(row)).any(|(a, b)| (a - b).abs() > 1e-3);
        if file != observation.source.file || !is_elsewhere {
            continue;
        }
        let (a, b) = (&errors[before].position_m, &errors[at].position_m);
        products += a.dot(b);
        squares += 0.5 * (a.norm_squared() + b.norm_squared());
        components += 3;
    }
    let correlation = products / squares;
    let is_chance = correlation * (components as f64).sqrt() < SIGNIFICANT;
    (components >= 3 * PAIRS && !is_chance && correlation.is_finite()).then_some(correlation)
}
