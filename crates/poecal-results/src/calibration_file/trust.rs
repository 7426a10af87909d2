//! Verdict, coverage, cross-validation and uncertainty in `calibration.json`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{CorrelationsEntry, JointChangeEntry, PoseEntry, in_file_units};
use poecal_calibrate::{CoverageCheck, ExpectedPositionErrors, JointCorrection, QuantityCoverage, RangePart, Trust};
use poecal_fit::analysis::JointCoverage;
use poecal_fit::uncertainty::{Attribution, Bootstrap, FoldErrors};
use poecal_model::measurement::{MeasuredQuantities, Quantity};
use poecal_model::robot::Robot;

/// Errors of the rows of a fold or block, predicted by a fit of the others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LeftOutEntry {
    /// Name of the block.
    pub left_out: String,
    /// Number of rows.
    pub rows: usize,
    /// Root mean square error of each measured quantity, millimetres or degrees.
    pub rms: MeasuredQuantities<f64>,
}

/// Cross-validation on the fitted rows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CrossValidationEntry {
    /// Random folds, all together.
    pub random: LeftOutEntry,
    /// Errors of the rows with a joint beyond the range of the rows that predicted them, by more than a tenth of it. Absent if there are none.
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
    /// Root mean square distance by the covariance, for white noise, millimetres.
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
pub type HeldOutEntry = MeasuredQuantities<KeptEntry>;

pub(crate) fn held_out(kept: &CoverageCheck) -> HeldOutEntry {
    let entry =
        |part: QuantityCoverage| KeptEntry { expected_rms: part.expected_rms, inside_bound95: part.inside_bound95 };
    MeasuredQuantities::from_fn(|quantity| kept.parts.get(quantity).map(entry))
}

/// A part of a joint's range with the expected error there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RangeEntry {
    /// The joint.
    pub joint: String,
    /// Lower end, radians or metres.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// Root mean square distance, millimetres, with the other joints anywhere in their ranges.
    pub sigma_position_mm: f64,
}

/// Tilt and shift of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AxisEntry {
    /// Tilt of its direction, degrees.
    pub tilt_deg: Option<f64>,
    /// Shift of its position, millimetres; null for a joint that slides.
    pub shift_mm: Option<f64>,
}

impl AxisEntry {
    fn from_si(tilt_rad: Option<f64>, shift_m: Option<f64>) -> Self {
        AxisEntry { tilt_deg: tilt_rad.map(f64::to_degrees), shift_mm: shift_m.map(|it| 1e3 * it) }
    }
}

/// A joint's correction, its uncertainty, and its effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CorrectionEntry {
    /// The joint.
    pub joint: String,
    /// Difference of the axis from the nominal one, offsets of earlier joints included, unlike `change`: of its direction, and of its distance from
    /// the nominal joint's origin.
    pub axis: AxisEntry,
    /// Standard deviations of `axis` (root mean square); null where it is not determined.
    pub sigma: AxisEntry,
    /// `sigma` if the axes of all other joints were known; absent where the axis was held.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_alone: Option<AxisEntry>,
    /// Share of the measurements in the information on the direction, from 0 to 1; the rest is the tolerance's. Absent without a tolerance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tilt_from_data: Option<f64>,
    /// Share of the measurements in the information on the axis' position; absent for a joint that slides.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shift_from_data: Option<f64>,
    /// Root mean square position error with this screw alone nominal, millimetres.
    pub left_nominal_rms_mm: f64,
    /// The correction in parts, with directions; missing in older files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub change: Option<JointChangeEntry>,
    /// Reason for suspicion of the joint: a correction beyond those of the others, or residuals that follow its position.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub suspicious: Option<String>,
}

/// Covariance of the unknowns, and expected errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UncertaintyEntry {
    /// Factor of the covariance over that of independent residuals.
    pub inflation: f64,
    /// Factor outside the sampled range; absent if no larger.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extrapolation: Option<f64>,
    /// Model error: standard deviation of each component, millimetres or degrees; of positions, rotations and other measured quantities.
    #[serde(rename = "model_error")]
    pub discrepancy: MeasuredQuantities<f64>,
    /// Measurement noise in the residuals: standard deviation of each component, millimetres or degrees.
    pub noise: MeasuredQuantities<f64>,
    /// Attribution of the residuals of each quantity to the robot or to the instrument.
    #[schemars(with = "BTreeMap<String, Attribution>")]
    pub residuals: BTreeMap<Quantity, Attribution>,
    /// Degrees of freedom of the variance of each quantity's residuals; absent where their noise is stated.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty", rename = "degrees_of_freedom")]
    #[schemars(with = "BTreeMap<String, f64>")]
    pub freedom: BTreeMap<Quantity, f64>,
    /// Correlation of residuals of consecutive rows; null if not significant.
    #[serde(default)]
    pub lag_one_correlation: Option<f64>,
    /// Expected errors in the measured configurations.
    pub measured: ExpectedEntry,
    /// Expected errors anywhere within the limits.
    pub range: ExpectedEntry,
    /// Errors of held-out rows compared with their predicted uncertainty; null without such rows.
    #[serde(default)]
    pub held_out: Option<HeldOutEntry>,
    /// Bootstrap at measured configurations; null with too few rows.
    #[serde(default)]
    pub bootstrap: Option<BootstrapEntry>,
    /// Expected errors by parts of each joint's range.
    pub parts: Vec<RangeEntry>,
    /// Metres that one radian equals in the covariance.
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
    /// Covariance outside the sampled range; absent if no larger.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub covariance_outside_m2: Option<Vec<f64>>,
}

/// Values of the quantities that have one.
pub(crate) fn by_quantity<T>(value: &dyn Fn(Quantity) -> Option<T>) -> BTreeMap<Quantity, T> {
    Quantity::ALL.into_iter().filter_map(|it| Some((it, value(it)?))).collect()
}

impl LeftOutEntry {
    fn from_left_out(found: &FoldErrors) -> Self {
        LeftOutEntry {
            left_out: found.name.clone(),
            rows: found.rows,
            rms: in_file_units(|quantity| found.rms.get(quantity)),
        }
    }
}

impl CrossValidationEntry {
    pub(crate) fn from_trust(trust: &Trust) -> Option<Self> {
        let found = trust.cross_validation.as_ref()?;
        Some(CrossValidationEntry {
            random: LeftOutEntry::from_left_out(&found.random),
            outside: found.outside.as_ref().map(|it| LeftOutEntry {
                left_out: "beyond the range of the others".to_owned(),
                rows: it.rows,
                rms: in_file_units(|quantity| it.rms.get(quantity)),
            }),
            blocked: found.blocked.iter().map(LeftOutEntry::from_left_out).collect(),
        })
    }
}

impl ExpectedEntry {
    pub(crate) fn from_expected(expected: &ExpectedPositionErrors) -> Self {
        ExpectedEntry {
            sigma_position_mm: expected.sigma_m * 1e3,
            bound95_position_mm: expected.bound_m * 1e3,
            worst_bound95_position_mm: expected.worst_bound_m * 1e3,
        }
    }
}

impl RangeEntry {
    pub(crate) fn from_range(robot: &Robot, part: &RangePart) -> Self {
        RangeEntry {
            joint: robot.joints[part.joint].name.clone(),
            from: part.range[0],
            to: part.range[1],
            sigma_position_mm: part.sigma_m * 1e3,
        }
    }
}

impl BootstrapEntry {
    pub(crate) fn from_bootstrap(found: &Bootstrap) -> Self {
        BootstrapEntry {
            drawings: found.drawings,
            sigma_position_mm: found.sigma_m * 1e3,
            formal_sigma_position_mm: found.formal_sigma_m * 1e3,
        }
    }
}

impl CorrectionEntry {
    /// Entries of all joints.
    pub(crate) fn of_all(trust: &Trust) -> Vec<Self> {
        trust.coverage.iter().zip(&trust.joints).map(Self::from_correction).collect()
    }

    fn from_correction((coverage, found): (&JointCoverage, &JointCorrection)) -> Self {
        CorrectionEntry {
            joint: coverage.joint.clone(),
            axis: AxisEntry::from_si(Some(found.tilt_rad), Some(found.shift_m)),
            sigma: AxisEntry::from_si(found.sigma_tilt_rad, found.sigma_shift_m),
            sigma_alone: found
                .held
                .map(|(tilt, shift)| AxisEntry::from_si(Some(tilt), Some(shift).filter(|it| *it > 0.0))),
            tilt_from_data: found.tilt_from_data,
            shift_from_data: found.shift_from_data,
            left_nominal_rms_mm: found.left_nominal_rms_m * 1e3,
            change: Some(JointChangeEntry::from(&found.change)),
            suspicious: found.suspicious.clone(),
        }
    }
}
