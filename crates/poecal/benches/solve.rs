//! `cargo bench -p poecal`: the solve of the paper's elbow from its nominal screws, and the whole calibration, by number of rows;
//! an arm of thirty joints; 1,000 fits of a Monte Carlo.
//!
//! The workload: each axis of the elbow moved by 1° and 2 mm, random configurations within its limits, noise 0.05 mm and
//! 0.0005 rad, measurements in the base frame.

#![allow(clippy::expect_used, reason = "a benchmark may end in a panic")]

mod trials;

use divan::{Bencher, black_box};
use poecal_arm::lie::Freedom;
use poecal_calibrate::{
    CalibrationOptions, Corrections, DeviceFrameKnowledge, Sizes, calibrate, fit_screws, nominal_estimate,
};
use poecal_fit::forensics::{self, diagnose};
use poecal_fit::parameters::{DeviceFrame, Parameter, TargetFrame, TargetPlace, screw_axes};
use poecal_fit::problem::{Problem, Refit};
use poecal_fit::state::{PackedValues, Session};
use poecal_model::measurement::{Measurement, Quantity};
use poecal_model::simulate::{SessionKind, Simulation, SimulationResult, elbow, random_chain};
use poecal_numerics::solve::{LeastSquares, Options, minimize};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;
use trials::{NOISE, disturb_measurements};

fn main() {
    divan::main();
}

const ROWS: [usize; 4] = [50, 500, 5_000, 50_000];

fn simulation(count: usize) -> Simulation {
    Simulation {
        count,
        noise_position_m: NOISE[Quantity::Position],
        noise_rotation_rad: NOISE[Quantity::Rotation],
        device_anywhere: false,
        ..Simulation::default()
    }
}

fn session(count: usize, kind: SessionKind) -> SimulationResult {
    simulation(count).run(&elbow(), kind).expect("a simulation of a finite robot")
}

/// Packing and Levenberg-Marquardt to convergence from nominal screws, device at the base, noise known.
fn solve(bencher: Bencher<'_, '_>, rows: usize, kind: SessionKind) {
    solve_session(bencher, &session(rows, kind));
}

fn solve_session(bencher: Bencher<'_, '_>, made: &SimulationResult) {
    let start = nominal_estimate(&made.nominal, &made.data);
    let all: Vec<u32> = (0..made.data.len() as u32).collect();
    let options = CalibrationOptions::default();
    bencher.bench_local(|| {
        let packed = PackedValues::from_dataset(&made.nominal, &made.data);
        let session = Session::new(&made.nominal, &made.data, &packed, false);
        let session = session.with_length(made.nominal.reach_m() / 3.0);
        black_box(fit_screws(session, &all, start.clone(), NOISE, None, &options))
    });
}

#[divan::bench(args = ROWS)]
fn solve_poses(bencher: Bencher<'_, '_>, rows: usize) {
    solve(bencher, rows, SessionKind::POSE);
}

#[divan::bench(args = ROWS)]
fn solve_points(bencher: Bencher<'_, '_>, rows: usize) {
    solve(bencher, rows, SessionKind::POINT);
}

/// Rows of a pass.
const PASS: usize = 5_000;

/// One pass over the rows: residuals, columns and their products, with axes, target and all device frames but the first unknown.
#[divan::bench(args = [SessionKind::POSE, SessionKind::POINT, SessionKind::DISTANCE, SessionKind::HEIGHT, SessionKind::PLANE, SessionKind::SOCKET])]
fn pass(bencher: Bencher<'_, '_>, kind: SessionKind) {
    let made = session(PASS, kind);
    let (data, rows) = (&made.data, made.data.all_rows());
    let packed = PackedValues::from_dataset(&made.nominal, data);
    let session = Session::new(&made.nominal, data, &packed, true);
    let session = session.with_length(made.nominal.reach_m() / 3.0);
    let start = nominal_estimate(&made.nominal, data);
    let mut free = screw_axes(start.kinds());
    free.extend((1..data.station_count()).map(|station| {
        Parameter::DeviceFrame(DeviceFrame::from_freedom(station, data.device_freedom(station, &rows)))
    }));
    free.push(if kind == SessionKind::POSE {
        Parameter::TargetFrame(TargetFrame { target: 0, freedom: Freedom::FRAME })
    } else {
        Parameter::TargetPlace(TargetPlace { target: 0 })
    });
    let problem = Problem::new(session, rows, free, NOISE);
    bencher.counter(divan::counter::ItemsCount::new(PASS)).bench_local(|| black_box(problem.normal(&start)));
}

/// The solve of an arm of thirty joints, one in four of which slides.
fn solve_thirty_joints(bencher: Bencher<'_, '_>, kind: SessionKind) {
    let made = simulation(5_000).run(&random_chain(30, 1), kind).expect("a simulation of a finite robot");
    solve_session(bencher, &made);
}

#[divan::bench]
fn solve_thirty_joints_poses(bencher: Bencher<'_, '_>) {
    solve_thirty_joints(bencher, SessionKind::POSE);
}

#[divan::bench]
fn solve_thirty_joints_points(bencher: Bencher<'_, '_>) {
    solve_thirty_joints(bencher, SessionKind::POINT);
}

/// 1,000 fits of 50 poses each: the same configurations, other noise. Packing, the first fit and the sharing of its factor included.
#[divan::bench]
fn monte_carlo(bencher: Bencher<'_, '_>) {
    let made = session(50, SessionKind::POSE);
    let start = nominal_estimate(&made.nominal, &made.data);
    let rows: Vec<u32> = (0..50).collect();
    let mut free = screw_axes(start.kinds());
    free.push(Parameter::TargetFrame(TargetFrame::new(0)));
    let mut generator = ChaCha8Rng::seed_from_u64(1);
    let trials: Vec<Vec<Measurement>> = (0..1_000).map(|_| disturb_measurements(&made.data, &mut generator)).collect();
    let length_m = made.nominal.reach_m() / 3.0;
    bencher.bench_local(|| {
        let packed = PackedValues::new(&made.nominal, made.data.all_readings(), 6);
        let session = Session::new(&made.nominal, &made.data, &packed, false).with_length(length_m);
        let problem = Problem::new(session, rows.clone(), free.clone(), NOISE);
        let (optimum, _, _) = minimize(&problem, start.clone(), &Options::default());
        let refit = Refit::new(problem, optimum, Options::default());
        refit.fit_all(&trials, |_, normal, _| normal.cost).iter().sum::<f64>()
    });
}

/// All steps of `calibrate` for geometry alone: starts, noise estimation, fit, gauge, rank, accuracy; device frame unknown, nothing held out.
#[divan::bench(args = ROWS)]
fn calibrate_poses(bencher: Bencher<'_, '_>, rows: usize) {
    bench_calibration(bencher, rows, Corrections::Off);
}

/// A calibration with the corrected model of a robot that sags.
#[divan::bench(args = ROWS)]
fn correct_poses(bencher: Bencher<'_, '_>, rows: usize) {
    bench_calibration(bencher, rows, Corrections::Auto);
}

fn bench_calibration(bencher: Bencher<'_, '_>, rows: usize, corrections: Corrections) {
    let terms = match "sag=1e-3,harmonics=1e-4".parse() {
        Ok(Corrections::Sizes(sizes)) => sizes,
        _ => Sizes::NONE,
    };
    let simulation = Simulation { terms, ..simulation(rows) };
    let made = simulation.run(&elbow(), SessionKind::POSE).expect("a simulation of a finite robot");
    let frame = DeviceFrameKnowledge::Unknown;
    let options = CalibrationOptions { held_out: Some(0.0), frame, corrections, ..Default::default() };
    bencher.bench_local(|| black_box(calibrate(&made.nominal, &made.data, &options)));
}

/// The diagnosis of a clean session must cost far less than a fit, since it follows every calibration.
#[divan::bench]
fn diagnose_what_is_clean(bencher: Bencher<'_, '_>) {
    let made = Simulation::default().run(&elbow(), SessionKind::POINT).expect("a simulation of a finite robot");
    let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default()).expect("a fit");
    let options = forensics::DiagnosisOptions {
        calibrated: Some(&calibration.models.calibrated),
        ..forensics::DiagnosisOptions::default()
    };
    let rows = made.data.all_rows();
    bencher.bench_local(|| black_box(diagnose(&made.nominal, &made.data, &rows, &options)));
}
