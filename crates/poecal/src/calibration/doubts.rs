//! Signs that the input is not what it seems: a fit can absorb mistakes, a registration cannot.

use nalgebra::Vector3;

use super::{DeviceFrameKnowledge, ModelAccuracy, RowError};
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

/// A place in the order of the rows from which on all lie beside those before: a device or a target that was moved. It is the change of
/// mean that explains most of the squared errors, if it is more than three times what is left of each component, and no chance.
pub(super) fn moved(data: &Dataset, rows: &[u32], errors: &[RowError]) -> Option<String> {
    // Single regions of the workspace, measured one after the other, may err by twice what is usual.
    const LEAST_SHARE: f64 = 0.1;
    const LEAST_ROWS: usize = 4;
    const SIGMAS: f64 = 3.0;
    const CHANCE: f64 = 40.0;
    let m = errors.len();
    let total: Vector3<f64> = errors.iter().map(|error| error.position_m).sum();
    let squares: f64 = errors.iter().map(|error| error.position_m.norm_squared()).sum();
    let mut before = Vector3::zeros();
    let mut best = (0.0, 0, Vector3::zeros());
    for (k, error) in errors.iter().enumerate() {
        before += error.position_m;
        let (count, rest) = (k + 1, m - k - 1);
        if count.min(rest) < LEAST_ROWS || (count.min(rest) as f64) < LEAST_SHARE * m as f64 {
            continue;
        }
        let shift = (total - before) / rest as f64 - before / count as f64;
        let explained = shift.norm_squared() * count as f64 * rest as f64 / m as f64;
        if explained > best.0 {
            best = (explained, count, shift);
        }
    }
    let (explained, at, shift) = best;
    let variance = (squares - explained - total.norm_squared() / m.max(1) as f64).max(0.0)
        / (3 * m.max(2) - 6).max(1) as f64;
    if at == 0
        || shift.norm() < 1e-6
        || shift.norm() < SIGMAS * variance.sqrt()
        || explained < CHANCE * variance
    {
        return None;
    }
    Some(format!(
        "from {} on the measurements lie {:.2} mm beside those before: the measuring device or the target seems to have been moved; \
         calibrate each part by itself, or only one of them",
        data.place(rows[at]),
        1e3 * shift.norm()
    ))
}
