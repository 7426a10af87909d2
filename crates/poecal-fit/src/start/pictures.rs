//! Mounting of a camera (robot or base), and choice of two poses of a board in a picture, with nominal screws.

use super::misread_pictures::find_misreading;
use super::registration::Registration;
use super::stations::register;
use crate::state::{Estimate, PackedValues, RowError, Session, nominal_estimate};
use poecal_arm::lie::{Pose, rotation};
use poecal_model::camera::{Picture, Pictures};
use poecal_model::measurement::{Dataset, Measurement, Noise, Quantity, StatedDeviations, deviation};
use poecal_model::robot::{Mount, Robot};
use poecal_numerics::distributions::median;
use poecal_numerics::error::first_few;

/// Largest number of rounds in which pictures take the other of their poses.
const ROUNDS: usize = 6;
/// Noise of a registration, which covers the errors of the nominal robot: m and rad.
const NOISE: Noise = Noise::new(2e-3, 5e-3);
/// Multiple of the usual error beyond which a picture does not count in a registration.
const ODD: f64 = 4.0;
/// Fewest pictures of a registration.
const FEWEST: usize = 4;
/// Angle from a prediction beyond which a board may be turned by half a turn, rad; up to the same angle it counts as turned back.
const FAR_TURNED: f64 = 2.2;
const NEAR: f64 = 0.7;
/// Factor by which the error of the other mounting must be larger, so that this one is evident.
const EVIDENT: f64 = 1.5;

/// Findings on pictures, a sentence each.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SolvedPictures {
    /// Assumed mounting of the camera, if that is evident.
    pub notes: Vec<String>,
    /// Possible mistakes.
    pub warnings: Vec<String>,
}

impl SolvedPictures {
    /// All notes and warnings.
    #[must_use]
    pub fn all(self) -> Vec<String> {
        self.notes.into_iter().chain(self.warnings).collect()
    }
}

/// Chooses, for each picture that has two poses, the one that agrees with the other pictures. For cameras and boards that the model does not
/// place by name it determines the mounting: the camera beside the robot and the board in its hand, or the reverse. The mounting with the
/// smaller error of the corners is taken, with the current robot (theory.md §6, *Start*).
pub fn settle_pictures(data: &mut Dataset, robot: &Robot) -> SolvedPictures {
    if data.pictures.is_empty() {
        return SolvedPictures::default();
    }
    let is_placed = |name: &str, mounts: &[Mount]| mounts.iter().any(|mount| mount.name == name);
    let Pictures { cameras, boards, .. } = &data.pictures;
    let placed = cameras.iter().any(|it| is_placed(&it.name, &robot.instruments))
        || boards.iter().any(|it| is_placed(&it.name, &robot.mounted));
    let (beside, beside_px) = settle_poses(data, robot);
    if placed {
        let mut warnings = turned_back(data, &beside);
        warnings.extend(find_misreading(data, beside_px, |other| settle_poses(other, robot).1));
        *data = beside;
        return SolvedPictures { warnings, notes: Vec::new() };
    }
    let (held, held_px) = settle_poses(&in_hand(data), robot);
    let (found, place, own, other) = if held_px < beside_px {
        (held, "on the last link, and the board stays", held_px, beside_px)
    } else {
        (beside, "beside the robot, and the board is on the last link", beside_px, held_px)
    };
    let mut warnings = turned_back(data, &found);
    let missed = |read: &Dataset| settle_poses(read, robot).1.min(settle_poses(&in_hand(read), robot).1);
    warnings.extend(find_misreading(data, own, missed));
    *data = found;
    let mut placed = format!(
        "the camera is {place}: so the nominal robot misses half of the pictures by less than {own:.1} px, the other way {other:.1} px"
    );
    if other >= EVIDENT * own {
        return SolvedPictures { notes: vec![placed], warnings };
    }
    placed.push_str("; that is not evident: state it with --instrument CAMERA=LINK and --target BOARD=LINK");
    warnings.insert(0, placed);
    SolvedPictures { notes: Vec::new(), warnings }
}

/// Pictures whose corners were taken in reverse order.
fn turned_back(before: &Dataset, after: &Dataset) -> Vec<String> {
    let differs = |(old, new): &(&Picture, &Picture)| {
        old.corners.first().map(|it| it.point) != new.corners.first().map(|it| it.point)
    };
    let turned = before.pictures.all.iter().zip(&after.pictures.all).filter(differs);
    let names: Vec<String> = turned
        .map(|(_, picture)| picture.image.clone().unwrap_or_else(|| format!("row {}", picture.row + 1)))
        .collect();
    if names.is_empty() {
        return Vec::new();
    }
    vec![format!(
        "took the corners of {} of {} pictures the other way round, the first for the last, since their board is turned by half a turn against the \
         others: {}",
        names.len(),
        before.pictures.all.len(),
        first_few(&names)
    )]
}

/// Takes the pose of each picture that its corners fit best.
pub(super) fn take_first_poses(data: &mut Dataset) {
    for at in 0..data.pictures.all.len() {
        choose(data, at, |picture| picture.poses.first().copied());
    }
}

/// The same pictures with the camera as the target, and the board as the instrument.
pub(super) fn in_hand(data: &Dataset) -> Dataset {
    let mut found = data.clone();
    let rows: Vec<(usize, usize, usize)> =
        data.pictures.all.iter().map(|it| (it.row as usize, it.camera, it.board)).collect();
    // Names of objects in no picture stay.
    let is_of_pictures = |row: usize| data.pictures.index_of_row(row as u32).is_some();
    let others = (0..data.len()).filter(|row| !is_of_pictures(*row));
    let others: Vec<(usize, usize, usize)> =
        others.map(|row| (row, data.observations[row].target, data.observations[row].station)).collect();
    (found.targets, found.stations) = (Vec::new(), Vec::new());
    for (row, target, station) in others {
        let target = found.target_index(data.targets[target].as_deref());
        let station = data.stations.get(station).cloned().flatten();
        let station = named_station(&mut found, station.as_deref());
        (found.observations[row].target, found.observations[row].station) = (target, station);
    }
    for (row, camera, board) in rows {
        let camera = data.pictures.cameras[camera].name.clone();
        let board = data.pictures.boards[board].name.clone();
        let target = found.target_index(Some(&camera));
        let station = named_station(&mut found, Some(&board));
        (found.observations[row].target, found.observations[row].station) = (target, station);
    }
    found.pictures.all.iter_mut().for_each(|picture| picture.of_camera = true);
    found
}

fn named_station(data: &mut Dataset, name: Option<&str>) -> usize {
    if let Some(at) = data.stations.iter().position(|it| it.as_deref() == name) {
        return at;
    }
    data.stations.push(name.map(str::to_owned));
    data.stations.len() - 1
}

/// The data with the pose of each picture that fits the others, and the median error of corners, pixels.
fn settle_poses(data: &Dataset, robot: &Robot) -> (Dataset, f64) {
    let mut found = data.clone();
    let rows: Vec<u32> = data.pictures.all.iter().map(|it| it.row).collect();
    take_first_poses(&mut found);
    let packed = PackedValues::from_dataset(robot, &found);
    let (mut best, mut result, mut used) = (f64::INFINITY, found.clone(), rows.clone());
    for _ in 0..ROUNDS {
        let registered = register_pictures(&found, robot, &packed, &used);
        let predicted = predict_poses(&found, robot, &packed, &rows, &registered);
        let missed: Vec<f64> = found.pictures.all.iter().zip(&predicted).map(|it| missed_px(&found, it)).collect();
        let usual = median(missed.iter().copied()).unwrap_or(f64::INFINITY);
        if usual < best {
            (best, result) = (usual, found.clone());
        }
        let mut has_changed = false;
        for (at, predicted) in predicted.iter().enumerate() {
            has_changed |= turn_back(&mut found, at, predicted);
            let before = found.pictures.all[at].poses.first().copied();
            choose(&mut found, at, |picture| nearest_pose(picture, predicted));
            has_changed |= before != found.pictures.all[at].poses.first().copied();
        }
        // A picture whose board is tilted in the wrong direction would bias all others.
        let kept = rows.iter().zip(&missed).filter(|(_, missed)| **missed <= ODD * usual).map(|(row, _)| *row);
        let kept: Vec<u32> = kept.collect();
        if !has_changed && kept == used {
            break;
        }
        used = if kept.len() >= FEWEST { kept } else { rows.clone() };
    }
    (result, best)
}

/// Registration of some pictures with equal noise: by their own noise, a wrong pose of small variance would bias the others.
fn register_pictures(data: &Dataset, robot: &Robot, packed: &PackedValues, rows: &[u32]) -> Estimate {
    let mut plain = data.clone();
    for &row in rows {
        let observation = &mut plain.observations[row as usize];
        (observation.noise_shape, observation.stated) = (None, StatedDeviations::default());
    }
    let session = Session::new(robot, &plain, packed, true);
    let registration = Registration { session, rows, noise: NOISE, targets_free: true, prior: None };
    register(&registration, &nominal_estimate(robot, &plain)).0
}

/// Poses of the boards in the frames of their cameras, as an estimate predicts them, one for each picture.
fn predict_poses(data: &Dataset, robot: &Robot, packed: &PackedValues, rows: &[u32], estimate: &Estimate) -> Vec<Pose> {
    let session = Session::new(robot, data, packed, true);
    let errors = session.errors(rows, estimate);
    let seen = data.pictures.all.iter().zip(errors);
    seen.map(|(picture, error)| {
        let measured = data.observations[picture.row as usize].measurement.pose();
        picture.directed_measurement(&predicted_pose(&measured, &error))
    })
    .collect()
}

/// Predicted pose of a row from its measurement and its error (theory.md §4 (16)).
pub fn predicted_pose(measured: &Pose, error: &RowError) -> Pose {
    let turn = rotation::exp(&-error.vector(Quantity::Rotation));
    Pose::new(turn * measured.rotation, measured.translation - error.position_m())
}

/// Root mean square distance of the corners of a picture from their predicted positions, pixels; an invisible one counts as far.
fn missed_px(data: &Dataset, (picture, pose): (&Picture, &Pose)) -> f64 {
    const UNSEEN: f64 = 1e4;
    let errors = data.pictures.view(picture).map(|view| view.errors(pose)).unwrap_or_default();
    let squares = errors.iter().map(|error| error.map_or(UNSEEN * UNSEEN, |it| it.norm_squared()));
    (squares.sum::<f64>() / errors.len().max(1) as f64).sqrt()
}

/// Makes one of the poses of a picture its first, and its row.
fn choose(data: &mut Dataset, at: usize, pose: impl FnOnce(&Picture) -> Option<Pose>) {
    let Some(picture) = data.pictures.all.get_mut(at) else { return };
    let Some(chosen) = pose(picture) else { return };
    if let Some(place) = picture.poses.iter().position(|it| *it == chosen) {
        picture.poses.swap(0, place);
    }
    let (row, measured) = (picture.row as usize, picture.directed_measurement(&chosen));
    let sighting = {
        let picture = &data.pictures.all[at];
        data.pictures.view(picture).and_then(|view| view.sighting(&chosen, true))
    };
    match sighting {
        Some(sighting) => data.state_picture(at, &sighting),
        None => data.observations[row].measurement = Measurement::of_pose(&measured),
    }
}

/// Reverses the order of the corners of a picture, the first for the last, if its board is predicted turned by half a turn; true if so.
fn turn_back(data: &mut Dataset, at: usize, predicted: &Pose) -> bool {
    let Some(picture) = data.pictures.all.get(at) else { return false };
    let board = data.pictures.boards.get(picture.board);
    let Some((board, half_turn)) = board.and_then(|board| Some((board, board.half_turn()?))) else {
        return false;
    };
    let apart = |pose: &Pose| deviation(pose, predicted).fixed_rows::<3>(3).norm();
    let least = picture.poses.iter().map(apart).fold(f64::INFINITY, f64::min);
    let turned: Vec<Pose> = picture.poses.iter().map(|pose| *pose * half_turn).collect();
    if least < FAR_TURNED || turned.iter().map(apart).fold(f64::INFINITY, f64::min) > NEAR {
        return false;
    }
    let last = u32::try_from(board.points.len()).unwrap_or(u32::MAX).saturating_sub(1);
    let Some(picture) = data.pictures.all.get_mut(at) else { return false };
    picture.corners.iter_mut().for_each(|corner| corner.point = last.saturating_sub(corner.point));
    picture.poses = turned;
    true
}

/// Pose of a picture with the smallest rotation from a predicted one.
fn nearest_pose(picture: &Picture, predicted: &Pose) -> Option<Pose> {
    let turned = |pose: &&Pose| deviation(pose, predicted).fixed_rows::<3>(3).norm();
    picture.poses.iter().min_by(|a, b| turned(a).total_cmp(&turned(b))).copied()
}
