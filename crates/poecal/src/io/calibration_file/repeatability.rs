//! Pose accuracy and repeatability in `calibration.json`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::calibration::{Calibration, RepeatedPose, repeatability};
use crate::measurement::Dataset;

/// Most poses in a file.
const LISTED: usize = 100;

/// Pose accuracy and repeatability of positions, after ISO 9283.
///
/// ```
/// use poecal::io::calibration_file::RepeatabilityEntry;
/// let text = r#"{ "poses": 0, "rows": 0, "accuracy_nominal_mm": 0, "accuracy_registered_mm": 0, "accuracy_calibrated_mm": 0,
///     "repeatability_mm": 0, "worst_repeatability_mm": 0, "listed": [] }"#;
/// let entry: RepeatabilityEntry = serde_json::from_str(text)?;
/// assert!(entry.listed.is_empty());
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RepeatabilityEntry {
    /// Number of targets in configurations with three rows or more.
    pub poses: usize,
    /// Number of their rows.
    pub rows: usize,
    /// Mean pose accuracy of the nominal model: distance from its prediction to the mean measured position, millimetres.
    pub accuracy_nominal_mm: f64,
    /// The same of the registered model.
    pub accuracy_registered_mm: f64,
    /// The same of the calibrated model.
    pub accuracy_calibrated_mm: f64,
    /// Mean repeatability: mean distance of measured positions from their mean, plus three standard deviations, millimetres.
    pub repeatability_mm: f64,
    /// The largest repeatability.
    pub worst_repeatability_mm: f64,
    /// The poses, those with most rows first, at most 100.
    pub listed: Vec<RepeatedPoseEntry>,
}

/// A configuration that was measured several times.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RepeatedPoseEntry {
    /// File of its first row.
    pub file: String,
    /// Line of its first row, from 1.
    pub row: u32,
    /// Number of its rows.
    pub rows: usize,
    /// Accuracy of the nominal model, millimetres.
    pub accuracy_nominal_mm: f64,
    /// Of the registered model.
    pub accuracy_registered_mm: f64,
    /// Of the calibrated model.
    pub accuracy_calibrated_mm: f64,
    /// Repeatability, millimetres.
    pub repeatability_mm: f64,
}

impl RepeatabilityEntry {
    /// Repeatability of a finished calibration; `None` if nothing was measured three times.
    pub(super) fn of(calibration: &Calibration, data: &Dataset) -> Option<Self> {
        let mut poses = repeatability(calibration, data);
        poses.sort_by_key(|pose| std::cmp::Reverse(pose.rows.len()));
        let count = poses.len();
        let mean_mm = |of: fn(&RepeatedPose) -> f64| 1e3 * poses.iter().map(of).sum::<f64>() / count as f64;
        (count > 0).then(|| RepeatabilityEntry {
            poses: count,
            rows: poses.iter().map(|pose| pose.rows.len()).sum(),
            accuracy_nominal_mm: mean_mm(|pose| pose.accuracy_m[0]),
            accuracy_registered_mm: mean_mm(|pose| pose.accuracy_m[1]),
            accuracy_calibrated_mm: mean_mm(|pose| pose.accuracy_m[2]),
            repeatability_mm: mean_mm(|pose| pose.repeatability_m),
            worst_repeatability_mm: 1e3 * poses.iter().map(|pose| pose.repeatability_m).fold(0.0, f64::max),
            listed: poses.iter().take(LISTED).map(|pose| RepeatedPoseEntry::of(pose, data)).collect(),
        })
    }
}

impl RepeatedPoseEntry {
    fn of(pose: &RepeatedPose, data: &Dataset) -> Self {
        let first = pose.rows.first().and_then(|&row| data.observations.get(row as usize));
        let source = first.map(|observation| observation.source).unwrap_or_default();
        let file = data.files.get(source.file as usize);
        let [nominal, registered, calibrated] = pose.accuracy_m.map(|accuracy| accuracy * 1e3);
        RepeatedPoseEntry {
            file: file.map_or_else(String::new, |path| path.display().to_string()),
            row: source.line,
            rows: pose.rows.len(),
            accuracy_nominal_mm: nominal,
            accuracy_registered_mm: registered,
            accuracy_calibrated_mm: calibrated,
            repeatability_mm: pose.repeatability_m * 1e3,
        }
    }
}
