//! `poecal simulate --camera`: pictures of a board as a robot with errors would take them.

use poecal::camera::{CommonError, Distortion, Lens};
use poecal::io::measurements::read_boards;
use poecal::io::model::Model;
use poecal::io::output::{FolderPlace, PhotographedSession, write_photographs};
use poecal::lie::Pose;
use poecal::simulate::{PictureSimulation, Simulation};
use poecal::{ErrorKind, Result};
use poecal_detect::render::{Camera, Random, Scene, clutter};
use poecal_detect::{Layout, Spec, png};
use rayon::prelude::*;

use crate::args::{CameraPlace, Simulate};
use crate::console::Console;
use crate::style;

/// Most pictures of a session.
const MOST: u32 = 999;
/// The camera: size of its pictures, focal length and first number of its distortion.
const SIZE_PX: [u32; 2] = [1280, 800];
const FOCAL_PX: f64 = 1000.0;
const K1: f64 = -0.08;
/// Gray levels of ink and paper, blur and noise of the pictures.
const LEVELS: [f64; 2] = [35.0, 200.0];
const BLUR_PX: f64 = 0.8;
const NOISE: f64 = 2.0;

pub(super) fn photograph(
    (arguments, camera): (&Simulate, CameraPlace),
    (model, place, command): (&Model, FolderPlace, &str),
    console: &Console,
) -> Result<u8> {
    if arguments.count > MOST {
        return ErrorKind::Option.refuse(format!(
            "found --count {} with --camera, expected at most {MOST} pictures",
            arguments.count
        ));
    }
    if let Spec::Tags(_) = arguments.board {
        return ErrorKind::Option.refuse(format!(
            "found --board {}, whose tags may be anywhere, expected a board of known places, as charuco, chessboard, circles or aprilgrid",
            arguments.board
        ));
    }
    let board = arguments.board.to_string();
    let body = read_boards(&board)?.into_iter().next().unwrap_or_default();
    let session = Simulation {
        error_rotation_rad: arguments.errors.angle_rad,
        error_position_m: arguments.errors.length_m,
        count: arguments.count as usize,
        seed: arguments.seed,
        ..Simulation::default()
    };
    let middle_px = SIZE_PX.map(|size| 0.5 * (f64::from(size) - 1.0));
    let pinhole = Lens::pinhole([FOCAL_PX; 2], middle_px);
    let distortion = Distortion::Brown([K1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let lens = Lens { size_px: Some(SIZE_PX), distortion, ..pinhole };
    let usual = PictureSimulation::usual(session, camera == CameraPlace::InHand);
    let noise = CommonError {
        shift_m: arguments.noise.length_m,
        turn_rad: arguments.noise.angle_rad,
        ..CommonError::default()
    };
    let simulation = PictureSimulation { common: noise, ..usual.before(body, lens) };
    let made = simulation.run(&model.robot)?;
    let layout = Layout::new(&arguments.board);
    let poses = made.camera_from_board.par_iter().enumerate();
    let pictures: Vec<Vec<u8>> = poses
        .map(|(at, pose)| picture(&layout, pose, arguments.seed.wrapping_mul(1000).wrapping_add(at as u64)))
        .collect::<std::result::Result<_, _>>()
        .map_err(|error| ErrorKind::Option.error(error.to_string()))?;
    let session = PhotographedSession {
        simulation: &simulation,
        made: &made,
        pictures: &pictures,
        board: &board,
        command,
    };
    let written = write_photographs(place, model, &session)?;
    console.warnings(&written.notes);
    let files: Vec<String> = written.files.iter().filter(|it| !it.starts_with("picture-")).cloned().collect();
    let count = written.files.len() - files.len();
    let files = [files, vec![format!("{count} pictures")]].concat();
    Ok(console.say_of(&style::written(&written.folder, &files), &written.folder))
}

/// A picture of the board in a pose in the camera's frame.
fn picture(layout: &Layout, pose: &Pose, seed: u64) -> poecal_detect::Result<Vec<u8>> {
    let mut random = Random::new(seed);
    let size = SIZE_PX.map(|size| size as usize);
    let middle_px = SIZE_PX.map(|size| 0.5 * (f64::from(size) - 1.0));
    let camera = Camera { size, focal_px: [FOCAL_PX; 2], centre_px: middle_px, distortion: [K1, 0.0] };
    let background = clutter(size, &mut random);
    let scene = Scene {
        camera,
        rotation: pose.rotation,
        translation_m: pose.translation,
        levels: LEVELS,
        gradient: [random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)],
        blur_px: BLUR_PX,
        noise: NOISE,
        patch: None,
    };
    png(&scene.render(layout, &background, &mut random))
}
