//! `cargo bench -p poecal`: the solve of the paper's elbow from its nominal screws, and the whole calibration, by number of rows.
//!
//! The workload: each axis of the elbow moved by 1° and 2 mm, random configurations within its limits, noise 0.05 mm and
//! 0.0005 rad, measurements in the base frame.

#![allow(clippy::expect_used, reason = "a benchmark may end in a panic")]

use divan::{Bencher, black_box};
use poecal::calibration::{CalibrationOptions, DeviceFrameKnowledge, calibrate, delivered, fit_screws};
use poecal::estimate::Packed;
use poecal::measurement::Noise;
use poecal::simulate::{Kind, Simulated, Simulation, elbow};

fn main() {
    divan::main();
}

const ROWS: [usize; 4] = [50, 500, 5_000, 50_000];
const NOISE: Noise = Noise { position_m: 5e-5, rotation_rad: 5e-4 };

fn session(count: usize, kind: Kind) -> Simulated {
    Simulation {
        count,
        noise_position_m: NOISE.position_m,
        noise_rotation_rad: NOISE.rotation_rad,
        device_anywhere: false,
        ..Simulation::default()
    }
    .run(&elbow(), kind)
    .expect("a simulation of a finite robot")
}

/// Packing and Levenberg-Marquardt to convergence from nominal screws, device at the base, noise known.
fn solve(bencher: Bencher<'_, '_>, rows: usize, kind: Kind) {
    let made = session(rows, kind);
    let start = delivered(&made.nominal, &made.data);
    let all: Vec<u32> = (0..rows as u32).collect();
    let options = CalibrationOptions::default();
    bencher.bench_local(|| {
        let packed = Packed::new(&made.nominal, made.data.all_readings(), 6);
        let length_m = made.nominal.reach_m() / 3.0;
        black_box(fit_screws(&made.data, &packed, &all, start.clone(), NOISE, length_m, &options))
    });
}

#[divan::bench(args = ROWS)]
fn solve_poses(bencher: Bencher<'_, '_>, rows: usize) {
    solve(bencher, rows, Kind::Pose);
}

#[divan::bench(args = ROWS)]
fn solve_points(bencher: Bencher<'_, '_>, rows: usize) {
    solve(bencher, rows, Kind::Point);
}

/// Everything `calibrate` does: starts, noise estimation, fit, gauge, rank, accuracy; device frame unknown, nothing held out.
#[divan::bench(args = ROWS)]
fn calibrate_poses(bencher: Bencher<'_, '_>, rows: usize) {
    let made = session(rows, Kind::Pose);
    let options =
        CalibrationOptions { held_out: 0.0, frame: DeviceFrameKnowledge::Unknown, ..Default::default() };
    bencher.bench_local(|| black_box(calibrate(&made.nominal, &made.data, &options)));
}
