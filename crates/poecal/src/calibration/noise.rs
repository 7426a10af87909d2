//! The noise by which residuals are whitened, where nobody has stated it.

use serde::{Deserialize, Serialize};

use super::CalibrationOptions;
use crate::estimate::{Chain, Estimate, Linkage, Packed};
use crate::measurement::{Dataset, Noise};

/// Where the noise came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NoiseSource {
    /// The user stated it.
    Given,
    /// Every row states its own.
    Rows,
    /// It was estimated from the residuals of the fit.
    Estimated,
    /// Nothing is left but rounding: the measurements are exact, and the noise is only what weighted them.
    Exact,
}

/// Below this (1 nm, 1 nrad) residuals are rounding, and their ratio says nothing.
const ROUNDING: f64 = 1e-9;

/// The stated noise, or 1 mm and 1 mrad to start with.
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
    (stated(options, Noise { position_m: 1e-3, rotation_rad: 1e-3 }), source)
}

/// A noise with the parts that the user has stated put in their place.
pub(super) fn stated(options: &CalibrationOptions, found: Noise) -> Noise {
    Noise {
        position_m: options.sigma_position_m.unwrap_or(found.position_m),
        rotation_rad: options.sigma_rotation_rad.unwrap_or(found.rotation_rad),
    }
}

/// Position and rotation noise as the residuals of an estimate show them, each component's variance separately, with the unknowns
/// taken off in proportion. What a row states is left out; a part that was not measured keeps `before`. `None` if the residuals are
/// only rounding.
#[must_use]
pub fn estimate_noise(
    data: &Dataset,
    packed: &Packed,
    rows: &[u32],
    estimate: &Estimate,
    unknowns: usize,
    before: Noise,
) -> Option<Noise> {
    let linkage = Linkage::new(estimate);
    let unit = Noise { position_m: 1.0, rotation_rad: 1.0 };
    let mut chain = Chain::default();
    let mut e = [0.0; 6];
    let (mut position, mut rotation) = ((0.0, 0usize), (0.0, 0usize));
    for &row in rows {
        let observation = &data.observations[row as usize];
        let model = observation.measurement.residual_model();
        chain.evaluate(&linkage, packed, row as usize, observation.target);
        model.residual(&chain.target, &unit, &mut e);
        let (split, dim) = (model.rotation_row(), model.dim());
        if observation.sigma_position_m.is_none() {
            position.0 += e[..split].iter().map(|e| e * e).sum::<f64>();
            position.1 += split;
        }
        if observation.sigma_rotation_rad.is_none() {
            rotation.0 += e[split..dim].iter().map(|e| e * e).sum::<f64>();
            rotation.1 += dim - split;
        }
    }
    let total = (position.1 + rotation.1) as f64;
    let free = ((total - unknowns as f64) / total).max(1.0 / total.max(1.0));
    let deviation = |(sum, count): (f64, usize), before: f64| {
        if count == 0 {
            return before;
        }
        (sum / (count as f64 * free)).sqrt()
    };
    let found = Noise {
        position_m: deviation(position, before.position_m),
        rotation_rad: deviation(rotation, before.rotation_rad),
    };
    let rounding =
        (position.1 > 0 && found.position_m < ROUNDING) || (rotation.1 > 0 && found.rotation_rad < ROUNDING);
    (!rounding).then_some(found)
}
