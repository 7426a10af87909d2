//! Noise by which residuals are whitened: stated or estimated.

use serde::{Deserialize, Serialize};

use crate::CalibrationOptions;
use poecal_fit::state::{Estimate, Session};
use poecal_model::measurement::{ByQuantity, Dataset, Noise, Observation, Quantity};
use poecal_numerics::unit::Unit;

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

/// Residuals below this (1 nm, 1 nrad) are rounding, and their ratio means nothing.
pub(crate) const ROUNDING: f64 = 1e-9;

/// Unit noise: it whitens nothing.
const ONE: Noise = Noise::new(1.0, 1.0);

/// Least number of residuals, beyond a part's own unknowns, for an estimate of its noise.
const REDUNDANT: f64 = 6.0;

/// The stated noise; otherwise 1 mm and 1 mrad as a start.
pub(crate) fn first_guess(data: &Dataset, options: &CalibrationOptions) -> (Noise, NoiseSource) {
    let by_rows = |row: &Observation| {
        Quantity::ALL.into_iter().all(|it| !row.measurement.has(it) || row.stated.get(it).is_some())
    };
    let by_option = |quantity: Quantity| options.sigma[quantity].is_some() || !data.has(quantity);
    let is_given = Quantity::ALL.into_iter().all(by_option);
    let mut of_poses = Quantity::ALL.into_iter().filter(|quantity| quantity.is_of_pose());
    let source = if is_given && of_poses.all(|quantity| options.sigma[quantity].is_some()) {
        NoiseSource::Given
    } else if data.observations.iter().all(by_rows) {
        NoiseSource::Rows
    } else if is_given {
        NoiseSource::Given
    } else {
        NoiseSource::Estimated
    };
    let mut noise = Noise::new(1e-3, 1e-3);
    if source == NoiseSource::Rows {
        // No row uses this; it is the reported value.
        for (quantity, noise) in noise.values_mut() {
            let stated: Vec<f64> = data.observations.iter().filter_map(|row| row.stated.get(quantity)).collect();
            let squares: f64 = stated.iter().map(|sigma| sigma * sigma).sum();
            if !stated.is_empty() {
                *noise = (squares / stated.len() as f64).sqrt();
            }
        }
    }
    (merge_stated_noise(options, noise), source)
}

/// Marks each quantity whose noise is stated, by the options or by every row that has it.
pub(crate) fn is_stated(data: &Dataset, options: &CalibrationOptions) -> ByQuantity<bool> {
    ByQuantity::from_fn(|quantity| {
        let by_row = |row: &Observation| row.stated.get(quantity).is_some() || !row.measurement.has(quantity);
        options.sigma[quantity].is_some() || !data.is_empty() && data.observations.iter().all(by_row)
    })
}

/// Estimated noise, with stated components in their place.
pub(crate) fn merge_stated_noise(options: &CalibrationOptions, found: Noise) -> Noise {
    ByQuantity::from_fn(|quantity| options.sigma[quantity].unwrap_or(found[quantity]))
}

/// Noise of each quantity from the residuals of an estimate, each variance corrected for the unknowns: theory.md §6 (34). Rows
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
    let mut shares: ByQuantity<NoiseShare> = ByQuantity::default();
    let mut stated = 0;
    for (&row, squares) in rows.iter().zip(squares) {
        for (quantity, share) in shares.values_mut() {
            let (squares, count) = squares[quantity];
            let observation = session.observation(row);
            if observation.stated.get(quantity).is_some() {
                stated += count;
            } else {
                let ratio = session.usual_noise(observation.station, ONE)[quantity];
                share.squares += squares / (ratio * ratio);
                share.count += count;
            }
        }
    }
    // Rotations alone determine each target's orientation (3 unknowns); all other unknowns are shared in proportion.
    let turned = session.data.turns_of_targets(rows);
    let total = (shares.iter().map(|(_, share)| share.count).sum::<usize>() + stated) as f64;
    let others = ((unknowns - turned as f64).max(0.0) / (total - turned as f64).max(1.0)).min(1.0);
    let lengths = shares.iter().filter(|(quantity, _)| quantity.unit() == Unit::Metre);
    let lengths: usize = lengths.map(|(_, share)| share.count).sum();
    let angles = total as usize - stated - lengths;
    let found: ByQuantity<Option<f64>> = ByQuantity::from_fn(|quantity| {
        let share = &shares[quantity];
        let of_all = |all: usize| share.count as f64 / all.max(1) as f64;
        match (determined_by_rotations, quantity.unit()) {
            (Some(of_angles), Unit::Metre) if stated == 0 => {
                share.corrected_deviation((unknowns - of_angles) * of_all(lengths), 0.0)
            }
            (Some(of_angles), Unit::Radian) if stated == 0 => {
                share.corrected_deviation(of_angles * of_all(angles), turned as f64)
            }
            (_, Unit::Metre) => share.deviation(0, others),
            (_, Unit::Radian | Unit::One | Unit::Second) => share.deviation(turned, others),
        }
    });
    let mut estimated = found.iter().filter_map(|(_, deviation)| *deviation).peekable();
    if estimated.peek().is_some() && estimated.all(|deviation| deviation < ROUNDING) {
        return None;
    }
    Some(ByQuantity::from_fn(|quantity| found[quantity].map_or(before[quantity], |deviation| deviation.max(ROUNDING))))
}

/// Residuals of one noise.
#[derive(Clone, Copy, Default)]
struct NoiseShare {
    squares: f64,
    count: usize,
}

impl NoiseShare {
    /// Standard deviation, corrected for this number of unknowns; `None` if too few residuals remain beyond `own`.
    fn corrected_deviation(&self, unknowns: f64, own: f64) -> Option<f64> {
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
