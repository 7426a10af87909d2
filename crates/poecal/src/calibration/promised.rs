//! A promise compared with judging rows: all of them, and those inside the sampled range; where something was found anew from these rows,
//! what the screws leave.

use serde::Serialize;

use super::accuracy::{ModelAccuracy, model_accuracy};
use super::expectation::{Kept, KeptPart, Promise};
use super::judge::{Judgement, Seen, Subject};
use super::trust::inside;
use super::verdict::Level;
use crate::measurement::{Dataset, Noise};
use crate::uncertainty::{Discrepancy, Refit, Uncertainty};

/// What a calibration of exact data leaves and promises: rounding.
const ROUNDING: f64 = 1e-12;
/// Share of the errors inside their 95 % bounds that a promise asks for at least.
const INSIDE: f64 = 0.8;
/// Most times the expected error that the error may be.
const TIMES: f64 = 2.0;

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

/// Whether the promise is kept by all rows, and by those inside the sampled range, if there are any. Nothing, if what was found anew is not
/// determined by the rows.
pub(super) fn promised(
    promise: &Promise<'_>,
    subject: &Subject<'_>,
    data: &Dataset,
    seen: &Seen,
) -> Option<(Kept, Option<InSampledRange>)> {
    let refitted = if seen.free.is_empty() { None } else { Some(refitted(promise, subject, data, seen)?) };
    let own: Vec<usize> = (0..data.targets.len()).collect();
    let promise = match &refitted {
        Some(uncertainty) => Promise { uncertainty, targets: &own, ..*promise },
        None => *promise,
    };
    let robot = subject.calibrated;
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
fn refitted(
    promise: &Promise<'_>,
    subject: &Subject<'_>,
    data: &Dataset,
    seen: &Seen,
) -> Option<Uncertainty> {
    let number = |target: usize| promise.targets.get(target).copied().filter(|_| !subject.refit_tool);
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

impl Judgement {
    /// Why the measurements do not show the calibration to be as good as this; none if they do. *Good* is a promise kept by all rows,
    /// *inside the sampled range* one kept by those inside it: at least 80 % of the errors inside their 95 % bounds, and the error (RMS) at most
    /// twice the expected one.
    #[must_use]
    pub fn falls_short(&self, required: Level) -> Option<String> {
        let (which, found) = match required {
            Level::DoNotUse => return None,
            Level::InsideSampledRange => {
                let some = self.in_sampled_range.as_ref();
                ("inside the sampled range", some.map(|some| (&some.calibrated, &some.promised)))
            }
            Level::Good => ("of these rows", self.promised.as_ref().map(|kept| (&self.calibrated, kept))),
        };
        let Some((errors, kept)) = found else {
            return Some(match self.promised {
                None => "the calibration promises nothing that these rows could keep".to_owned(),
                Some(_) => "no row lies inside the sampled range".to_owned(),
            });
        };
        let rotation = kept
            .rotation_deg
            .zip(errors.rotation_deg)
            .map(|(part, found)| ("rotation", part, found.rms, "deg"));
        let position = ("position", kept.position_mm, errors.position_mm.rms, "mm");
        std::iter::once(position).chain(rotation).find_map(|(what, part, rms, unit)| {
            let KeptPart { expected_rms, inside_bound95 } = part;
            // Of exact data nothing but rounding is left.
            if rms <= ROUNDING * 1e6 {
                None
            } else if inside_bound95 < INSIDE {
                Some(format!(
                    "{:.0} % of the {what} errors {which} are inside their 95 % bounds, {:.0} % are asked for",
                    100.0 * inside_bound95,
                    100.0 * INSIDE
                ))
            } else if rms > TIMES * expected_rms {
                Some(format!(
                    "the {what} error {which} is {rms:.3} {unit} (RMS), more than twice the expected {expected_rms:.3} {unit}"
                ))
            } else {
                None
            }
        })
    }
}
