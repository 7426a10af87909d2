//! Noise by which residuals are whitened: stated or estimated.

use serde::{Deserialize, Serialize};

use super::CalibrationOptions;
use crate::estimate::{Estimate, Session};
use crate::measurement::{Dataset, Noise, Observation};

/// Source of the noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NoiseSource {
    /// The user stated it.
    Given,
    /// Every row states its own.
    Rows,
    /// It was estimated from the residuals of the fit.
    Estimated,
    /// The residuals are rounding errors: the measurements are exact, and the noise only weights them.
    Exact,
}

/// Below this (1 nm, 1 nrad) residuals are rounding, and their ratio means nothing.
pub(super) const ROUNDING: f64 = 1e-9;

/// Least number of residuals, beyond a part's own unknowns, for an estimate of its noise.
const REDUNDANT: f64 = 6.0;

/// The stated noise; otherwise 1 mm and 1 mrad to begin with.
pub(super) fn first_guess(data: &Dataset, options: &CalibrationOptions) -> (Noise, NoiseSource) {
    let source = if options.sigma_position_m.is_some() && options.sigma_rotation_rad.is_some() {
        NoiseSource::Given
    } else if data.observations.iter().all(|row| {
        row.sigma_position_m.is_some()
            && (row.sigma_rotation_rad.is_some() || !row.measurement.sees_orientation())
    }) {
        NoiseSource::Rows
    } else if options.sigma_position_m.is_some()
        && !data.observations.iter().any(|row| row.measurement.sees_orientation())
    {
        NoiseSource::Given
    } else {
        NoiseSource::Estimated
    };
    let mut noise = Noise { position_m: 1e-3, rotation_rad: 1e-3 };
    if source == NoiseSource::Rows {
        // No row uses this; it is the value that users see.
        let usual = |of: fn(&Observation) -> Option<f64>, other: f64| {
            let stated: Vec<f64> = data.observations.iter().filter_map(of).collect();
            let squares: f64 = stated.iter().map(|sigma| sigma * sigma).sum();
            if stated.is_empty() { other } else { (squares / stated.len() as f64).sqrt() }
        };
        noise.position_m = usual(|row| row.sigma_position_m, noise.position_m);
        noise.rotation_rad = usual(|row| row.sigma_rotation_rad, noise.rotation_rad);
    }
    (stated(options, noise), source)
}

/// Whether the noise of positions, and that of rotations, is stated, by the options or by every row.
pub(super) fn is_stated(data: &Dataset, options: &CalibrationOptions) -> [bool; 2] {
    let by_rows = |of: fn(&Observation) -> bool| !data.is_empty() && data.observations.iter().all(of);
    [
        options.sigma_position_m.is_some() || by_rows(|row| row.sigma_position_m.is_some()),
        options.sigma_rotation_rad.is_some()
            || by_rows(|row| row.sigma_rotation_rad.is_some() || !row.measurement.sees_orientation()),
    ]
}

/// Estimated noise, with the parts that the user stated in their place.
pub(super) fn stated(options: &CalibrationOptions, found: Noise) -> Noise {
    Noise {
        position_m: options.sigma_position_m.unwrap_or(found.position_m),
        rotation_rad: options.sigma_rotation_rad.unwrap_or(found.rotation_rad),
    }
}

/// Noise of positions and of rotations from the residuals of an estimate, each variance corrected for the unknowns: theory.md §6 (34). Rows
/// that state their noise do not count; a part with few measurements keeps `before`. `None` if the residuals are only rounding.
#[must_use]
pub fn estimate_noise(
    session: &Session<'_>,
    rows: &[u32],
    estimate: &Estimate,
    unknowns: f64,
    determined_by_rotations: Option<f64>,
    before: Noise,
) -> Option<Noise> {
    let squares = session.map_squares(rows, estimate, |_, squares| squares);
    let (mut position, mut rotation) = (Share::default(), Share::default());
    let mut stated = 0;
    for (&row, squares) in rows.iter().zip(squares) {
        let Observation { sigma_position_m, sigma_rotation_rad, .. } = session.observation(row);
        let shares = [(&mut position, sigma_position_m), (&mut rotation, sigma_rotation_rad)];
        for ((squares, count), (share, sigma)) in squares.into_iter().zip(shares) {
            if sigma.is_some() {
                stated += count;
            } else {
                share.squares += squares;
                share.count += count;
            }
        }
    }
    // Each target's orientation (3 unknowns) is determined by rotations alone; all other unknowns are shared in proportion.
    let turned = 3 * session.data.frames(rows).iter().filter(|&&is_frame| is_frame).count();
    let total = (position.count + rotation.count + stated) as f64;
    let others = ((unknowns - turned as f64).max(0.0) / (total - turned as f64).max(1.0)).min(1.0);
    let (position_m, rotation_rad) = match determined_by_rotations {
        Some(of_rotations) if stated == 0 => {
            (position.less(unknowns - of_rotations, 0.0), rotation.less(of_rotations, turned as f64))
        }
        _ => (position.deviation(0, others), rotation.deviation(turned, others)),
    };
    let mut estimated = [position_m, rotation_rad].into_iter().flatten().peekable();
    if estimated.peek().is_some() && estimated.all(|deviation| deviation < ROUNDING) {
        return None;
    }
    Some(Noise {
        position_m: position_m.map_or(before.position_m, |deviation| deviation.max(ROUNDING)),
        rotation_rad: rotation_rad.map_or(before.rotation_rad, |deviation| deviation.max(ROUNDING)),
    })
}

/// Residuals of one noise.
#[derive(Default)]
struct Share {
    squares: f64,
    count: usize,
}

impl Share {
    /// Standard deviation, corrected for so many unknowns; `None` if too few residuals remain beyond `own`.
    fn less(&self, unknowns: f64, own: f64) -> Option<f64> {
        let redundancy = (self.count as f64 - unknowns).max(1.0);
        (self.count as f64 - own >= REDUNDANT).then(|| (self.squares / redundancy).sqrt())
    }

    /// Standard deviation, corrected for `own` unknowns and a share `others` of the rest; `None` if too few residuals remain.
    fn deviation(&self, own: usize, others: f64) -> Option<f64> {
        let left = self.count.saturating_sub(own) as f64;
        let redundancy = (left * (1.0 - others)).max(1.0);
        (left >= REDUNDANT).then(|| (self.squares / redundancy).sqrt())
    }
}
