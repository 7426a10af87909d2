//! Signs that the input is not what it seems: a fit can absorb mistakes, a registration cannot.

use super::{CalibrationOptions, DeviceFrameKnowledge, ModelAccuracy, RowError};
use crate::measurement::Dataset;

/// Registered error, as a share of the measurements' spread, beyond which the nominal model does not describe this data. Real robots
/// stay below a hundredth, simulated errors of several degrees on every axis below a tenth.
const MISFIT: f64 = 0.15;
/// Registered rotation error beyond which orientations mean something else than they are read as, degrees.
const TURNED_DEG: f64 = 20.0;

/// What the registered model's training errors say against the input.
pub(super) fn doubts(
    data: &Dataset,
    rows: &[u32],
    registered: &ModelAccuracy,
    frame: DeviceFrameKnowledge,
) -> Vec<String> {
    let mut doubts = Vec::new();
    let spread_mm = data.spread_m(rows) * 1e3;
    let error_mm = registered.position_mm.rms;
    if error_mm > MISFIT * spread_mm {
        let base = match frame {
            DeviceFrameKnowledge::Base => ", a device that does not stand at the base (--frame base)",
            DeviceFrameKnowledge::Unknown => "",
        };
        doubts.push(format!(
            "with nominal screws the measurements are missed by {error_mm:.1} mm (RMS), {:.0} % of their spread: \
             look for a wrong unit, exchanged or misnamed joint columns, mirrored coordinates{base}, or another robot",
            100.0 * error_mm / spread_mm
        ));
    }
    if let Some(rotation) = registered.rotation_deg.filter(|rotation| rotation.rms > TURNED_DEG) {
        doubts.push(format!(
            "with nominal screws the orientations are missed by {:.0} deg (RMS): look for the quaternion's order (x, y, z, w), \
             inverted poses, or another Euler convention",
            rotation.rms
        ));
    }
    doubts
}

/// Residuals that stated noise does not explain, or leaves no room for. The robot's own errors make them some times larger at most.
pub(super) fn noise_doubts(
    data: &Dataset,
    rows: &[u32],
    errors: &[RowError],
    options: &CalibrationOptions,
) -> Vec<String> {
    let seen = || rows.iter().map(|&row| &data.observations[row as usize]).zip(errors);
    let position = ratio(seen().filter_map(|(row, error)| {
        Some((error.position_m.norm(), row.sigma_position_m.or(options.sigma_position_m)?))
    }));
    let rotation = ratio(seen().filter_map(|(row, error)| {
        Some((error.rotation_rad?.norm(), row.sigma_rotation_rad.or(options.sigma_rotation_rad)?))
    }));
    [("position", position), ("rotation", rotation)]
        .into_iter()
        .filter_map(|(what, ratio)| noise_doubt(what, ratio?))
        .collect()
}

/// How many times their standard deviation errors are, from their lengths and that of each component; none if there are none.
fn ratio(errors: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let found: Vec<f64> = errors.map(|(length, sigma)| (length / sigma).powi(2) / 3.0).collect();
    (!found.is_empty()).then(|| (found.iter().sum::<f64>() / found.len() as f64).sqrt())
}

fn noise_doubt(what: &str, ratio: f64) -> Option<String> {
    const FACTOR: f64 = 8.0;
    if ratio > FACTOR {
        return Some(format!(
            "the {what} errors that the fit leaves are {ratio:.0} times the noise that is stated: look for a wrong unit of the noise, a \
             device that was moved, or mistakes in the rows"
        ));
    }
    // Exact data with a stated noise are a test, and no mistake.
    (ratio < 1.0 / FACTOR && ratio > 1e-6).then(|| {
        format!(
            "the {what} errors that the fit leaves are {:.0} times less than the noise that is stated: look for a wrong unit of the noise",
            1.0 / ratio
        )
    })
}
