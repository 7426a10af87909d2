//! Signs of mistakes in the input. A fit can absorb them, a registration cannot.

pub(crate) mod diagnostics;
pub(crate) mod fault_explanation;
pub(crate) mod noise_doubts;
pub(crate) mod single_offset;
pub(crate) mod suspicion;

use super::{DeviceFrameKnowledge, ModelAccuracy};
use crate::run::accuracy::CORNERS;
use poecal_model::measurement::Dataset;

/// Registered error, as a share of the measurements' spread, above which the nominal model does not describe the data. Real robots stay
/// below 0.01, simulated errors of several degrees on every axis below 0.1.
const MISFIT: f64 = 0.15;
/// Registered rotation error above which orientations are misread, degrees.
const TURNED_DEG: f64 = 20.0;

/// Doubts about the input, by the registered model's training errors.
pub(crate) fn doubts(
    data: &Dataset,
    rows: &[u32],
    registered: &ModelAccuracy,
    frame: DeviceFrameKnowledge,
) -> Vec<String> {
    let mut doubts = Vec::new();
    let spread_mm = data.spread_m(rows) * 1e3;
    let pixels = registered.of_pictures(rows.len());
    let (what, error_mm) = match pixels {
        Some(pixels) => (CORNERS, pixels.rms_mm),
        None => ("position error", registered.position_mm().rms),
    };
    if error_mm > MISFIT * spread_mm {
        let base = match frame {
            DeviceFrameKnowledge::Base => ", a device that does not stand at the base (--device-frame base)",
            DeviceFrameKnowledge::Unknown => "",
        };
        doubts.push(format!(
            "with nominal screws the {what} is {error_mm:.1} mm (RMS), {:.0} % of the measurements' spread: \
             check for a wrong unit, exchanged or misnamed joint columns, mirrored coordinates{base}, or another robot",
            100.0 * error_mm / spread_mm
        ));
    }
    let turned = registered.rotation_deg().filter(|it| pixels.is_none() && it.rms > TURNED_DEG);
    if let Some(rotation) = turned {
        doubts.push(format!(
            "with nominal screws the orientation error is {:.0} deg (RMS): check the quaternion's order (x, y, z, w), \
             inverted poses, or another Euler convention",
            rotation.rms
        ));
    }
    doubts
}
