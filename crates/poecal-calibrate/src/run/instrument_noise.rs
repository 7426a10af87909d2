//! Noise of each of several instruments, estimated apart.

use crate::robust::RobustFit;
use poecal_fit::state::Session;
use poecal_model::measurement::{ByQuantity, Noise};

/// Least change of a noise that is worth another fit, and least ratio between two instruments that is distinguished.
const CHANGE: f64 = 0.1;
/// Standard deviations of the logarithm of a ratio beyond which it is significant.
const SIGNIFICANT: f64 = 4.0;
/// Most fits with noises re-estimated.
pub(crate) const ROUNDS: usize = 4;

/// Residuals of one quantity and instrument, whitened by the noise of the fit.
#[derive(Clone, Copy, Default)]
struct NoiseSum {
    squares: f64,
    count: usize,
}

/// Noise of each instrument in units of the first one's, from the residuals of a fit that used `before` (empty: all alike). Rows that state their
/// noise and suspected rows do not count. `None` if that changes nothing (theory.md §6, *Noise*).
pub(crate) fn noise_ratios(session: &Session<'_>, rows: &[u32], fit: &RobustFit) -> Option<Vec<Noise>> {
    let stations = session.data.station_count();
    let rows: Vec<u32> = fit.robustness.rest(rows);
    let mut sums: Vec<ByQuantity<NoiseSum>> = vec![ByQuantity::default(); stations];
    let squares =
        session.map_squares(&rows, &fit.fitted.estimate, |observation, squares| (observation.station, squares));
    for (&row, (station, squares)) in rows.iter().zip(squares) {
        let observation = session.observation(row);
        let noise = session.noise_of(observation, fit.fitted.noise);
        for (quantity, sum) in sums[station].values_mut() {
            let (square, count) = squares[quantity];
            if observation.stated.get(quantity).is_none() && count > 0 {
                sum.squares += square / (noise[quantity] * noise[quantity]);
                sum.count += count;
            }
        }
    }
    let before = |station: usize| session.noise_ratios.get(station).copied().unwrap_or(Noise::new(1.0, 1.0));
    let mut found: Vec<Noise> = (0..stations).map(before).collect();
    let mut is_new = false;
    for (quantity, _) in Noise::new(1.0, 1.0).iter() {
        let Some(first) = sums.iter().map(|of| of[quantity]).find(|sum| sum.count > 0) else { continue };
        for (station, of) in sums.iter().enumerate().filter(|(_, of)| of[quantity].count > 0) {
            let own = of[quantity];
            let log = 0.5 * ((own.squares / own.count as f64) / (first.squares / first.count as f64)).ln();
            let chance = (0.5 / own.count as f64 + 0.5 / first.count as f64).sqrt();
            if log.is_finite() && log.abs() > CHANGE.max(SIGNIFICANT * chance) {
                found[station][quantity] *= log.exp();
                is_new = true;
            }
        }
    }
    is_new.then_some(found)
}
