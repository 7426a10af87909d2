//! Effect of compensation over the workspace, in `calibration.json`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use poecal_calibrate::{Calibration, Displacements, ValueSpread, Workspace, workspace};
use poecal_model::robot::JointKind;
use poecal_numerics::unit::Unit;

/// Distance of the actual robot's tip from the nominal one over the sampled workspace, and the joint corrections that remove it. Tool and base of the
/// nominal robot are fitted to the actual one over every third configuration, as if both had been taught on it. The base is fitted only if the
/// device's frame was unknown. The remaining displacement is that of the joints. The actual robot is the corrected model, if there is one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CompensationEntry {
    /// Displacements in all configurations of the sample, which is spread evenly over the sampled range of each joint.
    #[serde(flatten)]
    pub all: DisplacementEntry,
    /// Number of configurations whose tip is displaced by no more than the expected error of the calibration: they need no correction.
    pub within_expected_error: usize,
    /// Number of configurations whose corrected readings are beyond a joint's limits.
    pub beyond_limits: usize,
    /// Number of configurations from which no small correction leads to the pose, near a singularity: only another branch reaches it, or none.
    pub not_correctable: usize,
    /// Corrections of each reading that moves the tip; empty for an arm with fewer than six, which cannot correct every displacement.
    pub joints: Vec<ReadingChangeEntry>,
    /// Joint whose axis the map is about; null if that is the base's z axis.
    pub about: Option<String>,
    /// Side of the map's cells, metres.
    pub cell_m: f64,
    /// Parts of the workspace that contain configurations of the sample, by height and then by distance from the axis.
    pub cells: Vec<WorkspaceCellEntry>,
}

/// Displacements of the tip in some configurations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DisplacementEntry {
    /// Number of configurations.
    pub configurations: usize,
    /// Distances, millimetres.
    pub position_mm: SpreadEntry,
    /// Angles, degrees.
    pub rotation_deg: SpreadEntry,
}

/// Median and largest of some sizes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpreadEntry {
    /// Median.
    pub median: f64,
    /// Largest.
    pub max: f64,
}

/// A part of the workspace: a ring about the axis, as wide and as high as a cell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WorkspaceCellEntry {
    /// Distance of the nominal tip from the axis, lower end, metres.
    pub radius_m: f64,
    /// Its height along the axis above the base's origin, lower end, metres.
    pub height_m: f64,
    /// The displacements.
    #[serde(flatten)]
    pub displaced: DisplacementEntry,
    /// Expected error of a corrected program in these configurations: of predicted positions, root mean square, millimetres. Missing without an
    /// uncertainty, and in files of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_position_mm: Option<f64>,
}

/// Correction of a reading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReadingChangeEntry {
    /// The reading.
    pub reading: String,
    /// Unit of the numbers: `deg`, or `mm` of a joint that slides.
    pub unit: String,
    /// Sizes of its corrections.
    #[serde(flatten)]
    pub change: SpreadEntry,
}

impl SpreadEntry {
    fn in_shown_unit(unit: Unit, found: &ValueSpread) -> Self {
        SpreadEntry { median: unit.in_shown_unit(found.median), max: unit.in_shown_unit(found.largest) }
    }
}

impl DisplacementEntry {
    fn from_displacements(found: &Displacements) -> Self {
        DisplacementEntry {
            configurations: found.configurations,
            position_mm: SpreadEntry::in_shown_unit(Unit::Metre, &found.position_m),
            rotation_deg: SpreadEntry::in_shown_unit(Unit::Radian, &found.rotation_rad),
        }
    }
}

impl ReadingChangeEntry {
    fn from_spread((name, kind, spread): &(String, JointKind, ValueSpread)) -> Self {
        let unit = if *kind == JointKind::Revolute { Unit::Radian } else { Unit::Metre };
        ReadingChangeEntry {
            reading: name.clone(),
            unit: unit.symbol().to_owned(),
            change: SpreadEntry::in_shown_unit(unit, spread),
        }
    }
}

impl CompensationEntry {
    /// Entry of a calibration; `None` if it is not to be used, or if some joint does not move the robot's tip.
    pub(crate) fn from_calibration(calibration: &Calibration) -> Option<Self> {
        let found: Workspace = workspace(calibration)?;
        let cells = found.cells.iter().map(|it| WorkspaceCellEntry {
            radius_m: it.radius_m,
            height_m: it.height_m,
            displaced: DisplacementEntry::from_displacements(&it.displaced),
            sigma_position_mm: it.expected_m.map(|sigma| 1e3 * sigma),
        });
        Some(CompensationEntry {
            all: DisplacementEntry::from_displacements(&found.all),
            within_expected_error: found.needless,
            beyond_limits: found.beyond_limits,
            not_correctable: found.unmended,
            joints: found.joints.iter().map(ReadingChangeEntry::from_spread).collect(),
            cells: cells.collect(),
            about: found.about,
            cell_m: found.cell_m,
        })
    }
}
