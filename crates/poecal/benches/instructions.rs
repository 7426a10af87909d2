//! One fit of the paper's elbow and nothing else, for `scripts/count-instructions`: the number of rows is the first argument.

#![allow(clippy::expect_used, reason = "a benchmark may end in a panic")]

use poecal::calibration::{CalibrationOptions, delivered, fit_screws};
use poecal::estimate::Packed;
use poecal::measurement::Noise;
use poecal::simulate::{Kind, Simulation, elbow};

fn main() {
    let rows = std::env::args().nth(1).and_then(|rows| rows.parse().ok()).unwrap_or(500);
    let noise = Noise { position_m: 5e-5, rotation_rad: 5e-4 };
    let simulation = Simulation {
        count: rows,
        noise_position_m: noise.position_m,
        noise_rotation_rad: noise.rotation_rad,
        device_anywhere: false,
        ..Simulation::default()
    };
    let made = simulation.run(&elbow(), Kind::Pose).expect("a simulation of a finite robot");
    let packed = Packed::new(&made.nominal, made.data.all_readings(), 6);
    let all: Vec<u32> = (0..rows as u32).collect();
    let (start, length_m) = (delivered(&made.nominal, &made.data), made.nominal.reach_m() / 3.0);
    let options = CalibrationOptions::default();
    std::hint::black_box(fit_screws(&made.data, &packed, &all, start, noise, length_m, &options));
}
