//! The keys of `calibration.json`. Lengths in metres and angles in radians unless a key says otherwise.

use std::collections::BTreeMap;
use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::trust::{CorrectionEntry, CrossValidationEntry, UncertaintyEntry};
use super::{OutlierEntry, RepeatabilityEntry, RobustEntry};
use crate::analysis::{Direction, Identifiability, JointCoverage, Observability};
use crate::calibration::{Accuracy, DeviceFrameKnowledge, FormulationWords, NoiseSource, Verdict};
use crate::error::Result;
use crate::forensics::DiagnosisKind;
use crate::io::hashes::sha256;
use crate::robot::{JointKind, Reading};
use crate::solve::Termination;

/// A finished calibration.
///
/// ```no_run
/// let file = poecal::io::calibration_file::CalibrationFile::read("poecal-out/calibration.json")?;
/// let robot = file.robot()?;
/// println!("{:?}", robot.forward_kinematics(&vec![0.0; robot.reading_names().len()]));
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CalibrationFile {
    /// Version of this form.
    pub schema: String,
    /// Version of the program that wrote it.
    pub poecal_version: String,
    /// What was read.
    pub inputs: Inputs,
    /// Errors of the nominal, registered and calibrated model on training and held-out rows.
    pub accuracy: Accuracy,
    /// The minimisation: steps, end, convergence.
    pub solver: SolverEntry,
    /// Which unknowns the measurements determine.
    pub identifiability: IdentifiabilityEntry,
    /// Noise by which residuals were weighted.
    pub noise: NoiseEntry,
    /// Whether the result is good to use, and where.
    #[serde(default)]
    pub verdict: Option<Verdict>,
    /// How much of each joint's range was sampled.
    #[serde(default)]
    pub coverage: Vec<JointCoverage>,
    /// Cross-validation: errors of rows that are predicted by a fit of the others; null if there are too few.
    #[serde(default)]
    pub cross_validation: Option<CrossValidationEntry>,
    /// Each joint's correction.
    #[serde(default)]
    pub corrections: Vec<CorrectionEntry>,
    /// Expected errors of predictions; null if there are no more residuals than unknowns.
    #[serde(default)]
    pub uncertainty: Option<UncertaintyEntry>,
    /// How outliers were treated.
    #[serde(default)]
    pub robust: RobustEntry,
    /// The rows that are suspected, the worst first, at most 1,000; `robust` has their number.
    #[serde(default)]
    pub outliers: Vec<OutlierEntry>,
    /// Configurations that were measured several times; null if there are none.
    #[serde(default)]
    pub repeatability: Option<RepeatabilityEntry>,
    /// What makes the result doubtful, a sentence each.
    #[serde(default)]
    pub warnings: Vec<String>,
    /// Mistakes that the measurements show: named, not corrected.
    #[serde(default)]
    pub diagnosis: Vec<DiagnosisEntry>,
    /// The calibrated robot's frames.
    pub robot: RobotEntry,
    /// The calibrated joints from base to tip.
    pub joints: Vec<JointEntry>,
    /// Where the measuring device stands.
    pub measurement_frame: FrameEntry,
    /// Where the measuring device stood, if the measurements name it or it stood at several places; the first is that of
    /// `measurement_frame`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stations: Vec<StationEntry>,
    /// Pose of the tip in the last joint's frame.
    pub tool: PoseEntry,
    /// Named targets in the tip frame.
    pub targets: BTreeMap<String, TargetEntry>,
}

/// What was read.
///
/// ```
/// use poecal::io::calibration_file::Inputs;
/// let inputs = Inputs { model: "robot.urdf".into(), measurements: vec!["points.csv".into()], ..Inputs::default() };
/// assert_eq!(inputs.measurements.len(), 1);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Inputs {
    /// The robot model, as named by the user.
    pub model: String,
    /// The measurement files, as named by the user.
    pub measurements: Vec<String>,
    /// SHA-256 of each file that was read, by the name that the user gave it; what is no regular file, such as a pipe, has one only if it
    /// is of measurements.
    #[serde(default)]
    pub sha256: BTreeMap<String, String>,
    /// The command that makes the same calibration again; null if it was not made by the program.
    #[serde(default)]
    pub command: Option<String>,
}

impl Inputs {
    /// The checksum of each file, by its name: of a model or a mapping, those of measurements being told by
    /// [`MeasurementFile::sha256`](crate::io::measurements::MeasurementFile::sha256). What is no regular file has none.
    ///
    /// # Errors
    /// [`ErrorKind::File`](crate::ErrorKind::File) if a file cannot be read.
    pub fn checksums<'a>(files: impl Iterator<Item = &'a Path>) -> Result<BTreeMap<String, String>> {
        let named = |path: &Path| Ok(sha256(path)?.map(|sha256| (path.display().to_string(), sha256)));
        files.filter_map(|path| named(path).transpose()).collect()
    }
}

/// The minimisation: steps, end, convergence.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SolverEntry {
    /// Parameterisation of joint errors: `adjoint`, or a formulation for comparison.
    #[serde(default = "usual_formulation")]
    pub formulation: String,
    /// Residual of measured frames: `tool`, at the target, or another for comparison.
    #[serde(default = "usual_pose_residual")]
    pub pose_residual: String,
    /// Method of the solver: `levenberg-marquardt`, or others for comparison.
    #[serde(default = "usual_method")]
    pub method: String,
    /// What the formulation does to the result, if it is not the usual one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub note: Option<String>,
    /// Iterations of the full fit.
    pub iterations: usize,
    /// Whether an optimum was reached.
    pub converged: bool,
    /// Why it ended.
    pub termination: Termination,
    /// Further starts because the first fit seemed to have converged to a local minimum.
    pub restarts: usize,
    /// Mean square of the whitened residual by iteration, the start first; each re-weighted round of the fit starts again.
    #[serde(default)]
    pub trace: Vec<f64>,
    /// Joint offsets found: joint value minus reading, where the formulation has them. Data cannot separate them
    /// from screws; in `joints` they are part of the screws, and the readings need no correction.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub joint_offsets: Option<Vec<OffsetEntry>>,
}

fn usual_formulation() -> String {
    FormulationWords::default().formulation.to_owned()
}

fn usual_pose_residual() -> String {
    FormulationWords::default().pose_residual.to_owned()
}

fn usual_method() -> String {
    FormulationWords::default().method.to_owned()
}

/// An offset of a joint, by its unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OffsetEntry {
    /// The joint.
    pub joint: String,
    /// Of a revolute joint, degrees.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub offset_deg: Option<f64>,
    /// Of a prismatic joint, millimetres.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub offset_mm: Option<f64>,
}

/// Which unknowns the measurements determine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct IdentifiabilityEntry {
    /// Unknowns in the minimal basis.
    pub parameters: usize,
    /// Directions that the data determine against the noise.
    pub rank: usize,
    /// Effective number of unknowns that the measurements determine beside the prior: the sum of a share of each.
    #[serde(default)]
    pub told: Option<f64>,
    /// Condition number over those directions; null if there is none.
    pub condition: Option<f64>,
    /// Directions that the configurations do not determine.
    pub unidentifiable: Vec<Direction>,
    /// Directions that they determine weakly, hardly better than the nominal model.
    #[serde(default)]
    pub weak: Vec<Direction>,
    /// What is not observable: no measurement of this kind could determine it. It is not among the parameters, and changes no prediction.
    #[serde(default)]
    pub structural: Vec<Direction>,
    /// The observability indices; null where a direction is not observed at all.
    #[serde(default)]
    pub observability: Observability,
}

impl IdentifiabilityEntry {
    pub(crate) fn of(found: &Identifiability) -> Self {
        IdentifiabilityEntry {
            parameters: found.parameters,
            rank: found.rank,
            told: Some(found.told),
            condition: Some(found.condition).filter(|condition| condition.is_finite()),
            unidentifiable: found.unidentifiable.clone(),
            weak: found.weak.clone(),
            structural: found.structural.clone(),
            observability: found.observability,
        }
    }
}

/// Noise by which residuals were weighted where a row stated none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NoiseEntry {
    /// Standard deviation of each position component, millimetres.
    pub sigma_position_mm: f64,
    /// Standard deviation of each rotation component, degrees; null where no orientation was measured.
    pub sigma_rotation_deg: Option<f64>,
    /// Where it came from.
    pub source: NoiseSource,
}

/// A mistake that the measurements show.
///
/// ```
/// use poecal::forensics::DiagnosisKind;
/// use poecal::io::calibration_file::DiagnosisEntry;
/// let text = r#"{ "kind": "joint_sign", "statement": "counting joint4 the other way …", "rows": [] }"#;
/// let entry: DiagnosisEntry = serde_json::from_str(text)?;
/// assert_eq!(entry.kind, DiagnosisKind::JointSign);
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct DiagnosisEntry {
    /// What it is.
    pub kind: DiagnosisKind,
    /// The evidence and what to do.
    pub statement: String,
    /// The rows concerned, counted from 0 over all files; empty if all are.
    pub rows: Vec<u32>,
}

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
    /// The same of the nominal model.
    pub nominal_base_from_tip_at_zero: PoseEntry,
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
    /// How the joint's value follows from a reading.
    pub reading: Reading,
}

/// A screw, linear part first.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ScrewEntry {
    /// Linear part: metres of an axis, a unit vector of a sliding direction.
    pub v_m: [f64; 3],
    /// Angular part: a unit vector of an axis, zero of a sliding direction.
    pub w: [f64; 3],
}

/// Where the measuring device stands.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrameEntry {
    /// Whether the frame was unknown or the base.
    pub known: DeviceFrameKnowledge,
    /// Pose of the device in the base.
    pub base_from_device: PoseEntry,
}

/// A place that the measuring device stood at.
///
/// ```
/// use poecal::io::calibration_file::{PoseEntry, StationEntry};
/// let base_from_device = PoseEntry { position_m: [1.0, 0.0, 0.5], quaternion_xyzw: [0.0, 0.0, 0.0, 1.0] };
/// let station = StationEntry { instrument: Some("left".into()), base_from_device };
/// assert!(station.base_from_device.pose().is_ok());
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StationEntry {
    /// The instrument's name: what the column `instrument` says, or the file with `--frames per-file`.
    pub instrument: Option<String>,
    /// Pose of the device in the base.
    pub base_from_device: PoseEntry,
}

/// A pose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PoseEntry {
    /// Position, metres.
    pub position_m: [f64; 3],
    /// Unit quaternion x, y, z, w.
    pub quaternion_xyzw: [f64; 4],
}

/// A target in the tip frame; a point has no orientation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TargetEntry {
    /// Position, metres.
    pub position_m: [f64; 3],
    /// Unit quaternion x, y, z, w, where orientation was measured.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub quaternion_xyzw: Option<[f64; 4]>,
}
