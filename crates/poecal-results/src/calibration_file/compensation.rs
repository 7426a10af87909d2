//! What compensation mends, over the workspace, in `calibration.json`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use poecal_calibrate::{Calibration, Displacements, Spread, Workspace, workspace};
use poecal_model::robot::JointKind;

/// How far the actual robot's tip is from where the nominal one has it, over the sampled workspace; and the corrections of the joints that mend
/// it. Tool and base of the nominal robot are fitted to the actual one (the base only if the device's frame was unknown), over every third
/// configuration, as if both had been taught on it: what is displaced is displaced by the joints. The actual robot is the corrected model,
/// if there is one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CompensationEntry {
    /// Displacements in all configurations of the sample, which is spread evenly over the sampled range of each joint.
    #[serde(flatten)]
    pub all: DisplacementEntry,
    /// Configurations whose tip is displaced by no more than is expected of the calibration itself: there is nothing to mend.
    pub needless: usize,
    /// Configurations whose corrected readings are beyond a joint's limits.
    pub beyond_limits: usize,
    /// Configurations from which no small correction leads to the pose, since a singularity is near: another branch is, or none.
    pub unmended: usize,
    /// Corrections of each reading that moves the tip; none of an arm with fewer than six, which cannot mend every displacement.
    pub joints: Vec<ReadingChangeEntry>,
    /// Joint whose axis the map is about; null if that is the base's z axis.
    pub about: Option<String>,
    /// Side of the map's cells, metres.
    pub cell_m: f64,
    /// Parts of the workspace where the sample has configurations, by height and then by distance from the axis.
    pub cells: Vec<WorkspaceCellEntry>,
}

/// Displacements of the tip in some configurations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DisplacementEntry {
    /// Number of configurations.
    pub configurations: usize,
    /// Median distance, millimetres.
    pub median_mm: f64,
    /// Largest distance, millimetres.
    pub max_mm: f64,
    /// Median angle, degrees.
    pub median_deg: f64,
    /// Largest angle, degrees.
    pub max_deg: f64,
}

/// A part of the workspace: a ring about the axis, as wide and as high as a cell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WorkspaceCellEntry {
    /// Distance of the nominal tip from the axis, from, metres.
    pub radius_m: f64,
    /// Its height along the axis above the base's origin, from, metres.
    pub height_m: f64,
    /// The displacements.
    #[serde(flatten)]
    pub displaced: DisplacementEntry,
    /// Expected error of predicted positions in these configurations (root mean square, millimetres): what a corrected program is expected to
    /// miss by. Missing without an uncertainty, and in files of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_position_mm: Option<f64>,
}

/// By how much a reading is corrected.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReadingChangeEntry {
    /// The reading.
    pub reading: String,
    /// Median correction of one that turns, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub median_deg: Option<f64>,
    /// The largest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_deg: Option<f64>,
    /// Median correction of one that slides, millimetres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub median_mm: Option<f64>,
    /// The largest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_mm: Option<f64>,
}

impl DisplacementEntry {
    fn of(found: &Displacements) -> Self {
        DisplacementEntry {
            configurations: found.configurations,
            median_mm: 1e3 * found.position_m.median,
            max_mm: 1e3 * found.position_m.largest,
            median_deg: found.rotation_rad.median.to_degrees(),
            max_deg: found.rotation_rad.largest.to_degrees(),
        }
    }
}

impl ReadingChangeEntry {
    fn of((name, kind, spread): &(String, JointKind, Spread)) -> Self {
        let turns = *kind == JointKind::Revolute;
        let angle = |value: f64| turns.then(|| value.to_degrees());
        let length = |value: f64| (!turns).then_some(1e3 * value);
        ReadingChangeEntry {
            reading: name.clone(),
            median_deg: angle(spread.median),
            max_deg: angle(spread.largest),
            median_mm: length(spread.median),
            max_mm: length(spread.largest),
        }
    }
}

impl CompensationEntry {
    /// Of a calibration; none of one that is not to be used, and of a robot whose tip not every joint moves.
    pub(crate) fn of(calibration: &Calibration) -> Option<Self> {
        let found: Workspace = workspace(calibration)?;
        let cells = found.cells.iter().map(|it| WorkspaceCellEntry {
            radius_m: it.radius_m,
            height_m: it.height_m,
            displaced: DisplacementEntry::of(&it.displaced),
            sigma_position_mm: it.expected_m.map(|sigma| 1e3 * sigma),
        });
        Some(CompensationEntry {
            all: DisplacementEntry::of(&found.all),
            needless: found.needless,
            beyond_limits: found.beyond_limits,
            unmended: found.unmended,
            joints: found.joints.iter().map(ReadingChangeEntry::of).collect(),
            cells: cells.collect(),
            about: found.about,
            cell_m: found.cell_m,
        })
    }
}
