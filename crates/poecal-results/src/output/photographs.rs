//! Output of a simulated session of pictures: both robots, the readings, the camera, the pictures and the truth.

use std::fmt::Write as _;

use serde::Serialize;

use super::contents::picture_name;
use super::simulation::{Magnitudes, SCHEMA, actual_files};
use super::{NewFile, ReservedFolder, WrittenFiles, robot_files, write_files};
use crate::calibration_file::{JointEntry, PoseEntry, RobotEntry};
use crate::model::Model;
use poecal_model::camera::Distortion;
use poecal_model::simulate::{PictureSimulation, SimulatedPictures};
use poecal_numerics::error::Result;
use poecal_storage::csv_text::cell;
use poecal_storage::json_text;
use poecal_storage::numbers::push_number;

/// Steps of a reading in a degree or a millimetre.
const STEPS: f64 = 1e4;

/// A simulated session of pictures and its origin.
#[derive(Clone, Copy, Debug)]
pub struct PhotographedSession<'a> {
    /// Options.
    pub simulation: &'a PictureSimulation,
    /// Result.
    pub made: &'a SimulatedPictures,
    /// The pictures as PNG, in the order of the session.
    pub pictures: &'a [Vec<u8>],
    /// The board in words.
    pub board: &'a str,
    /// The command that makes the same session.
    pub command: &'a str,
}

/// Truth of a simulated session of pictures (`truth.json`): lengths in metres and angles in radians unless a key states another unit.
#[derive(Serialize)]
struct PictureTruthFile {
    schema: &'static str,
    poecal_version: &'static str,
    command: String,
    seed: u64,
    kind: &'static str,
    count: usize,
    board: String,
    errors: Magnitudes,
    /// Further error of the arm in each configuration: standard deviations.
    noise: Magnitudes,
    robot: RobotEntry,
    joints: Vec<JointEntry>,
    camera_in_hand: bool,
    /// Pose of the object on the tip: the camera, or the board.
    tip_from_held: PoseEntry,
    /// Pose of the stationary object: the board, or the camera.
    base_from_other: PoseEntry,
}

/// Writes a simulated session of pictures, completely or not at all: `nominal` and `actual` model, `joints.csv` with the readings of each picture,
/// `cameras.csv`, the pictures, and `truth.json`.
///
/// # Errors
/// As [`super::write_simulation`].
pub fn write_photographs(
    place: ReservedFolder,
    model: &Model,
    session: &PhotographedSession<'_>,
) -> Result<WrittenFiles> {
    let PhotographedSession { simulation, made, .. } = session;
    let mut notes = Vec::new();
    let mut files = robot_files("nominal", model, &made.nominal, &mut notes)?;
    let rigid = made.actual.rigid();
    files.extend(actual_files(model, &made.actual, &rigid, &mut notes)?);
    files.push(NewFile::new("joints.csv", joints(session)));
    files.push(NewFile::new("cameras.csv", camera(session)));
    let named = session.pictures.iter().enumerate();
    files.extend(named.map(|(at, bytes)| NewFile::of_bytes(picture_name(at), bytes)));
    let truth = PictureTruthFile {
        schema: SCHEMA,
        poecal_version: env!("CARGO_PKG_VERSION"),
        command: session.command.to_owned(),
        seed: simulation.session.seed,
        kind: "picture",
        count: made.data.len(),
        board: session.board.to_owned(),
        errors: Magnitudes::new(simulation.session.error_position_m, simulation.session.error_rotation_rad),
        noise: Magnitudes::new(simulation.common.shift_m, simulation.common.turn_rad),
        robot: RobotEntry::new(&made.actual, &made.nominal),
        joints: JointEntry::of_robot(&made.actual, &made.nominal),
        camera_in_hand: simulation.in_hand,
        tip_from_held: (&made.tip_from_held).into(),
        base_from_other: (&made.base_from_other).into(),
    };
    files.push(NewFile::new("truth.json", json_text(&truth, "truth")?));
    write_files(place, &files, None, notes)
}

/// The readings of each picture.
fn joints(session: &PhotographedSession<'_>) -> String {
    let data = &session.made.data;
    let names = data.reading_names();
    let kinds: Vec<_> = names.iter().map(|name| session.made.nominal.reading_kind(name)).collect();
    let mut text = format!("# simulated by: {}\nimage", session.command);
    for (name, kind) in names.iter().zip(&kinds) {
        text.push(',');
        text.push_str(&cell(&format!("{name}[{}]", kind.symbol())));
    }
    for at in 0..data.len() {
        text.push('\n');
        text.push_str(&picture_name(at));
        for (value, kind) in data.readings(at).iter().zip(&kinds) {
            text.push(',');
            push_number(&mut text, (kind.in_shown_unit(*value) * STEPS).round() / STEPS);
        }
    }
    text.push('\n');
    text
}

/// The camera as a table.
fn camera(session: &PhotographedSession<'_>) -> String {
    let lens = &session.simulation.lens;
    let name = session.made.data.pictures.cameras.first().map_or("camera", |it| it.name.as_str());
    let ([fx, fy], [cx, cy]) = (lens.focal_px, lens.centre_px);
    let [k1, k2] = match lens.distortion {
        Distortion::Brown(numbers) => [numbers[0], numbers[1]],
        Distortion::Fisheye(_) => [0.0; 2],
    };
    let [width, height] = lens.size_px.unwrap_or([0, 0]);
    let mut text = "name,fx,fy,cx,cy,k1,k2,width,height\n".to_owned();
    let _ = writeln!(text, "{},{fx:?},{fy:?},{cx:?},{cy:?},{k1:?},{k2:?},{width},{height}", cell(name));
    text
}
