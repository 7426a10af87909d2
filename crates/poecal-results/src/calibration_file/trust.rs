//! Verdict, coverage, cross-validation and uncertainty in `calibration.json`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::keyed::{AttributionKeys, DiscrepancyKeys, FreedomKeys, Keyed, NoiseKeys, RmsKeys, shown};
use super::{CorrelationsEntry, JointChangeEntry, PoseEntry};
use poecal_calibrate::{CoverageCheck, Expected, JointCorrection, PartCoverage, RangePart, Trust};
use poecal_fit::analysis::JointCoverage;
use poecal_fit::uncertainty::{Attribution, Bootstrap, LeftOut};
use poecal_model::measurement::Measured;
use poecal_model::robot::Robot;

/// Errors of the rows of a fold or block, predicted by a fit of the others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LeftOutEntry {
    /// Name of the block.
    pub left_out: String,
    /// Number of rows.
    pub rows: usize,
    /// Root mean square error of each measured quantity, millimetres or degrees.
    #[serde(flatten)]
    pub rms: Keyed<RmsKeys>,
}

/// Cross-validation on the fitted rows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CrossValidationEntry {
    /// Random folds, all together.
    pub random: LeftOutEntry,
    /// Those of their rows with a joint beyond the range of the rows by which they were predicted, by more than a tenth of it. Absent if there
    /// are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outside: Option<LeftOutEntry>,
    /// The ends of each joint's range, files, and groups of equal `id`, each predicted by a fit without it.
    pub blocked: Vec<LeftOutEntry>,
}

/// Expected errors of predicted positions, millimetres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExpectedEntry {
    /// Root mean square distance.
    pub sigma_position_mm: f64,
    /// Mean of the 95 % bounds.
    pub bound95_position_mm: f64,
    /// The largest of these.
    pub worst_bound95_position_mm: f64,
}

/// Spread of predictions at measured configurations over bootstrap samples of the rows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BootstrapEntry {
    /// Number of samples: neighbourhoods of rows, with replacement.
    pub drawings: usize,
    /// Root mean square distance over these samples, millimetres.
    pub sigma_position_mm: f64,
    /// The same by the covariance, for white noise, millimetres.
    pub formal_sigma_position_mm: f64,
}

/// Errors of held-out positions or rotations compared with their predicted uncertainty.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct KeptEntry {
    /// Expected root mean square error between measured and predicted, millimetres or degrees.
    pub expected_rms: f64,
    /// Share of the errors within their own 95 % bound, 0 to 1.
    pub inside_bound95: f64,
}

/// Errors of held-out rows compared with their predicted uncertainty: of each quantity that was measured, millimetres or degrees.
pub type HeldOutEntry = Measured<KeptEntry>;

pub(crate) fn held_out(kept: &CoverageCheck) -> HeldOutEntry {
    let entry = |part: PartCoverage| KeptEntry {
        expected_rms: part.expected_rms,
        inside_bound95: part.inside_bound95,
    };
    Measured::of(|quantity| kept.parts.get(quantity).map(entry))
}

/// A part of a joint's range with the expected error there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RangeEntry {
    /// The joint.
    pub joint: String,
    /// From, radians or metres.
    pub from: f64,
    /// To.
    pub to: f64,
    /// Root mean square distance, millimetres, with the other joints anywhere in their ranges.
    pub sigma_position_mm: f64,
}

/// A joint's correction, its uncertainty, and its effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CorrectionEntry {
    /// The joint.
    pub joint: String,
    /// Angle between the axis and its nominal direction, degrees: offsets of earlier joints included, unlike the tilt in `change`.
    #[serde(alias = "tilt_deg")]
    pub axis_tilt_deg: f64,
    /// Distance of the axis from the nominal joint's origin, millimetres: offsets of earlier joints included, unlike the shift in `change`.
    #[serde(alias = "shift_mm")]
    pub axis_shift_mm: f64,
    /// Standard deviation of `axis_tilt_deg` (root mean square); null where it is not determined.
    #[serde(alias = "sigma_tilt_deg")]
    pub sigma_axis_tilt_deg: Option<f64>,
    /// Standard deviation of `axis_shift_mm`; null where it is not determined.
    #[serde(alias = "sigma_shift_mm")]
    pub sigma_axis_shift_mm: Option<f64>,
    /// `sigma_axis_tilt_deg` if the axes of all other joints were known; missing in older files, and where the axis was held.
    #[serde(default, skip_serializing_if = "Option::is_none", alias = "sigma_tilt_held_deg")]
    pub sigma_axis_tilt_held_deg: Option<f64>,
    /// The same of `sigma_axis_shift_mm`; missing of a joint that slides.
    #[serde(default, skip_serializing_if = "Option::is_none", alias = "sigma_shift_held_mm")]
    pub sigma_axis_shift_held_mm: Option<f64>,
    /// The measurements' share in what is known of the direction, from 0 to 1; the rest is the tolerance's. Absent without a tolerance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tilt_from_data: Option<f64>,
    /// The same of the axis' place; absent of a joint that slides.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shift_from_data: Option<f64>,
    /// Root mean square position error with this screw alone nominal, millimetres.
    pub left_nominal_rms_mm: f64,
    /// The correction in parts, with directions; missing in older files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub change: Option<JointChangeEntry>,
    /// Why the joint is suspicious: a correction beyond those of the others, or residuals that follow its position.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub suspicious: Option<String>,
}

/// Covariance of the unknowns, and expected errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UncertaintyEntry {
    /// Factor of the covariance over that of independent residuals.
    pub inflation: f64,
    /// The same outside the sampled range; absent if no larger.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extrapolation: Option<f64>,
    /// Model error: standard deviation of each component, millimetres or degrees; of positions, rotations and what else was measured.
    #[serde(flatten)]
    pub discrepancy: Keyed<DiscrepancyKeys>,
    /// Measurement noise in the residuals: standard deviation of each component, millimetres or degrees.
    #[serde(flatten)]
    pub noise: Keyed<NoiseKeys>,
    /// Whether the residuals count as the robot's or the instrument's.
    #[serde(flatten)]
    pub residuals: Keyed<AttributionKeys, Attribution>,
    /// Degrees of freedom of the residuals' variance; none where their noise is stated.
    #[serde(flatten)]
    pub freedom: Keyed<FreedomKeys>,
    /// Correlation of residuals of consecutive rows; null if not significant.
    #[serde(default)]
    pub lag_one_correlation: Option<f64>,
    /// In the measured configurations.
    pub measured: ExpectedEntry,
    /// Anywhere within the limits.
    pub range: ExpectedEntry,
    /// Errors of held-out rows compared with their predicted uncertainty; null without such rows.
    #[serde(default)]
    pub held_out: Option<HeldOutEntry>,
    /// Bootstrap at measured configurations; null with too few rows.
    #[serde(default)]
    pub bootstrap: Option<BootstrapEntry>,
    /// By parts of each joint's range.
    pub parts: Vec<RangeEntry>,
    /// Metres that a radian counts in the covariance.
    pub length_m: f64,
    /// Frames `base_from_axis` at zero, z along the joint, of each joint's unknowns: shifts along x and y and turns about x and y of a
    /// revolute joint, turns about x and y of a prismatic one.
    pub axes: Vec<PoseEntry>,
    /// Targets with unknowns, `true` for frames: shifts along their axes, and for frames turns about them. One that is the tip has an empty name.
    pub targets: Vec<(String, bool)>,
    /// Names of the unknowns, in the order of the covariance; missing in older files.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unknowns: Vec<String>,
    /// Point of the device frame about which its unknowns turn, metres, where the frame is among them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame_about_m: Option<[f64; 3]>,
    /// Correlations of the unknowns, by blocks; missing in older files and of the corrected model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub correlations: Option<CorrelationsEntry>,
    /// Covariance of the unknowns, square metres, turns multiplied by `length_m`: the upper triangle by rows, in the order of the fit with
    /// pure translations first.
    pub covariance_m2: Vec<f64>,
    /// The same outside the sampled range; absent if no larger.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub covariance_outside_m2: Option<Vec<f64>>,
}

impl LeftOutEntry {
    fn of(found: &LeftOut) -> Self {
        LeftOutEntry {
            left_out: found.name.clone(),
            rows: found.rows,
            rms: shown(|quantity| found.rms.get(quantity)),
        }
    }
}

impl CrossValidationEntry {
    pub(crate) fn of(trust: &Trust) -> Option<Self> {
        let found = trust.cross_validation.as_ref()?;
        Some(CrossValidationEntry {
            random: LeftOutEntry::of(&found.random),
            outside: found.outside.as_ref().map(|it| LeftOutEntry {
                left_out: "beyond the range of the others".to_owned(),
                rows: it.rows,
                rms: shown(|quantity| it.rms.get(quantity)),
            }),
            blocked: found.blocked.iter().map(LeftOutEntry::of).collect(),
        })
    }
}

impl ExpectedEntry {
    pub(crate) fn of(expected: &Expected) -> Self {
        ExpectedEntry {
            sigma_position_mm: expected.sigma_m * 1e3,
            bound95_position_mm: expected.bound_m * 1e3,
            worst_bound95_position_mm: expected.worst_bound_m * 1e3,
        }
    }
}

impl RangeEntry {
    pub(crate) fn of(robot: &Robot, part: &RangePart) -> Self {
        RangeEntry {
            joint: robot.joints[part.joint].name.clone(),
            from: part.range[0],
            to: part.range[1],
            sigma_position_mm: part.sigma_m * 1e3,
        }
    }
}

impl BootstrapEntry {
    pub(crate) fn of(found: &Bootstrap) -> Self {
        BootstrapEntry {
            drawings: found.drawings,
            sigma_position_mm: found.sigma_m * 1e3,
            formal_sigma_position_mm: found.formal_sigma_m * 1e3,
        }
    }
}

impl CorrectionEntry {
    /// Those of all joints.
    pub(crate) fn of_all(trust: &Trust) -> Vec<Self> {
        trust.coverage.iter().zip(&trust.joints).map(Self::of).collect()
    }

    fn of((coverage, found): (&JointCoverage, &JointCorrection)) -> Self {
        CorrectionEntry {
            joint: coverage.joint.clone(),
            axis_tilt_deg: found.tilt_rad.to_degrees(),
            axis_shift_mm: found.shift_m * 1e3,
            sigma_axis_tilt_deg: found.sigma_tilt_rad.map(f64::to_degrees),
            sigma_axis_shift_mm: found.sigma_shift_m.map(|sigma| sigma * 1e3),
            sigma_axis_tilt_held_deg: found.held.map(|(tilt, _)| tilt.to_degrees()),
            sigma_axis_shift_held_mm: found
                .held
                .filter(|(_, shift)| *shift > 0.0)
                .map(|(_, shift)| 1e3 * shift),
            tilt_from_data: found.tilt_from_data,
            shift_from_data: found.shift_from_data,
            left_nominal_rms_mm: found.left_nominal_rms_m * 1e3,
            change: Some(JointChangeEntry::from(&found.change)),
            suspicious: found.suspicious.clone(),
        }
    }
}
