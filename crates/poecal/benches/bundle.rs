//! One bundle of pictures, for `benches/peers/bundle`: `bundle PROBLEM.txt PICTURES [known]`. It writes a session with this number of pictures of 40
//! corners by an arm of seven joints, with lens and points of the board unknown (or known), and prints the CPU time of its fit from the nominal arm.
//! The pictures have no errors except the corners' noise of 0.3 px. Metres, radians and pixels.

#![allow(clippy::print_stdout, reason = "what it finds is for a program that reads it")]

use std::fmt::Write as _;
use std::time::Instant;

use cpu_time::ProcessTime;
use nalgebra::DVector;
use poecal_arm::lie::Pose;
use poecal_fit::parameters::{DeviceFrame, Parameter, TargetFrame, screw_axes};
use poecal_fit::problem::{Bundle, BundleOptimum};
use poecal_fit::state::{Estimate, PackedValues, Session};
use poecal_model::camera::{Board, CommonError, Distortion, Lens, PictureUnknown, PictureUnknowns};
use poecal_model::robot::{JointKind, Robot};
use poecal_model::simulate::{PictureSimulation, SimulatedPictures, Simulation, random_chain};

/// Seconds for which fits are repeated.
const LONG_ENOUGH: f64 = 0.5;
/// Distortion of the lens, and ratio of the initial to the true focal length.
const DISTORTION: [f64; 8] = [-0.1, 0.02, 1e-4, 1e-4, 1e-3, 0.0, 0.0, 0.0];
const FOCAL_OFF: f64 = 1.005;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|it| it != "--bench").collect();
    let [path, pictures, rest @ ..] = &arguments[..] else {
        return Err("expected PROBLEM.txt PICTURES [known]".into());
    };
    let is_free = rest.is_empty();
    // The first random arm all of whose joints turn.
    let turns = |it: &Robot| it.joints.iter().all(|joint| joint.kind == JointKind::Revolute);
    let robot = (1..100).map(|seed| random_chain(7, seed)).find(turns).ok_or("found no arm")?;
    let made = session(&robot, pictures.parse()?, is_free)?;
    let start = start(&robot, &made);
    let packed = PackedValues::from_dataset(&robot, &made.data);
    let session = Session::new(&robot, &made.data, &packed, true);
    let rows = made.data.all_rows();
    let both = [PictureUnknown::Lens(0), PictureUnknown::Markers(0)];
    let pictures = &made.data.pictures;
    let unknowns = PictureUnknowns::new(&pictures.cameras, &pictures.boards, if is_free { &both } else { &[] });
    let count = unknowns.count();
    std::fs::write(path, problem(&robot, &made, &start, &unknowns))?;
    let fit = || -> Option<BundleOptimum> {
        let free = free_parameters(&start);
        let bundle = Bundle::new(session, &rows, free, unknowns.clone())?;
        Some(bundle.with_common(CommonError::NONE).solve(&start, &DVector::zeros(count)))
    };
    let (mut times, begin) = (Vec::new(), Instant::now());
    let mut found = None;
    while times.len() < 3 || begin.elapsed().as_secs_f64() < LONG_ENOUGH {
        let begin = ProcessTime::now();
        found = fit();
        times.push(begin.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_unstable_by(f64::total_cmp);
    let BundleOptimum { cost, passes, .. } = found.ok_or("found no bundle")?;
    println!("{{\"cpu_ms\": {}, \"passes\": {passes}, \"cost\": {cost}}}", times[times.len() / 2]);
    Ok(())
}

fn session(robot: &Robot, count: usize, is_free: bool) -> poecal_numerics::error::Result<SimulatedPictures> {
    let session = Simulation { count, error_rotation_rad: 2e-3, error_position_m: 1e-3, ..Simulation::default() };
    let usual = PictureSimulation::with_usual_camera(session, true);
    let lens = Lens { distortion: Distortion::Brown(DISTORTION), ..usual.lens };
    let board = Board::chessboard("board", [9, 6], 0.03).unwrap_or_default();
    let mut made = PictureSimulation { lens, board, ..usual }.run(robot)?;
    made.data.pictures.sigma_px = 0.3;
    if is_free {
        let lens = &mut made.data.pictures.cameras[0].lens;
        lens.focal_px = lens.focal_px.map(|it| it * FOCAL_OFF);
    }
    // The camera is on the tip, so it is the target, and the board observes it.
    for picture in &mut made.data.pictures.all {
        picture.of_camera = true;
        picture.corners.iter_mut().for_each(|corner| corner.weight = 1.0);
    }
    Ok(made)
}

/// The nominal arm with camera and board displaced by some millimetres.
fn start(robot: &Robot, made: &SimulatedPictures) -> Estimate {
    let off = Pose::from_xyz_rpy([2e-3, -1e-3, 1e-3], [2e-3, 1e-3, -2e-3]);
    let camera = robot.home * made.tip_from_held * off;
    Estimate::new(robot, vec![camera], made.base_from_other.inverse() * off)
}

/// All unknowns: camera, board and axes.
fn free_parameters(start: &Estimate) -> Vec<Parameter> {
    let frames = [
        Parameter::DeviceFrame(DeviceFrame::new(0, start.device_from_base.translation)),
        Parameter::TargetFrame(TargetFrame::new(0)),
    ];
    frames.into_iter().chain(screw_axes(start.kinds())).collect()
}

/// Input of the other program, as plain numbers: axes at zero (two directions across it, direction, point), `board_from_base` and `base_from_camera`,
/// lens with its priors (0 if known), points with their prior, noise, and readings and pixels of each picture.
fn problem(robot: &Robot, made: &SimulatedPictures, start: &Estimate, numbers: &PictureUnknowns) -> String {
    let data = &made.data;
    let (lens, board) = (&data.pictures.cameras[0].lens, &data.pictures.boards[0]);
    let mut text = String::new();
    let mut line = |values: &[f64]| {
        let words: Vec<String> = values.iter().map(f64::to_string).collect();
        let _ = writeln!(text, "{}", words.join(" "));
    };
    let rows_of = |pose: &Pose| -> Vec<f64> {
        (0..3)
            .flat_map(|i| [0, 1, 2, 3].map(|j| if j < 3 { pose.rotation[(i, j)] } else { pose.translation[i] }))
            .collect()
    };
    let counts = [robot.joints.len(), board.points.len(), data.len()];
    line(&counts.map(|it| it as f64));
    start.base_from_axis.iter().for_each(|axis| line(&rows_of(axis)));
    line(&rows_of(&start.device_from_base));
    line(&rows_of(&start.base_from_target[0]));
    line(&lens.numbers()[..9]);
    let found = numbers.numbers(&DVector::zeros(numbers.count()), &[]);
    let prior = |name: &str| found.iter().find(|it| it.name.ends_with(name)).map_or(0.0, |it| it.prior);
    line(&["fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"].map(|name| prior(&format!(".{name}"))));
    board.points.iter().for_each(|point| line(&[point.x, point.y, point.z]));
    line(&[1e-3 * prior(".x"), data.pictures.sigma_px]);
    for picture in &data.pictures.all {
        line(data.readings(picture.row as usize));
        line(&picture.corners.iter().flat_map(|it| [it.pixel.x, it.pixel.y]).collect::<Vec<f64>>());
    }
    text
}
