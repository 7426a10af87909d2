//! The keys of `calibration.json`. Lengths are in metres and angles in radians unless a key states another unit.

use std::collections::BTreeMap;
use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bodies::InstrumentEntry;
use super::changes::CommonDirectionEntry;
use super::common_errors::SuspectedConfigurationEntry;
use super::compensation::CompensationEntry;
use super::corrected_model::CorrectedEntry;
use super::frames::{FrameEntry, JointEntry, PoseEntry, RobotEntry, StationEntry, TargetEntry};
use super::original::OriginalUrdf;
use super::recalibration::RecalibratedEntry;
use super::trust::{CorrectionEntry, CrossValidationEntry, UncertaintyEntry};
use super::{ClockEntry, OutlierEntry, PicturesEntry, RepeatabilityEntry, RobustEntry};
use crate::record::Record;
use poecal_calibrate::{Acceptance, Accuracy, Event, FormulationWords, NoiseSource, Verdict};
use poecal_fit::analysis::{Direction, Identifiability, JointCoverage, Observability};
use poecal_fit::forensics::DiagnosisKind;
use poecal_import::{InputEntry, JoinEntry, MeasurementFile};
use poecal_model::measurement::MeasuredQuantities;
use poecal_model::robot::Controller;
use poecal_numerics::error::Result;
use poecal_numerics::solve::Termination;
use poecal_storage::hashes::sha256;

/// A finished calibration.
///
/// ```no_run
/// let file = poecal_results::calibration_file::CalibrationFile::read("poecal-out/calibration.json")?;
/// let robot = file.robot()?;
/// println!("{:?}", robot.forward_kinematics(&vec![0.0; robot.reading_names().len()]));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CalibrationFile {
    /// Version of the file.
    pub schema: String,
    /// Version of the program.
    pub poecal_version: String,
    /// Inputs.
    pub inputs: Inputs,
    /// Statements about the session; absent if there are none.
    #[serde(default, skip_serializing_if = "Record::is_empty")]
    pub record: Record,
    /// Errors of the nominal, registered and calibrated model on training and held-out rows.
    pub accuracy: Accuracy,
    /// Fitted and held blocks, if they differ from the default: all axes, targets and frames.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blocks: Option<BlocksEntry>,
    /// The minimisation: steps, end, convergence.
    pub solver: SolverEntry,
    /// Determination of the unknowns by the measurements.
    pub identifiability: IdentifiabilityEntry,
    /// Noise by which residuals were weighted.
    pub noise: NoiseEntry,
    /// Result of the requested acceptance limits; absent if none were requested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acceptance: Option<Acceptance>,
    /// Verdict: fitness of the result for use, and its domain.
    #[serde(default)]
    pub verdict: Option<Verdict>,
    /// Sampled part of each joint's range.
    #[serde(default)]
    pub coverage: Vec<JointCoverage>,
    /// Cross-validation: errors of rows that are predicted by a fit of the others; null if there are too few.
    #[serde(default)]
    pub cross_validation: Option<CrossValidationEntry>,
    /// Each joint's correction.
    #[serde(default)]
    pub corrections: Vec<CorrectionEntry>,
    /// Directions in which the measurements determine corrections of several joints only together; absent if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub common: Vec<CommonDirectionEntry>,
    /// Expected errors of predictions; null without more residuals than unknowns.
    #[serde(default)]
    pub uncertainty: Option<UncertaintyEntry>,
    /// Treatment of outliers.
    #[serde(default)]
    pub robust: RobustEntry,
    /// Suspected rows, the worst first, at most 1,000; `robust` has their number.
    #[serde(default)]
    pub outliers: Vec<OutlierEntry>,
    /// Configurations in which all targets are suspected with similar residuals, the worst first, at most 100: the arm or its readings are wrong
    /// there.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub suspected_configurations: Vec<SuspectedConfigurationEntry>,
    /// Configurations that were measured several times; null if there are none.
    #[serde(default)]
    pub repeatability: Option<RepeatabilityEntry>,
    /// The pictures, their noise and lenses; absent if there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pictures: Option<PicturesEntry>,
    /// Warnings, a sentence each.
    #[serde(default)]
    pub warnings: Vec<String>,
    /// Mistakes in the input: reported, not corrected.
    #[serde(default)]
    pub diagnosis: Vec<DiagnosisEntry>,
    /// Events of the session that were repaired; everything else in this file is of the repaired session.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub repairs: Vec<Event>,
    /// Probable events that were not repaired.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub suspicions: Vec<Event>,
    /// Joints that were recalibrated since, by `poecal track --recalibrate`, in order; everything else is of the earlier calibration.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub recalibrated: Vec<RecalibratedEntry>,
    /// The calibrated robot's frames.
    pub robot: RobotEntry,
    /// The calibrated joints from base to tip.
    pub joints: Vec<JointEntry>,
    /// Mapping from the controller's counts to the readings of the joints; absent if they are equal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub controller: Option<Controller>,
    /// Frame of the measuring device.
    pub measurement_frame: FrameEntry,
    /// Stations of the measuring device, if they are named or several; the first is that of `measurement_frame`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stations: Vec<StationEntry>,
    /// Clocks of instruments that measured in motion; absent where none did.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub clocks: Vec<ClockEntry>,
    /// Pose of the tip in the last joint's frame.
    pub tool: PoseEntry,
    /// True if the measured point became the tip (`--move-tip`); otherwise the tip is the model's, on the last link.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub move_tip: bool,
    /// Targets by their names, `measured` if no row names one: in the tip frame, or on a body of their own (`on`). Empty if `move_tip` is true.
    pub targets: BTreeMap<String, TargetEntry>,
    /// Instruments on the robot.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub instruments: BTreeMap<String, InstrumentEntry>,
    /// Error of programs for the nominal robot in the sampled workspace, and the joint corrections that remove it. Absent if the calibration is not
    /// to be used, or if some joint does not move the robot's tip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compensation: Option<Box<CompensationEntry>>,
    /// The corrected model: screws and terms of the joints fitted together; absent if no terms were requested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub corrected: Option<Box<CorrectedEntry>>,
}

/// Inputs.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_results::calibration_file::Inputs;
/// # }
/// use poecal::Inputs;
/// let inputs = Inputs { model: "robot.urdf".into(), measurements: vec!["points.csv".into()], ..Inputs::default() };
/// assert_eq!(inputs.measurements.len(), 1);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Inputs {
    /// The robot model, as named by the user.
    pub model: String,
    /// The measurement files, as named by the user.
    pub measurements: Vec<String>,
    /// SHA-256 of each file by its name; of input that is no regular file, such as a pipe, only for measurements.
    #[serde(default)]
    pub sha256: BTreeMap<String, String>,
    /// Kind of each measurement file and its used rows; one with joint readings and measurements has two entries.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<InputEntry>,
    /// Joins of files of joint readings with files of measurements; absent if one file has both.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joins: Vec<JoinEntry>,
    /// The command that reproduces the calibration; null if it was not made by the program.
    #[serde(default)]
    pub command: Option<String>,
    /// The URDF that was calibrated; absent if the model was no URDF.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub urdf: Option<OriginalUrdf>,
}

impl Inputs {
    /// Adds the stored facts of measurement files that were read.
    pub fn take(&mut self, file: &MeasurementFile) {
        self.sha256.extend(file.sha256.clone());
        self.files.extend(file.inputs());
        self.joins.extend(file.joins.iter().cloned());
    }

    /// Checksum of each model or mapping file by its name; for measurements see
    /// [`MeasurementFile::sha256`](poecal_import::MeasurementFile::sha256). Inputs that are no regular files are not listed.
    ///
    /// # Errors
    /// [`ErrorKind::File`](poecal_numerics::error::ErrorKind::File) if a file cannot be read.
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
    /// Effect of the formulation on the result, if it is not the default one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub note: Option<String>,
    /// Iterations of the full fit.
    pub iterations: usize,
    /// True if an optimum was reached.
    pub converged: bool,
    /// Reason of its end.
    pub termination: Termination,
    /// Number of further starts after a suspected local minimum.
    pub restarts: usize,
    /// Tolerance of the prior, if cross-validation chose it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub chosen_tolerance: Option<ToleranceEntry>,
    /// Mean square of the whitened residual by iteration, the start first; each re-weighted round of the fit starts again.
    #[serde(default)]
    pub trace: Vec<f64>,
    /// Fitted joint offsets: joint value minus reading, if the formulation contains them. Data cannot separate them from screws; in `joints` they are
    /// part of the screws, and the readings need no correction.
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

/// Tolerance of the prior: expected deviation of each axis from nominal, standard deviations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ToleranceEntry {
    /// Tolerance of its direction, degrees.
    pub angle_deg: f64,
    /// Tolerance of its position, millimetres.
    pub length_mm: f64,
}

/// Offset of a joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OffsetEntry {
    /// The joint.
    pub joint: String,
    /// Offset of a revolute joint, degrees.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub offset_deg: Option<f64>,
    /// Offset of a prismatic joint, millimetres.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub offset_mm: Option<f64>,
}

/// Blocks of unknowns by name: `JOINT.axis`, `JOINT.offset` and other terms, `target.NAME`, `frame.NAME`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct BlocksEntry {
    /// Fitted.
    pub free: Vec<String>,
    /// Held as in the model; terms that are zero are not listed.
    pub held: Vec<String>,
}

/// Determination of the unknowns by the measurements.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct IdentifiabilityEntry {
    /// Unknowns in the minimal basis.
    pub parameters: usize,
    /// Directions that the data determine against the noise.
    pub rank: usize,
    /// Effective number of unknowns that the measurements determine beside the prior.
    #[serde(default)]
    pub effective_unknowns: Option<f64>,
    /// Condition number over these directions; null if there are none.
    pub condition: Option<f64>,
    /// Directions that the configurations do not determine.
    pub unidentifiable: Vec<Direction>,
    /// Directions that they determine weakly, little better than the nominal model.
    #[serde(default)]
    pub weak: Vec<Direction>,
    /// Directions that are not observable by measurements of this kind: not among the parameters, and without effect on predictions.
    #[serde(default)]
    pub structural: Vec<Direction>,
    /// Observability indices; null where a singular value is zero.
    #[serde(default)]
    pub observability: Observability,
}

impl IdentifiabilityEntry {
    /// Number of unknowns that are determined weakly.
    #[must_use]
    pub fn weakly_determined(&self) -> usize {
        self.weak.iter().map(|direction| direction.directions).sum()
    }

    /// The entry of an analysis of identifiability.
    pub fn from_identifiability(found: &Identifiability) -> Self {
        IdentifiabilityEntry {
            parameters: found.parameters,
            rank: found.rank,
            effective_unknowns: Some(found.effective_unknowns),
            condition: Some(found.condition).filter(|condition| condition.is_finite()),
            unidentifiable: found.unidentifiable.clone(),
            weak: found.weak.clone(),
            structural: found.structural.clone(),
            observability: found.observability,
        }
    }
}

/// Noise by which residuals were weighted if a row stated none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NoiseEntry {
    /// Standard deviation of each component of each measured quantity, millimetres or degrees.
    pub sigma: MeasuredQuantities<f64>,
    /// Source of the noise.
    pub source: NoiseSource,
}

/// A mistake in the input.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct DiagnosisEntry {
    /// Kind of the mistake.
    pub kind: DiagnosisKind,
    /// Evidence and advice.
    pub statement: String,
    /// Rows concerned, counted from 0 over all files; empty if all are.
    pub rows: Vec<u32>,
}
