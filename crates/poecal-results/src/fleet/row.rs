//! A line of the ledger: a robot's calibration in figures.

use serde::{Deserialize, Serialize};

use crate::calibration_file::CalibrationFile;
use poecal_calibrate::{AcceptedModel, Decision, Level};

/// Deviation of one joint from nominal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CorrectionRow {
    /// The joint.
    pub joint: String,
    /// Addition to its value, degrees, for a joint that slides millimetres; null where base or tool can take its place.
    pub offset: Option<f64>,
    /// Its standard deviation.
    pub sigma_offset: Option<f64>,
    /// Unit of both.
    pub unit: String,
    /// Tilt of its axis, degrees.
    pub tilt_deg: f64,
    /// Standard deviation of that.
    pub sigma_tilt_deg: Option<f64>,
    /// Shift of its axis, millimetres.
    pub shift_mm: f64,
    /// Standard deviation of that.
    pub sigma_shift_mm: Option<f64>,
    /// Angle between the axis and its nominal direction, degrees: the subject of a tolerance.
    #[serde(default)]
    pub axis_tilt_deg: f64,
    /// Distance of the axis from the nominal joint's origin, millimetres.
    #[serde(default)]
    pub axis_shift_mm: f64,
    /// Share of the measurements in the information on its direction, 0 to 1; the rest is the prior's. Null without a prior.
    #[serde(default)]
    pub tilt_from_data: Option<f64>,
    /// Share of the measurements in the information on its position, 0 to 1.
    #[serde(default)]
    pub shift_from_data: Option<f64>,
}

/// Effect of one group of terms at one joint: milliradians, of shift and runout millimetres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GroupEffect {
    /// The joint.
    pub joint: String,
    /// The group: sag, tilt, ratio, harmonics …
    pub group: String,
    /// Largest deviation in the fitted rows.
    pub amplitude: f64,
    /// Its standard deviation.
    pub sigma: f64,
    /// True if it is larger than chance and the prior explain.
    pub found: bool,
}

/// An input: the measurements, the model, settings.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct InputRow {
    /// Its path, from the folder of the station if the file is inside it.
    pub file: String,
    /// SHA-256 of its bytes.
    pub sha256: String,
}

/// The prior deviation of a group of terms, by which a robot was calibrated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SizeRow {
    /// The group.
    pub group: String,
    /// Radians, of shift and runout metres; 0 for a group that was left out.
    pub size: f64,
}

/// A line of the ledger.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LedgerRow {
    /// Name and version of the ledger.
    pub schema: String,
    /// Time of the calibration, UTC.
    pub time: String,
    /// Serial number of the robot.
    pub serial: String,
    /// Date of the measurement, as the inbox states it.
    pub date: String,
    /// Type of the robot; empty if there is only one.
    #[serde(rename = "type")]
    pub of_type: String,
    /// The measurements, from the folder of the station.
    pub file: String,
    /// The folder of the results, from that of the station.
    pub results: String,
    /// All inputs, by their paths.
    pub inputs: Vec<InputRow>,
    /// Version of the program.
    pub poecal_version: String,
    /// Outcome of the calibration: 0 good, 1 not to be used or a limit not kept, 2 refused, 3 no result.
    pub exit: u8,
    /// Reason for it, as a sentence; null for a good one.
    pub reason: Option<String>,
    /// The verdict: good, inside_sampled_range, do_not_use; null without a result.
    pub verdict: Option<String>,
    /// Decision on the requested limits: pass, fail, undecided; null if none were requested.
    pub accepted: Option<String>,
    /// Number of measurements.
    pub rows: Option<u64>,
    /// Error of the delivered model on the rows that judge it (RMS), millimetres or degrees.
    pub error_rms: Option<f64>,
    /// Set of these rows: held_out, cross_validation, or training.
    pub error_of: Option<String>,
    /// Noise of the measurements, millimetres or degrees for each component.
    pub noise: Option<f64>,
    /// Each joint's correction.
    pub corrections: Vec<CorrectionRow>,
    /// Effects of joints beyond geometry.
    pub terms: Vec<GroupEffect>,
    /// True if the line's estimate of its robots was the prior.
    #[serde(default)]
    pub by_prior: bool,
    /// Sizes of the terms; empty without terms.
    #[serde(default)]
    pub sizes: Vec<SizeRow>,
    /// Sentence if the measurements are of another robot of the line; empty if nothing shows that.
    #[serde(default, with = "sentence")]
    pub of_another: Option<String>,
}

/// Serialisation of an optional sentence as a text, empty if absent: tables have one type for it.
mod sentence {
    use serde::{Deserialize, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(text: &Option<String>, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(text.as_deref().unwrap_or_default())
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<String>, D::Error> {
        Ok(Some(String::deserialize(from)?).filter(|text| !text.is_empty()))
    }
}

/// A figure without insignificant digits.
fn format_figure(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}

fn word(value: impl Serialize) -> Option<String> {
    serde_json::to_value(value).ok()?.as_str().map(str::to_owned)
}

impl LedgerRow {
    /// The same row with the findings of a calibration.
    #[must_use]
    pub fn with_findings(self, file: &CalibrationFile) -> Self {
        let held = file.accuracy.held_out.as_ref();
        let set = held.unwrap_or(&file.accuracy.training);
        let is_corrected = set.corrected.is_some();
        let model = if is_corrected { AcceptedModel::Corrected } else { AcceptedModel::Calibrated };
        let (error_rms, error_of) = file.own_error(model);
        let length = |it: &[f64; 3]| it.iter().map(|part| part * part).sum::<f64>().sqrt();
        let correction = |entry: &crate::calibration_file::CorrectionEntry| {
            let change = entry.change.as_ref()?;
            let slides = change.shift_mm.is_none();
            Some(CorrectionRow {
                joint: entry.joint.clone(),
                offset: change.offset_deg.or(change.offset_mm).map(format_figure),
                sigma_offset: change.sigma_offset.map(format_figure),
                unit: if slides { "mm" } else { "deg" }.to_owned(),
                tilt_deg: format_figure(length(&change.tilt_deg)),
                sigma_tilt_deg: change.sigma_tilt_deg.map(format_figure),
                shift_mm: format_figure(change.shift_mm.as_ref().map_or(0.0, length)),
                sigma_shift_mm: change.sigma_shift_mm.map(format_figure),
                axis_tilt_deg: entry.axis.tilt_deg.map_or(0.0, format_figure),
                axis_shift_mm: entry.axis.shift_mm.map_or(0.0, format_figure),
                tilt_from_data: entry.tilt_from_data.map(format_figure),
                shift_from_data: entry.shift_from_data.map(format_figure),
            })
        };
        let effects = file.corrected.iter().flat_map(|it| &it.effects);
        let term = |it: &crate::calibration_file::EffectEntry| GroupEffect {
            joint: it.joint.clone(),
            group: it.group.clone(),
            amplitude: format_figure(it.amplitude),
            sigma: format_figure(it.sigma),
            found: it.found,
        };
        let mut terms: Vec<GroupEffect> = effects.map(term).collect();
        terms.sort_by(|a, b| (&a.joint, &a.group).cmp(&(&b.joint, &b.group)));
        let verdict = file.verdict.as_ref();
        let is_good = verdict.is_some_and(|it| it.level == Level::Good);
        let failed = file.acceptance.as_ref().filter(|it| it.decision != Decision::Pass);
        let reason = verdict.filter(|_| !is_good).and_then(|it| it.reasons.first().cloned());
        let limits = failed.map(|_| "a limit of `accept` is not shown to be kept".to_owned());
        let sizes = file.corrected.iter().flat_map(|it| &it.sizes);
        let size = |(group, size): (&String, &f64)| SizeRow { group: group.clone(), size: format_figure(*size) };
        let sigma = file.noise.sigma.iter().next().map(|(_, sigma)| sigma);
        LedgerRow {
            verdict: verdict.and_then(|it| word(it.level)),
            reason: limits.or(reason),
            accepted: file.acceptance.as_ref().and_then(|it| word(it.decision)),
            rows: Some(file.accuracy.training.count as u64 + held.map_or(0, |it| it.count as u64)),
            error_rms: Some(format_figure(error_rms)),
            error_of: Some(error_of.to_owned()),
            noise: sigma.map(format_figure),
            corrections: file.corrections.iter().filter_map(correction).collect(),
            terms,
            sizes: sizes.map(size).collect(),
            ..self
        }
    }

    /// True if a robot passed: a good calibration whose limits are kept.
    #[must_use]
    pub fn is_passed(&self) -> bool {
        self.exit == 0
    }

    /// Share of the prior in the information on its axes, 0 to 1; `None` without a prior.
    #[must_use]
    pub fn prior_share(&self) -> Option<f64> {
        let each = self.corrections.iter().flat_map(|it| [it.tilt_from_data, it.shift_from_data]).flatten();
        let (sum, count) = each.fold((0.0, 0.0), |(sum, count), it| (sum + 1.0 - it, count + 1.0));
        (count > 0.0).then_some(sum / count)
    }

    /// SHA-256 of one of its inputs.
    #[must_use]
    pub fn sha256(&self, file: &str) -> Option<&str> {
        self.inputs.iter().find(|it| it.file == file).map(|it| it.sha256.as_str())
    }
}
