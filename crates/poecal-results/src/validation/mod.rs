//! `validation.json`: a calibration judged by other measurements, with its inputs; and the history of such checks.

mod history;
mod rows;

pub use history::{HISTORY, History, HistoryEntry, current_time};
pub use rows::JudgedRows;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::calibration_file::CalibrationFile;
use super::record::Record;
use poecal_calibrate::{
    AcceptanceLimits, AcceptedModel, Gain, JudgedError, Judgement, Level, PredictiveDistribution, RefittedPart,
};
use poecal_import::{InputEntry, JoinEntry};
use poecal_model::measurement::{Dataset, MeasuredQuantities, Quantity};
use poecal_numerics::error::Result;

/// Share of the error of a later state below which an earlier one fits better.
const FITS: f64 = 0.8;
/// Name of the schema.
const SCHEMA: &str = "poecal-validation-1";
/// Name of the schema of results of `poecal track`: its lines are in the same history.
pub const TRACK: &str = "poecal-track-1";

/// The judged calibration and the measurements that judge it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ValidationInputs {
    /// The calibration's file.
    pub calibration: String,
    /// Files of the measurements.
    pub measurements: Vec<String>,
    /// SHA-256 of each, by name.
    pub sha256: BTreeMap<String, String>,
    /// Kind of each file and its used rows.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<InputEntry>,
    /// Joins of files of joint readings with files of measurements.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub joins: Vec<JoinEntry>,
    /// The command, if the program made it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command: Option<String>,
}

/// Verdict of the measurements on the delivered model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ValidationVerdict {
    /// The best level that they confirm; `None` if the calibration has no bounds to test.
    pub level: Option<Level>,
    /// Reasons against a better level, a sentence each.
    #[serde(default)]
    pub reasons: Vec<String>,
    /// The delivered model.
    pub model: AcceptedModel,
    /// Comparison with the nominal model's predictions of these measurements; absent if they are too few.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain: Option<Gain>,
    /// Its errors.
    #[serde(flatten)]
    pub errors: MeasuredQuantities<VerdictError>,
}

/// Errors of a quantity, millimetres or degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct VerdictError {
    /// Root mean square.
    pub rms: f64,
    /// Largest.
    pub max: f64,
    /// Expected root mean square, measurement noise included.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub expected_rms: Option<f64>,
    /// Share of the errors within their own 95 % bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inside_bound95: Option<f64>,
}

/// A calibration judged by other measurements.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Validation {
    /// Name and version of this schema.
    pub schema: &'static str,
    /// Version that judged.
    pub poecal_version: &'static str,
    /// The robot's name.
    pub robot: String,
    /// The judged calibration and the measurements that judge it.
    pub inputs: ValidationInputs,
    /// Statements about this session, not about the calibration's.
    #[serde(skip_serializing_if = "Record::is_empty")]
    pub record: Record,
    /// Verdict of the measurements on the delivered model.
    pub verdict: ValidationVerdict,
    /// State of a repaired session by which the measurements were judged, from 1: targets and devices before the first move, or after it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stage: Option<usize>,
    /// Measurement files from which the calibration itself was made, by their content.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub fitted: Vec<String>,
    /// Contradiction of the calibration, as a sentence.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub doubt: Option<String>,
    /// The errors.
    #[serde(flatten)]
    pub judgement: Judgement,
}

/// Options of the judgement of a calibration.
#[derive(Clone, Copy, Debug, Default)]
pub struct ValidationOptions<'a> {
    /// Refit the device's frame.
    pub refit_frame: bool,
    /// Refit it if the measurements show that the device has moved.
    pub refit_moved: bool,
    /// Refit the targets.
    pub refit_tool: bool,
    /// Limits that the errors shall keep.
    pub accept: Option<&'a AcceptanceLimits>,
}

impl Validation {
    /// Judges a calibration by all rows of some measurements.
    ///
    /// # Errors
    /// As [`CalibrationFile::judge`] and [`CalibrationFile::accept`].
    pub fn from_measurements(
        file: &CalibrationFile,
        original: &Dataset,
        judging: &ValidationOptions<'_>,
        inputs: ValidationInputs,
    ) -> Result<Self> {
        let ValidationOptions { refit_frame, refit_moved, refit_tool, accept } = *judging;
        let judge = |data: &Dataset| {
            if refit_frame {
                file.judge(data, true, refit_tool)
            } else {
                file.judge_wherever(data, refit_tool, refit_moved)
            }
        };
        // For a repaired session, the state that fits best; the last one if several fit similarly.
        let stages = file.stages();
        let mut data = file.at_stage(original, stages);
        let mut judgement = judge(&data)?;
        let mut stage = stages;
        for earlier in (1..stages).rev() {
            let other = file.at_stage(original, earlier);
            let Ok(found) = judge(&other) else { continue };
            if found.delivered_model().errors.lead().rms < FITS * judgement.delivered_model().errors.lead().rms {
                (data, judgement, stage) = (other, found, earlier);
            }
        }
        let data = &*data;
        let refit_frame = judgement.refitted.contains(&RefittedPart::DeviceFrame);
        let accept = accept.map(|limits| file.accept(data, refit_frame, refit_tool, limits, &inputs.sha256));
        let acceptance = accept.transpose()?;
        let judged_at = (stages > 1).then_some(stage);
        let improvement = file.improvement(data, refit_frame, refit_tool)?;
        let found = Validation::new(file, Judgement { acceptance, improvement, ..judgement }, inputs);
        Ok(Validation { stage: judged_at, ..found })
    }

    /// Validation of a finished judgement.
    ///
    /// ```
    /// use poecal_calibrate::{CalibrationOptions, calibrate};
    /// use poecal_results::calibration_file::{CalibrationFile, Inputs};
    /// use poecal_results::validation::{Validation, ValidationInputs};
    /// use poecal_model::simulate::{SessionKind, Simulation, elbow};
    /// let made = Simulation { count: 60, ..Simulation::default() }.run(&elbow(), SessionKind::POINT)?;
    /// let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
    /// let file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
    /// let judgement = file.judge(&made.data, false, false)?;
    /// let validation = Validation::new(&file, judgement, ValidationInputs::default());
    /// assert_eq!(validation.verdict.level, Some(poecal_calibrate::Level::Good));
    /// # Ok::<(), poecal_numerics::error::Error>(())
    /// ```
    #[must_use]
    pub fn new(file: &CalibrationFile, judgement: Judgement, inputs: ValidationInputs) -> Self {
        let sum = |name: &String, of: &BTreeMap<String, String>| of.get(name).cloned();
        let own: Vec<String> =
            file.inputs.measurements.iter().filter_map(|name| sum(name, &file.inputs.sha256)).collect();
        let is_fitted = |name: &&String| sum(name, &inputs.sha256).is_some_and(|it| own.contains(&it));
        let fitted = inputs.measurements.iter().filter(is_fitted).cloned().collect();
        Validation {
            schema: SCHEMA,
            poecal_version: env!("CARGO_PKG_VERSION"),
            robot: file.robot.name.clone(),
            inputs,
            record: Record::default(),
            verdict: ValidationVerdict::from_judgement(&judgement),
            stage: None,
            fitted,
            doubt: file.doubt(&judgement),
            judgement,
        }
    }

    /// Sentences on weaknesses of the judgement, and on contradictions of the calibration.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let fitted = (!self.fitted.is_empty()).then(|| {
            format!(
                "{}: the calibration was made of this file, so it fits these rows better than new ones: validate with measurements that the \
                 calibration has not seen",
                self.fitted.join(", ")
            )
        });
        fitted.into_iter().chain(self.doubt.clone()).collect()
    }

    /// The text of `validation.json`.
    ///
    /// # Errors
    /// [`ErrorKind::Export`](poecal_numerics::error::ErrorKind::Export) if it cannot be written as JSON.
    pub fn to_text(&self) -> Result<String> {
        poecal_storage::json_text(self, "validation")
    }
}

impl ValidationVerdict {
    fn from_judgement(judgement: &Judgement) -> Self {
        let found = judgement.delivered_model();
        let (level, reasons) = judgement.confirmed_level();
        let errors = MeasuredQuantities::from_fn(|quantity: Quantity| {
            let own = found.errors.get(quantity)?;
            let part = found.promised.and_then(|it| it.parts.get(quantity));
            let (rms, max) = (own.rms, own.max);
            Some(VerdictError {
                rms,
                max,
                expected_rms: part.map(|it| it.expected_rms),
                inside_bound95: part.map(|it| it.inside_bound95),
            })
        });
        let gain = judgement.improvement.map(|it| it.gain());
        ValidationVerdict { level, reasons, model: found.model, gain, errors }
    }
}

/// A quantity's error, expectation and bound, millimetres or degrees.
fn in_file_units(quantity: Quantity, found: JudgedError) -> [Option<f64>; 3] {
    let shown = |value: f64| quantity.unit().in_shown_unit(value);
    let promised = |of: fn(&PredictiveDistribution) -> f64| found.promised.as_ref().map(|it| shown(of(it)));
    [Some(shown(found.length)), promised(|it| it.variance.sqrt()), promised(|it| it.bound)]
}
