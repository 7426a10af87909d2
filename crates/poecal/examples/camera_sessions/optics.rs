//! Lenses, boards and markers that differ from their statement.

use nalgebra::Vector6;
use poecal_calibrate::BlockChoice;
use poecal_calibrate::CalibrationOptions;
use poecal_fit::start::settle_pictures;
use poecal_model::camera::{Board, Camera, Distortion, Lens, PictureNumber};
use poecal_model::simulate::random;
use poecal_numerics::error::Error;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;
use serde_json::{Value, json};

use crate::session::{
    COUNT, PictureSession, all_rows, judge_session, places, rebuild_pictures, register_deviations, rms, shape,
    simulate_session, simulation,
};

/// The stretch of a board along x.
const STRETCH: f64 = 1.004;
/// Displacement of each marker along each direction, metres.
const MOVED_M: f64 = 0.5e-3;

pub(crate) fn run(seed: u64) -> Result<Vec<Value>, Error> {
    let in_hand = seed.is_multiple_of(2);
    let k1 = -0.1;
    let base = simulation(in_hand, 0.0, 3000 + seed);
    let lens = Lens { distortion: Distortion::Brown([k1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]), ..base.lens };
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let mut lines = Vec::new();
    let true_lens = poecal_model::simulate::PictureSimulation { lens, ..base };
    let session = simulate_session(true_lens)?;
    let (_, _, known) = judge_session(&session, &session.data, &all_rows())?;
    let known = rms(&shape(&session, &known))[0];
    let numbers = lens.numbers();
    let mut sign = || if random::uniform_number(&mut generator) < 0.5 { -1.0 } else { 1.0 };
    let mut wrong = numbers;
    let (focal, centre) = (1.0 + 0.03 * sign(), [20.0 * sign(), 20.0 * sign()]);
    (wrong[0], wrong[1]) = (numbers[0] * focal, numbers[1] * focal);
    (wrong[2], wrong[3]) = (numbers[2] + centre[0], numbers[3] + centre[1]);
    wrong[4] = k1 + 0.1 * sign();
    let given = lens.with_numbers(&wrong);
    for (name, is_guessed, free) in [("guessed lens", true, vec![]), ("free lens", false, vec!["lens"])] {
        let camera = Camera { is_guessed, ..Camera::new("camera".to_owned(), given) };
        let boards = session.data.pictures.boards.clone();
        let truth = |number: &PictureNumber| {
            let at = poecal_model::camera::LENS_NAMES.iter().position(|name| number.name.ends_with(name));
            at.map_or(0.0, |at| numbers[at])
        };
        lines.push(line(seed, (name, &free), (&session, (&[camera], &boards)), (known, truth))?);
    }
    let cameras = session.data.pictures.cameras.clone();
    let board = session.data.pictures.boards[0].clone();
    // The print is larger than stated: the truth is the session's board.
    let said = with_points(&board, |point| point[0] /= STRETCH);
    let truth = |number: &PictureNumber| match number.name.as_str() {
        "board.board.scale_x" => STRETCH,
        "board.board.scale_y" => 1.0,
        _ => 0.0,
    };
    lines.push(line(seed, ("board", &["board"]), (&session, (&cameras, &[said])), (known, truth))?);
    let said = with_points(&board, |point| {
        (0..3).for_each(|k| point[k] += MOVED_M * random::normal(&mut generator));
    });
    let truth = |number: &PictureNumber| {
        let mut words = number.name.rsplit('.');
        let axis = words.next().and_then(|word| ["x", "y", "z"].iter().position(|it| *it == word));
        let point = words.next().and_then(|name| board.find(name));
        1e3 * point.zip(axis).map_or(0.0, |(point, axis)| board.points[point][axis])
    };
    lines.push(line(seed, ("markers", &["markers"]), (&session, (&cameras, &[said])), (known, truth))?);
    Ok(lines)
}

/// Root mean square error of the arm, with the device's frame registered.
fn arm_m(session: &PictureSession, deviations: &[Vector6<f64>]) -> f64 {
    rms(&register_deviations(&places(session), deviations))[0]
}

fn with_points(board: &Board, mut change: impl FnMut(&mut nalgebra::Vector3<f64>)) -> Board {
    let mut found = board.clone();
    found.points.iter_mut().for_each(&mut change);
    found
}

/// A calibration with these cameras and boards; some words are free.
fn line(
    seed: u64,
    (name, free): (&str, &[&str]),
    (session, given): (&PictureSession, (&[Camera], &[Board])),
    (known, truth): (f64, impl Fn(&PictureNumber) -> f64),
) -> Result<Value, Error> {
    let mut data = rebuild_pictures(&session.data, 0..COUNT, given)?;
    let said = settle_pictures(&mut data, &session.made.nominal).all();
    let blocks = BlockChoice { free: free.iter().map(|it| (*it).to_owned()).collect(), ..BlockChoice::default() };
    let options = CalibrationOptions { blocks, ..all_rows() };
    let (calibration, data, deviations) = judge_session(session, &data, &options)?;
    let shape_m = rms(&shape(session, &deviations))[0];
    let found = &data.pictures.found;
    let off = |number: &PictureNumber| (number.found - truth(number)) / number.deviation;
    let off: Vec<(String, f64, f64)> =
        found.iter().map(|number| (number.name.clone(), off(number), number.deviation)).collect();
    let farthest = off.iter().map(|(_, off, _)| off.abs()).fold(0.0, f64::max);
    let inside = off.iter().filter(|(_, off, _)| off.abs() <= 3.0).count();
    Ok(json!({
        "task": "optics", "seed": seed, "what": name, "in_hand": session.simulation.in_hand,
        "numbers": found.len(), "inside": inside, "farthest": farthest,
        "off": if found.len() < 20 { json!(off) } else { json!(off.len()) },
        "mm": 1e3 * arm_m(session, &deviations), "shape_mm": 1e3 * shape_m, "known_mm": 1e3 * known, "start": said, "level": calibration.verdict.level.words(),
    }))
}
