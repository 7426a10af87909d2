//! Output of a simulated session: both robots, the measurements and the truth.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{CONFIGURATIONS, NewFile, ReservedFolder, WrittenFiles, robot_files, write_files};
use crate::calibration_file::{FrameEntry, InstrumentEntry, JointEntry, PoseEntry, RobotEntry};
use crate::model::Model;
use poecal_calibrate::DeviceFrameKnowledge;
use poecal_formats::proof::Difference;
use poecal_import as measurements;
use poecal_model::measurement::{Dataset, Noise};
use poecal_model::robot::Robot;
use poecal_model::simulate::{SessionKind, Simulation, SimulationResult};
use poecal_numerics::error::Result;
use poecal_storage::json_text;

/// Version word of `truth.json`.
pub(crate) const SCHEMA: &str = "poecal-truth-1";

/// A simulated session and its origin.
#[derive(Clone, Copy, Debug)]
pub struct SimulatedSession<'a> {
    /// Options.
    pub simulation: &'a Simulation,
    /// Kind of the measurements.
    pub kind: SessionKind,
    /// Result.
    pub made: &'a SimulationResult,
    /// Further rows without noise.
    pub held_out: Option<&'a Dataset>,
    /// The command that makes the same session.
    pub command: &'a str,
}

/// Truth of a simulated session (`truth.json`). Lengths are in metres and angles in radians unless a key states another unit. "nominal" is the
/// supplied model; the other entries are of the actual robot.
#[derive(Serialize)]
struct TruthFile {
    schema: String,
    poecal_version: String,
    command: String,
    seed: u64,
    kind: String,
    count: usize,
    held_out_count: usize,
    errors: Magnitudes,
    noise: Magnitudes,
    robot: RobotEntry,
    joints: Vec<JointEntry>,
    measurement_frame: FrameEntry,
    tool: PoseEntry,
    /// Instruments on the robot, and targets with a body of their own.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    instruments: BTreeMap<String, InstrumentEntry>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    targets: BTreeMap<String, InstrumentEntry>,
}

#[derive(Serialize)]
pub(crate) struct Magnitudes {
    position_mm: f64,
    rotation_deg: f64,
}

impl Magnitudes {
    pub(crate) fn new(position_m: f64, rotation_rad: f64) -> Self {
        Magnitudes { position_mm: position_m * 1e3, rotation_deg: rotation_rad.to_degrees() }
    }
}

impl TruthFile {
    fn new(session: &SimulatedSession) -> Self {
        let SimulatedSession { simulation, made, .. } = session;
        let all: Vec<usize> = (0..made.nominal.joints.len()).collect();
        let gives = made.actual.joints.len() > made.nominal.joints.len();
        let nominal =
            if gives { made.nominal.with_compliance(&all, simulation.terms.gives()).0 } else { made.nominal.clone() };
        TruthFile {
            schema: SCHEMA.to_owned(),
            poecal_version: env!("CARGO_PKG_VERSION").to_owned(),
            command: session.command.to_owned(),
            seed: simulation.seed,
            kind: session.kind.word().to_owned(),
            count: made.data.len(),
            held_out_count: session.held_out.map_or(0, Dataset::len),
            errors: Magnitudes::new(simulation.error_position_m, simulation.error_rotation_rad),
            noise: Magnitudes::new(simulation.noise_position_m, simulation.noise_rotation_rad),
            robot: RobotEntry::new(&made.actual, &made.nominal),
            joints: JointEntry::of_robot(&made.actual, &nominal),
            measurement_frame: FrameEntry {
                known: if simulation.device_anywhere {
                    DeviceFrameKnowledge::Unknown
                } else {
                    DeviceFrameKnowledge::Base
                },
                base_from_device: (&made.device_from_base.inverse()).into(),
            },
            tool: (&made.actual.last_joint_from_tip()).into(),
            instruments: InstrumentEntry::all_from_mounts(&made.actual, &made.actual.instruments),
            targets: InstrumentEntry::all_from_mounts(&made.actual, &made.actual.mounted),
        }
    }
}

/// Writes a simulated session, completely or not at all: `nominal` and `actual` model, `measurements.csv`, `held_out.csv` if there are such
/// rows, and `truth.json`. Models are read back and compared with their robots in 1,000 configurations.
///
/// # Errors
/// [`ErrorKind::File`](poecal_numerics::error::ErrorKind::File) if something cannot be written;
/// [`ErrorKind::Export`](poecal_numerics::error::ErrorKind::Export) if a model read back differs by more than 1e-9 m or rad.
/// Nothing is left behind then.
pub fn write_simulation(place: ReservedFolder, model: &Model, session: &SimulatedSession) -> Result<WrittenFiles> {
    let SimulatedSession { simulation, made, command, .. } = session;
    let noise = Noise::new(simulation.noise_position_m, simulation.noise_rotation_rad);
    let exact = Noise::new(0.0, 0.0);
    let mut notes = Vec::new();
    let mut files = robot_files("nominal", model, &made.nominal, &mut notes)?;
    let mut rigid = made.actual.rigid();
    rigid.terms.truncate(made.nominal.terms.len());
    files.extend(actual_files(model, &made.actual, &rigid, &mut notes)?);
    let comment = format!("simulated by: {command}");
    let measured = measurements::text(&made.data, &made.nominal, &noise, &comment)?;
    files.push(NewFile::new("measurements.csv", measured));
    if let Some(held_out) = session.held_out {
        let comment = format!("{comment} (rows to judge by, free of noise)");
        let text = measurements::text(held_out, &made.nominal, &exact, &comment)?;
        files.push(NewFile::new("held_out.csv", text));
    }
    files.push(NewFile::new("truth.json", json_text(&TruthFile::new(session), "truth")?));
    write_files(place, &files, None, notes)
}

/// The actual robot in the form of `model`, without joint effects beyond geometry; a note states the omission.
pub(crate) fn actual_files<'a>(
    model: &Model,
    actual: &Robot,
    rigid: &'a Robot,
    notes: &mut Vec<String>,
) -> Result<Vec<NewFile<'a>>> {
    if rigid.joints.len() < actual.joints.len() {
        let off = Difference::from_robots(actual, rigid, CONFIGURATIONS).position_m * 1e3;
        notes.push(format!(
            "the actual model is written without what its joints do beyond geometry, which moves the tip by up to {off:.3} mm: truth.json has it"
        ));
    }
    let files = robot_files("actual", model, rigid, notes)?;
    notes.sort();
    notes.dedup();
    Ok(files)
}
