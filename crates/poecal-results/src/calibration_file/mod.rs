//! `calibration.json`: a finished calibration as a versioned file, sufficient for predictions.

mod bodies;
mod changes;
mod clocks;
mod common_errors;
mod compensation;
mod controller;
mod corrected_model;
mod fit_uncertainty;
mod frames;
mod gain;
mod judging_data;
mod link;
mod original;
mod outliers;
mod own_rows;
mod pictures;
mod prediction_uncertainty;
mod recalibration;
mod refusal;
mod repeatability;
mod schema;
mod stages;
mod taught_robot;
mod trust;
mod validation;

pub use bodies::{BodyEntry, InstrumentEntry, MassEntry, MeasuredEntry};
pub use changes::{CommonDirectionEntry, CorrelatedEntry, CorrelationsEntry, JointChangeEntry};
pub use clocks::ClockEntry;
pub use common_errors::SuspectedConfigurationEntry;
pub use compensation::{CompensationEntry, DisplacementEntry, ReadingChangeEntry, SpreadEntry, WorkspaceCellEntry};
pub use controller::ControllerCounts;
pub use corrected_model::{
    CorrectedEntry, EffectEntry, GravityEntry, JointErrorEntry, JointErrorsEntry, TriedEntry, WeightEntry,
};
pub use frames::*;
pub use original::OriginalUrdf;
pub use outliers::{OutlierEntry, OutlierSet, OutliersBySet, RobustEntry};
pub use pictures::{CommonEntry, PicturesEntry};
pub use poecal_model::camera::{BoardEntry, CameraEntry, PointEntry};
pub use recalibration::{JointRepair, RecalibratedEntry, RecalibrationSources, RepairedPart};
pub use repeatability::{RepeatabilityEntry, RepeatedPoseEntry};
pub use schema::*;
pub(crate) use stages::only_target;
pub use taught_robot::TaughtRobot;
pub use trust::*;

use std::collections::BTreeMap;
use std::path::Path;

use super::record::Record;
use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Screw, Twist};
use poecal_calibrate::{Calibration, DeviceFrameKnowledge, ModelAccuracy, names};
use poecal_fit::forensics::Diagnosis;
use poecal_fit::parameters::Block;
use poecal_model::measurement::{Dataset, MeasuredQuantities, Noise, Quantity};
use poecal_model::robot::{Joint, JointKind, JointLimits, JointTerm, Robot, Term};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::{json_text, source_text};
pub use refusal::SCHEMA;
use refusal::refusal;
pub(crate) use refusal::schema_of;
use schemars::Schema;
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use serde_json::Value;

impl CalibrationFile {
    /// File of a finished calibration, with the user's names of the inputs.
    #[must_use]
    pub fn new(calibration: &Calibration, data: &Dataset, inputs: Inputs) -> Self {
        let robot = &calibration.robot;
        let joints = JointEntry::of_robot(robot, &calibration.nominal);
        let measured_kinds = &calibration.accuracy.training.calibrated;
        CalibrationFile {
            schema: SCHEMA.to_owned(),
            poecal_version: env!("CARGO_PKG_VERSION").to_owned(),
            inputs,
            record: Record::default(),
            accuracy: calibration.accuracy,
            blocks: BlocksEntry::from_calibration(calibration, data),
            solver: SolverEntry::from_calibration(calibration),
            identifiability: IdentifiabilityEntry::from_identifiability(&calibration.identifiability),
            acceptance: calibration.acceptance.clone(),
            verdict: Some(calibration.verdict.clone()),
            coverage: calibration.trust.coverage.clone(),
            cross_validation: CrossValidationEntry::from_trust(&calibration.trust),
            corrections: CorrectionEntry::of_all(&calibration.trust),
            common: CommonDirectionEntry::all_from_calibration(calibration),
            uncertainty: UncertaintyEntry::from_calibration(calibration, data),
            robust: RobustEntry::from_calibration(calibration),
            outliers: OutlierEntry::all_from_calibration(calibration, data),
            suspected_configurations: SuspectedConfigurationEntry::all_from_calibration(calibration, data),
            repeatability: RepeatabilityEntry::from_calibration(calibration, data),
            pictures: PicturesEntry::from_dataset(data, &calibration.images),
            warnings: calibration.warnings.clone(),
            diagnosis: calibration.diagnosis.iter().map(DiagnosisEntry::from).collect(),
            repairs: calibration.repairs.clone(),
            suspicions: calibration.suspicions.clone(),
            recalibrated: Vec::new(),
            noise: NoiseEntry {
                sigma: measured_noise(measured_kinds, calibration.noise),
                source: calibration.noise_source,
            },
            robot: RobotEntry::new(robot, &calibration.nominal),
            joints,
            controller: data.controller.clone(),
            measurement_frame: FrameEntry {
                known: calibration.frame,
                base_from_device: (&calibration.base_from_device).into(),
            },
            stations: StationEntry::all_from_stations(&calibration.stations, calibration.noise, measured_kinds),
            clocks: ClockEntry::all_from_calibration(calibration, data),
            tool: (&robot.last_joint_from_tip()).into(),
            move_tip: calibration.targets.iter().any(|it| it.name.is_none()),
            targets: bodies::targets(robot, &calibration.targets),
            instruments: InstrumentEntry::all_from_mounts(robot, &robot.instruments),
            compensation: CompensationEntry::from_calibration(calibration).map(Box::new),
            corrected: calibration.correction.as_ref().map(|it| Box::new(CorrectedEntry::from_correction(it, data))),
        }
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`ErrorKind::File`] if it cannot be read, [`ErrorKind::Syntax`] if it is no calibration of this version.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::parse(&source_text::read(path, "a calibration.json")?, path)
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// [`ErrorKind::Syntax`] if it is no calibration of this version.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self> {
        Self::parse_at(text, path.as_ref())
    }

    /// The part of reading that does not depend on the kind of path, compiled once.
    fn parse_at(text: &str, path: &Path) -> Result<Self> {
        match serde_json::from_str::<Self>(text) {
            Ok(file) if file.schema == SCHEMA => Ok(file),
            other => Err(refusal(text, other.err(), path)),
        }
    }

    /// The text of the file, with a final line break.
    ///
    /// # Errors
    /// [`ErrorKind::Export`] if a number is not finite.
    pub fn to_text(&self) -> Result<String> {
        json_text(self, "calibration")
    }

    /// `base_from_device` of the calibration.
    ///
    /// # Errors
    /// [`ErrorKind::Model`] if the file holds no valid pose.
    pub fn base_from_device(&self) -> Result<Pose> {
        self.measurement_frame.base_from_device.pose()
    }

    /// Name of the first station.
    fn first_station(&self) -> Option<&str> {
        self.stations.first().and_then(|station| station.instrument.as_deref())
    }

    /// The JSON Schema (draft 2020-12) of the file.
    #[must_use]
    pub fn json_schema() -> String {
        let settings = SchemaSettings::draft2020_12().with_transform(RecursiveTransform(without_example));
        let schema = settings.into_generator().into_root_schema_for::<CalibrationFile>();
        serde_json::to_string_pretty(&schema).unwrap_or_default() + "\n"
    }
}

/// Numbers in the unit of files from those in metres or radians.
fn in_file_units(mut si: impl FnMut(Quantity) -> Option<f64>) -> MeasuredQuantities<f64> {
    MeasuredQuantities::from_fn(|quantity| si(quantity).map(|number| quantity.unit().in_shown_unit(number)))
}

/// An error of a file that holds no valid robot, as a result.
fn refuse<T>(message: String) -> Result<T> {
    ErrorKind::Model.refuse(message)
}

/// Removes examples in Rust from a description.
fn without_example(schema: &mut Schema) {
    if let Some(Value::String(words)) = schema.get_mut("description")
        && let Some(end) = words.find("```")
    {
        words.truncate(end);
        words.truncate(words.trim_end().len());
    }
}

impl From<&Diagnosis> for DiagnosisEntry {
    fn from(found: &Diagnosis) -> Self {
        DiagnosisEntry { kind: found.kind, statement: found.statement.clone(), rows: found.rows.clone() }
    }
}

impl SolverEntry {
    fn from_calibration(calibration: &Calibration) -> Self {
        let (solver, words) = (&calibration.solver, &calibration.formulation.words);
        SolverEntry {
            formulation: words.formulation.to_owned(),
            pose_residual: words.pose_residual.to_owned(),
            method: words.method.to_owned(),
            note: words.note.map(str::to_owned),
            iterations: solver.iterations,
            converged: solver.termination.is_success(),
            termination: solver.termination,
            restarts: solver.restarts,
            chosen_tolerance: calibration
                .chosen_tolerance
                .map(|it| ToleranceEntry { angle_deg: it.angle_rad.to_degrees(), length_mm: 1e3 * it.length_m }),
            trace: solver.trace.iter().copied().filter(|value| value.is_finite()).collect(),
            joint_offsets: OffsetEntry::all_from_calibration(calibration),
        }
    }
}

impl BlocksEntry {
    /// Entry of a fit with other blocks than the default ones.
    fn from_calibration(calibration: &Calibration, data: &Dataset) -> Option<Self> {
        let unknowns = &calibration.unknowns;
        if unknowns.are_usual() {
            return None;
        }
        let names = names(&calibration.nominal, data);
        let (mut free, mut held) = (Vec::new(), Vec::new());
        for block in names.blocks() {
            let is_free = match block {
                Block::Axis(joint) => unknowns.moves_axis(joint),
                Block::Target(target) => unknowns.moves_target(target),
                Block::Frame(station) => {
                    unknowns.moves_frame(station) && calibration.frame == DeviceFrameKnowledge::Unknown
                }
                Block::Term(joint, term) if unknowns.terms.contains(&(joint, term)) => true,
                Block::Range(station, term) if unknowns.ranges.contains(&(station, term)) => true,
                Block::Clock(station, term) if data.moving.clock(station).is_some() => {
                    !unknowns.held_clocks.contains(&(station, term))
                }
                Block::Term(..) | Block::Range(..) | Block::Clock(..) => continue,
            };
            if is_free { &mut free } else { &mut held }.push(names.name_of_block(block));
        }
        let listed = names.blocks();
        let terms = unknowns.terms.iter().map(|&(joint, term)| Block::Term(joint, term));
        free.extend(terms.filter(|block| !listed.contains(block)).map(|block| names.name_of_block(block)));
        Some(BlocksEntry { free, held })
    }
}

/// Noise of the quantities that the fitted rows measured, millimetres or degrees.
fn measured_noise(errors: &ModelAccuracy, noise: Noise) -> MeasuredQuantities<f64> {
    errors.map(|quantity, _| quantity.unit().in_shown_unit(noise[quantity]))
}

impl OffsetEntry {
    /// Joint offsets of a formulation that contains them.
    fn all_from_calibration(calibration: &Calibration) -> Option<Vec<Self>> {
        let offsets = calibration.solver.joint_offsets.as_ref()?;
        let entry = |(joint, &offset): (&Joint, &f64)| OffsetEntry {
            joint: joint.name.clone(),
            offset_deg: (joint.kind == JointKind::Revolute).then(|| offset.to_degrees()),
            offset_mm: (joint.kind == JointKind::Prismatic).then_some(offset * 1e3),
        };
        Some(calibration.nominal.joints.iter().zip(offsets).map(entry).collect())
    }
}

impl JointEntry {
    /// Joints of a robot and its nominal model.
    pub(crate) fn of_robot(robot: &Robot, nominal: &Robot) -> Vec<Self> {
        let pairs = robot.joints.iter().zip(&nominal.joints);
        pairs
            .map(|(joint, nominal)| JointEntry {
                name: joint.name.clone(),
                kind: joint.kind,
                screw: (&joint.screw).into(),
                nominal_screw: (&nominal.screw).into(),
                base_from_joint: (&joint.frame).into(),
                limits: joint.limits.map(|limits| [limits.lower, limits.upper]),
                reading: joint.reading.clone(),
                on: joint.stands_on.map(|body| BodyEntry::from_body(robot, body)),
                compliance_of: joint.give_of.and_then(|of| robot.joints.get(of)).map(|of| of.name.clone()),
                terms: BTreeMap::new(),
                nominal_terms: BTreeMap::new(),
            })
            .enumerate()
            .map(|(joint, entry)| {
                let of = |terms: &[JointTerm]| -> BTreeMap<Term, f64> {
                    let own = terms.iter().filter(|it| it.joint == joint);
                    own.map(|it| (it.term, it.coefficient)).collect()
                };
                let mut nominal_terms = of(&nominal.terms);
                nominal_terms.retain(|_, coefficient| *coefficient != 0.0);
                JointEntry { terms: of(&robot.terms), nominal_terms, ..entry }
            })
            .collect()
    }

    /// The joint with one of its screws. Its body, and the joint whose compliance it is, are left unset.
    fn joint(&self, screw: &ScrewEntry) -> Result<Joint> {
        let (kind, screw) = (self.kind, screw.screw(self)?);
        if let Some([lower, upper]) = self.limits
            && (lower.is_nan() || upper.is_nan() || lower >= upper)
        {
            return refuse(format!(
                "found limits from {lower} to {upper} of joint `{}`, expected the lower one first",
                self.name
            ));
        }
        Ok(Joint {
            frame: self.base_from_joint.pose()?,
            limits: self.limits.map(|[lower, upper]| JointLimits { lower, upper }),
            reading: self.reading.clone(),
            ..Joint::with_screw(&self.name, kind, screw)
        })
    }
}

impl ScrewEntry {
    /// The screw, as one of a joint.
    fn screw(&self, of: &JointEntry) -> Result<Screw> {
        let kind = of.kind;
        let twist = Twist::new(Vector3::from(self.v_m), Vector3::from(self.w));
        let bad = || {
            let (name, kind) = (&of.name, kind.word());
            ErrorKind::Model
                .error(format!("found a screw of joint `{name}` that is no {kind} screw, expected a unit one"))
        };
        let screw = Screw::project(&twist).ok_or_else(bad)?;
        let off = (screw.twist().to_vector() - twist.to_vector()).norm();
        if screw.is_prismatic() != (kind == JointKind::Prismatic) || off.is_nan() || off > 1e-6 {
            return Err(bad());
        }
        Ok(screw)
    }
}

impl PoseEntry {
    /// The pose.
    ///
    /// # Errors
    /// [`ErrorKind::Model`] if the quaternion is far from unit.
    pub fn pose(&self) -> Result<Pose> {
        let norm = self.quaternion_xyzw.iter().map(|q| q * q).sum::<f64>().sqrt();
        if norm.is_nan() || (norm - 1.0).abs() > 1e-6 {
            return ErrorKind::Model.refuse(format!(
                "found a quaternion of length {norm}, expected a unit quaternion in x, y, z, w order"
            ));
        }
        Ok(Pose::from_position_quaternion(self.position_m, self.quaternion_xyzw))
    }
}

impl From<&Pose> for PoseEntry {
    fn from(pose: &Pose) -> Self {
        PoseEntry { position_m: pose.translation.into(), quaternion_xyzw: pose.quaternion_xyzw() }
    }
}

impl From<&Screw> for ScrewEntry {
    fn from(screw: &Screw) -> Self {
        ScrewEntry { v_m: screw.v().into(), w: screw.w().into() }
    }
}
