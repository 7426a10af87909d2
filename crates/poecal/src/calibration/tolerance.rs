//! Tolerances of the prior, chosen by cross-validation.

use super::{Calibration, CalibrationOptions};
use crate::error::Result;
use crate::robot::Tolerance;

/// What the usual tolerance may lose, of the mean logarithm of the errors of rows that are left out, and is taken still.
const USUAL: f64 = 0.01;

/// Tolerances that are tried: the usual one, of more and more precise robots, and of ones that are hardly like their drawing.
fn tried() -> [Tolerance; 5] {
    let of = |angle_deg: f64, length_m| Tolerance { angle_rad: angle_deg.to_radians(), length_m };
    [Tolerance::default(), of(0.2, 2e-3), of(0.05, 5e-4), of(1.0, 1e-2), of(3.0, 1e-2)]
}

/// The tolerance whose fit predicts rows best which are left out: random folds, ends of the joints' ranges, files, ids.
///
/// # Errors
/// Those of the fits.
pub(super) fn chosen(
    options: &CalibrationOptions,
    calibrate: impl Fn(&CalibrationOptions) -> Result<Calibration>,
) -> Result<Tolerance> {
    let mut best: Option<(f64, Tolerance)> = None;
    for tolerance in tried() {
        let options = CalibrationOptions {
            tolerance: Some(tolerance),
            chooses_tolerance: false,
            corrections: super::Corrections::Off,
            diagnose: false,
            accept: None,
            ..options.clone()
        };
        let found = calibrate(&options)?;
        // Too few rows for cross-validation choose nothing.
        let Some(validated) = found.trust.cross_validation else { return Ok(Tolerance::default()) };
        let errors = std::iter::once(&validated.random).chain(&validated.blocked).map(|it| it.rms.lead());
        let count = 1.0 + validated.blocked.len() as f64;
        let mean = errors.map(|it| it.max(f64::MIN_POSITIVE).ln()).sum::<f64>() / count;
        let bonus = if tolerance == Tolerance::default() { USUAL } else { 0.0 };
        if best.is_none_or(|(least, _)| mean - bonus < least) {
            best = Some((mean - bonus, tolerance));
        }
    }
    Ok(best.map_or_else(Tolerance::default, |(_, tolerance)| tolerance))
}
