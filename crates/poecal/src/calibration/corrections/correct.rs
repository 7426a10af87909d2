//! The corrected model of a finished calibration.

use super::fit::fit;
use super::found::Correction;
use super::geometry::Geometry;
use crate::calibration::{Calibration, CalibrationOptions};
use crate::measurement::Dataset;
use crate::robot::{GravityDirection, Sizes};

/// Fits screws and terms together, from a finished calibration (theory.md §6, *Corrections*): with these sizes, or with those that
/// cross-validation chooses.
#[must_use]
pub fn correct(
    calibration: &Calibration,
    data: &Dataset,
    gravity: GravityDirection,
    sizes: Option<Sizes>,
    options: &CalibrationOptions,
) -> Correction {
    let packed = calibration.packed(data);
    let geometry = Geometry {
        session: calibration.session(data, &packed).with_noise_ratios(&calibration.noise_ratios),
        options,
        estimate: &calibration.models.calibrated,
        noise: calibration.noise,
        noise_source: calibration.noise_source,
        loss: calibration.robustness.loss,
        judged: &calibration.robustness.rows,
        fit_rows: &calibration.fit_rows,
        held_out_rows: &calibration.held_out_rows,
    };
    fit(&geometry, gravity, sizes).judged(&geometry, calibration.trust.cross_validation.as_ref())
}
