//! Pose accuracy and repeatability in `calibration.json`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::in_file_units;
use poecal_calibrate::{Calibration, RepeatedPose, repeatability};
use poecal_model::measurement::{Dataset, MeasuredQuantities, Quantity};

/// Most poses in a file.
const LISTED: usize = 100;

/// Pose accuracy and repeatability of positions, after ISO 9283; for poses that were measured by other quantities those of the latter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RepeatabilityEntry {
    /// Number of targets in configurations with three rows or more.
    pub poses: usize,
    /// Number of their rows.
    pub rows: usize,
    /// Means over the poses.
    #[serde(flatten)]
    pub mean: PoseRepeatability,
    /// The largest repeatability.
    pub worst_repeatability: MeasuredQuantities<f64>,
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
    /// Its accuracy and repeatability.
    #[serde(flatten)]
    pub own: PoseRepeatability,
}

/// Accuracy and repeatability of the quantity by which a pose was measured, millimetres or degrees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PoseRepeatability {
    /// Distance from the prediction of each model to the mean measured position.
    pub accuracy: PoseAccuracy,
    /// Repeatability: mean distance of measured positions from their mean, plus three standard deviations.
    pub repeatability: MeasuredQuantities<f64>,
}

/// Accuracy of each model in a pose, millimetres or degrees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PoseAccuracy {
    /// Accuracy of the nominal model.
    pub nominal: MeasuredQuantities<f64>,
    /// Accuracy of the registered model.
    pub registered: MeasuredQuantities<f64>,
    /// Accuracy of the calibrated model.
    pub calibrated: MeasuredQuantities<f64>,
}

impl PoseRepeatability {
    /// Figures of a quantity with their keys.
    #[must_use]
    pub fn by_key(&self, quantity: Quantity) -> [(String, Option<f64>); 4] {
        let PoseAccuracy { nominal, registered, calibrated } = self.accuracy;
        [
            ("accuracy.nominal", nominal),
            ("accuracy.registered", registered),
            ("accuracy.calibrated", calibrated),
            ("repeatability", self.repeatability),
        ]
        .map(|(key, values)| (format!("{key}.{}", quantity.key()), values.get(quantity)))
    }
}

impl RepeatabilityEntry {
    /// Repeatability of a finished calibration; `None` if nothing was measured three times.
    pub(crate) fn from_calibration(calibration: &Calibration, data: &Dataset) -> Option<Self> {
        let mut poses = repeatability(calibration, data);
        poses.sort_by_key(|pose| std::cmp::Reverse(pose.rows.len()));
        let count = poses.len();
        let each = |quantity: Quantity, of: fn(&RepeatedPose) -> f64| -> Option<Vec<f64>> {
            let own = poses.iter().filter(|pose| pose.quantity == quantity);
            Some(own.map(of).collect()).filter(|numbers: &Vec<f64>| !numbers.is_empty())
        };
        let mean = |of: fn(&RepeatedPose) -> f64| {
            MeasuredQuantities::from_fn(|quantity| {
                let numbers = each(quantity, of)?;
                Some(quantity.unit().in_shown_unit(1.0) * numbers.iter().sum::<f64>() / numbers.len() as f64)
            })
        };
        let worst = |quantity| Some(each(quantity, |pose| pose.repeatability)?.into_iter().fold(0.0, f64::max));
        (count > 0).then(|| RepeatabilityEntry {
            poses: count,
            rows: poses.iter().map(|pose| pose.rows.len()).sum(),
            mean: PoseRepeatability {
                accuracy: PoseAccuracy {
                    nominal: mean(|pose| pose.accuracy[0]),
                    registered: mean(|pose| pose.accuracy[1]),
                    calibrated: mean(|pose| pose.accuracy[2]),
                },
                repeatability: mean(|pose| pose.repeatability),
            },
            worst_repeatability: in_file_units(worst),
            listed: poses.iter().take(LISTED).map(|pose| RepeatedPoseEntry::from_pose(pose, data)).collect(),
        })
    }
}

impl RepeatedPoseEntry {
    fn from_pose(pose: &RepeatedPose, data: &Dataset) -> Self {
        let first = pose.rows.first().and_then(|&row| data.observations.get(row as usize));
        let source = first.map(|observation| observation.source).unwrap_or_default();
        let file = data.files.get(source.file as usize);
        let own = |quantity: Quantity, number: f64| (quantity == pose.quantity).then_some(number);
        let [nominal, registered, calibrated] = pose.accuracy;
        RepeatedPoseEntry {
            file: file.map_or_else(String::new, |path| path.display().to_string()),
            row: source.line,
            rows: pose.rows.len(),
            own: PoseRepeatability {
                accuracy: PoseAccuracy {
                    nominal: in_file_units(|quantity| own(quantity, nominal)),
                    registered: in_file_units(|quantity| own(quantity, registered)),
                    calibrated: in_file_units(|quantity| own(quantity, calibrated)),
                },
                repeatability: in_file_units(|quantity| own(quantity, pose.repeatability)),
            },
        }
    }
}
