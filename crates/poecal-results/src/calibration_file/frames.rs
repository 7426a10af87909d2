//! The keys of robots, joints, stations and poses in `calibration.json`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bodies::{BodyEntry, MassEntry, MeasuredEntry, TermName};
use super::corrected_model::GravityEntry;
use super::measured_noise;
use poecal_calibrate::{CalibratedStation, DeviceFrameKnowledge, ModelAccuracy};
use poecal_model::measurement::{MeasuredQuantities, Noise};
use poecal_model::robot::{FactorReading, JointKind, Reading, Robot, Term};

/// The calibrated robot's frames.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RobotEntry {
    /// Name.
    pub name: String,
    /// Name of the base frame.
    pub base_link: String,
    /// Name of the tip frame.
    pub tip_link: String,
    /// Pose of the tip in the base with all joint values zero.
    pub base_from_tip_at_zero: PoseEntry,
    /// Pose of the tip in the base with all joint values zero, by the nominal model.
    pub nominal_base_from_tip_at_zero: PoseEntry,
    /// Body of the tip, if it is not the last joint's link.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tip_on: Option<BodyEntry>,
    /// Weights that the robot carries, if its joints sag.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity: Option<GravityEntry>,
    /// Masses of the model's links; the term `masses` is of all of them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub masses: Vec<MassEntry>,
    /// Other values that are read in each configuration and that terms depend on; the term `factor1` is of the first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub factors: Vec<FactorReading>,
}

/// A calibrated joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct JointEntry {
    /// Name.
    pub name: String,
    /// Kind.
    pub kind: JointKind,
    /// Calibrated screw in the base frame at zero.
    pub screw: ScrewEntry,
    /// Screw of the nominal model.
    pub nominal_screw: ScrewEntry,
    /// Calibrated frame of the joint and of the link that it moves, at zero.
    pub base_from_joint: PoseEntry,
    /// Lower and upper limit, radians or metres.
    pub limits: Option<[f64; 2]>,
    /// The joint's value as a function of a reading.
    pub reading: Reading,
    /// Body that carries the joint, if that is not the link of the joint before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub on: Option<BodyEntry>,
    /// The joint whose compliance this joint is. It turns by its terms alone, whose functions are of that joint.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compliance_of: Option<String>,
    /// Coefficients of terms of the joint's value, in radians, metres, or by value: the value is the reading's, plus these terms.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(with = "BTreeMap<TermName, f64>")]
    pub terms: BTreeMap<Term, f64>,
    /// Coefficients of the nominal model's terms.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(with = "BTreeMap<TermName, f64>")]
    pub nominal_terms: BTreeMap<Term, f64>,
}

/// A screw, linear part first.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ScrewEntry {
    /// Linear part: metres of an axis, a unit vector of a sliding direction.
    pub v_m: [f64; 3],
    /// Angular part: a unit vector of an axis, zero of a sliding direction.
    pub w: [f64; 3],
}

/// Frame of the measuring device.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrameEntry {
    /// Knowledge of the frame: unknown, or equal to the base.
    pub known: DeviceFrameKnowledge,
    /// Pose of the device in the base.
    pub base_from_device: PoseEntry,
}

/// A station of the measuring device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StationEntry {
    /// Name of the instrument: from the column `instrument`, or the file with `--device-frames per-file`.
    pub instrument: Option<String>,
    /// Pose of the device in the base; of an instrument on the robot, at zero joint values.
    pub base_from_device: PoseEntry,
    /// Standard deviation of each component of its measurements that state none, if it differs from that of the first instrument.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma: Option<MeasuredQuantities<f64>>,
    /// SessionKind, if it is no instrument with a frame of its own: anchor, socket, plane (z is its normal), sphere, direction (z is along it), pair (of
    /// configurations, without a meaningful pose).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<String>,
    /// Radius of a sphere, with that of the probe, known or found, millimetres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius_mm: Option<f64>,
    /// Reading of its distances at its own position, millimetres, if it is not 0; for a sphere that is touched, minus its radius.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub zero_mm: Option<f64>,
    /// Scale error of its distance readings (scale less 1), if it is not 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
}

impl StationEntry {
    /// An instrument with a frame of its own.
    #[must_use]
    pub fn instrument(name: Option<String>, base_from_device: PoseEntry) -> Self {
        StationEntry {
            instrument: name,
            base_from_device,
            sigma: None,
            kind: None,
            radius_mm: None,
            zero_mm: None,
            scale: None,
        }
    }
}

/// A pose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PoseEntry {
    /// Position, metres.
    pub position_m: [f64; 3],
    /// Unit quaternion x, y, z, w.
    pub quaternion_xyzw: [f64; 4],
}

/// A target; a point has no orientation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TargetEntry {
    /// Position, metres.
    pub position_m: [f64; 3],
    /// Unit quaternion x, y, z, w, where orientation was measured; of a target on a body of its own, always.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub quaternion_xyzw: Option<[f64; 4]>,
    /// Body of a target that is not in the tip frame: its pose is in the frame of the joint that moves the body, or in the base.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub on: Option<BodyEntry>,
    /// The measured quantities of such a target; the rest of its pose is the model's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured: Option<MeasuredEntry>,
}

impl RobotEntry {
    /// Frames of a robot and its nominal model.
    pub(crate) fn new(robot: &Robot, nominal: &Robot) -> Self {
        RobotEntry {
            name: robot.name.clone(),
            base_link: robot.base_name.clone(),
            tip_link: robot.tip_name.clone(),
            base_from_tip_at_zero: (&robot.home).into(),
            nominal_base_from_tip_at_zero: (&nominal.home).into(),
            tip_on: robot.tip.map(|body| BodyEntry::from_body(robot, body)),
            gravity: robot.gravity.as_ref().map(|gravity| GravityEntry::from_gravity(robot, gravity)),
            masses: MassEntry::all_from_robot(robot),
            factors: robot.factors.clone(),
        }
    }
}

impl StationEntry {
    /// Entries of a calibration's stations; empty for a single one without a name.
    pub(crate) fn all_from_stations(stations: &[CalibratedStation], noise: Noise, errors: &ModelAccuracy) -> Vec<Self> {
        let is_plain = stations.len() == 1 && stations.iter().all(|it| it.name.is_none());
        let entry = |it: &CalibratedStation| StationEntry {
            instrument: it.name.clone(),
            base_from_device: (&it.base_from_device).into(),
            sigma: (it.noise != noise).then(|| measured_noise(errors, it.noise)),
            kind: (it.kind != "instrument").then(|| it.kind.to_owned()),
            radius_mm: it.radius_m.map(|radius| 1e3 * radius),
            zero_mm: (it.range.zero_m != 0.0).then_some(1e3 * it.range.zero_m),
            scale: (it.range.scale != 0.0).then_some(it.range.scale),
        };
        if is_plain { Vec::new() } else { stations.iter().map(entry).collect() }
    }
}
