//! `poecal simulate --camera`: pictures of a board as a robot with errors would take them.

use poecal_arm::lie::{Pose, rotation};
use poecal_detect::render::{RandomGenerator, RenderCamera, RenderScene, clutter};
use poecal_detect::{BoardLayout, BoardSpec, png};
use poecal_fit::hand_eye::CameraMounting;
use poecal_import::read_boards;
use poecal_model::camera::{Board, CommonError, Distortion, Lens};
use poecal_model::simulate::{PictureSimulation, Simulation};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_results::model::Model;
use poecal_results::output::{PhotographedSession, ReservedFolder, write_photographs};
use rayon::prelude::*;

use crate::args::Simulate;
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

pub(crate) fn photograph(
    (arguments, camera): (&Simulate, CameraMounting),
    (model, place, command): (&Model, ReservedFolder, &str),
    console: &Console,
) -> Result<u8> {
    if arguments.count > MOST {
        return ErrorKind::Option
            .refuse(format!("found --count {} with --camera, expected at most {MOST} pictures", arguments.count));
    }
    if let BoardSpec::Tags(_) = arguments.board {
        return ErrorKind::Option.refuse(format!(
            "found --board {}, whose tags have no stated positions, expected a board with a known layout: charuco, chessboard, circles or aprilgrid",
            arguments.board
        ));
    }
    let board = arguments.board.to_string();
    let layout = BoardLayout::new(&arguments.board);
    let scene_from_board = scene_from_board(&layout);
    let mut body = read_boards(&board)?.into_iter().next().unwrap_or_default();
    body.points.iter_mut().for_each(|point| *point = scene_from_board.act(point));
    let simulation = simulation(arguments, camera, body);
    let lens = simulation.lens;
    let mut made = simulation.run(&model.robot)?;
    let poses = made.camera_from_board.par_iter().enumerate();
    let pictures: Vec<Vec<u8>> = poses
        .map(|(at, pose)| picture((&layout, &lens), pose, arguments.seed.wrapping_mul(1000).wrapping_add(at as u64)))
        .collect::<std::result::Result<_, _>>()
        .map_err(|error| ErrorKind::Option.error(error.to_string()))?;
    // Pose of the board's axes as calibrate defines them.
    let of_board = if simulation.in_hand { &mut made.base_from_other } else { &mut made.tip_from_held };
    *of_board = *of_board * scene_from_board;
    let session =
        PhotographedSession { simulation: &simulation, made: &made, pictures: &pictures, board: &board, command };
    let written = write_photographs(place, model, &session)?;
    console.warnings(&written.notes);
    let files: Vec<String> = written.files.iter().filter(|it| !it.starts_with("picture-")).cloned().collect();
    let count = written.files.len() - files.len();
    let files = [files, vec![format!("{count} pictures")]].concat();
    Ok(console.say_of(&style::describe_written_files(&written.folder, &files), &written.folder))
}

/// The simulated session of a camera and a board.
fn simulation(arguments: &Simulate, camera: CameraMounting, body: Board) -> PictureSimulation {
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
    let usual = PictureSimulation::with_usual_camera(session, camera == CameraMounting::InHand);
    let noise = CommonError {
        shift_m: arguments.noise.length_m,
        turn_rad: arguments.noise.angle_rad,
        ..CommonError::default()
    };
    PictureSimulation { common: noise, ..usual.with_board_and_lens(body, lens) }
}

/// Pose of the axes in which a board has its points, in the axes of its drawing, whose y is downwards from the first corner: Kalibr's are upwards.
fn scene_from_board(layout: &BoardLayout) -> Pose {
    let drawn = |id: usize| {
        let at = layout.corner(id);
        [at.x - 1.0, at.y - 1.0].map(|it| it * layout.square_m)
    };
    let points = layout.points();
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return Pose::identity() };
    let end = drawn(points.len() - 1);
    let is_upwards = (last.place_m[1] - first.place_m[1]) * (end[1] - drawn(0)[1]) < 0.0;
    let turn = rotation::about(0, if is_upwards { std::f64::consts::PI } else { 0.0 });
    let shifted = |[x, y]: [f64; 2]| Pose::new(rotation::about(0, 0.0), [x, y, 0.0].into());
    shifted(drawn(0)) * Pose::new(turn, [0.0; 3].into()) * shifted(first.place_m.map(|it| -it))
}

/// A picture of the board in a pose in the camera's frame.
fn picture((layout, lens): (&BoardLayout, &Lens), pose: &Pose, seed: u64) -> poecal_detect::Result<Vec<u8>> {
    let mut random = RandomGenerator::new(seed);
    let size = SIZE_PX.map(|size| size as usize);
    let camera = RenderCamera { size, focal_px: lens.focal_px, centre_px: lens.centre_px, distortion: [K1, 0.0] };
    let background = clutter(size, &mut random);
    let scene = RenderScene {
        camera,
        rotation: pose.rotation,
        translation_m: pose.translation,
        levels: LEVELS,
        gradient: [random.draw_uniform(-0.1, 0.1), random.draw_uniform(-0.1, 0.1)],
        blur_px: BLUR_PX,
        noise: NOISE,
        patch: None,
    };
    png(&scene.render(layout, &background, &mut random))
}
