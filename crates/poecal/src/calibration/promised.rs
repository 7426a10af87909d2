//! A promise compared with judging rows: all of them, and those inside the sampled range; where something was found anew from these rows,
//! what the screws leave.

use serde::Serialize;

use super::accuracy::{ModelAccuracy, model_accuracy};
use super::expectation::{Kept, Promise};
use crate::analysis::inside;
use crate::estimate::{Estimate, Packed, RowError};
use crate::measurement::{Dataset, Noise};
use crate::parameters::Parameter;
use crate::robot::Robot;
use crate::uncertainty::{Discrepancy, Refit, Uncertainty};

/// What a calibration of exact data leaves and promises: rounding.
pub(super) const ROUNDING: f64 = 1e-12;

/// The rows inside the range that was sampled for the calibration.
///
/// ```
/// use poecal::calibration::{InSampledRange, Kept, KeptPart, ModelAccuracy, Statistic};
/// let position_mm = Statistic { mean: 0.1, rms: 0.11, p95: 0.2, max: 0.25 };
/// let part = KeptPart { expected_rms: 0.1, inside_bound95: 0.95 };
/// let promised = Kept { position_mm: part, rotation_deg: None, inside_sampled_range: 1.0 };
/// let calibrated = ModelAccuracy { position_mm, rotation_deg: None };
/// assert!(InSampledRange { count: 20, calibrated, promised }.promised.least_inside() > 0.9);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InSampledRange {
    /// How many they are.
    pub count: usize,
    /// Their errors.
    pub calibrated: ModelAccuracy,
    /// Whether these are what was promised.
    pub promised: Kept,
}

/// The judging rows as a robot predicts them.
pub(super) struct Seen {
    pub(super) packed: Packed,
    pub(super) estimate: Estimate,
    pub(super) errors: Vec<RowError>,
    /// The unknowns that were found anew.
    pub(super) free: Vec<Parameter>,
}

/// Whether the promise is kept by all rows, and by those inside the sampled range, if there are any. Nothing, if what was found anew is not
/// determined by the rows.
pub(super) fn promised(
    promise: &Promise<'_>,
    robot: &Robot,
    refit_tool: bool,
    data: &Dataset,
    seen: &Seen,
) -> Option<(Kept, Option<InSampledRange>)> {
    let refitted = if seen.free.is_empty() { None } else { Some(refitted(promise, refit_tool, data, seen)?) };
    let own: Vec<usize> = (0..data.targets.len()).collect();
    let promise = match &refitted {
        Some(uncertainty) => Promise { uncertainty, targets: &own, ..*promise },
        None => *promise,
    };
    let all = promise.kept(robot, data, &seen.packed, &seen.errors);
    let mut rows = data.all_rows();
    rows.retain(|&row| inside(robot, promise.coverage, data.readings(row as usize)));
    if rows.is_empty() {
        return Some((all, None));
    }
    let errors: Vec<_> = rows.iter().map(|&row| seen.errors[row as usize]).collect();
    let promised = promise.kept_in(robot, data, &seen.packed, &rows, &errors);
    let calibrated = model_accuracy(&errors);
    Some((all, Some(InSampledRange { count: rows.len(), calibrated, promised })))
}

/// The uncertainty of what the rows can still show after device frame or targets were found anew from them.
fn refitted(promise: &Promise<'_>, refit_tool: bool, data: &Dataset, seen: &Seen) -> Option<Uncertainty> {
    let number = |target: usize| promise.targets.get(target).copied().filter(|_| !refit_tool);
    let targets: Vec<Option<usize>> = (0..data.targets.len()).map(number).collect();
    promise.uncertainty.refitted(&Refit {
        data,
        packed: &seen.packed,
        found: &seen.estimate,
        free: &seen.free,
        scatter: scatter(promise),
        targets: &targets,
    })
}

/// What a row scatters by that states no noise: the noise of measuring, and what no model describes.
fn scatter(promise: &Promise<'_>) -> Noise {
    let Discrepancy { standard_deviation, noise, .. } = promise.uncertainty.discrepancy;
    let both = |robot: f64, instrument: f64| robot.hypot(instrument).max(ROUNDING);
    Noise {
        position_m: both(standard_deviation.position_m, noise.position_m),
        rotation_rad: both(standard_deviation.rotation_rad, noise.rotation_rad),
    }
}
