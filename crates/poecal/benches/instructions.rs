//! Fits of the paper's elbow to poses and nothing else: `ROWS [REPEATS [poses|points [alone]]]`, with the prior of every fit unless it is `alone`.
//! Run once for `scripts/count-instructions`; repeated, it prints the median and the least CPU time in milliseconds (packing included) for
//! `scripts/plot-cost`.

#![allow(
    clippy::expect_used,
    clippy::print_stdout,
    reason = "a benchmark may end in a panic, and prints what it measured"
)]

use cpu_time::ProcessTime;
use poecal_calibrate::{CalibrationOptions, fit_screws, nominal_estimate};
use poecal_fit::problem::Prior;
use poecal_fit::state::{PackedValues, Session};
use poecal_model::measurement::Noise;
use poecal_model::robot::Tolerance;
use poecal_model::simulate::{SessionKind, Simulation, elbow};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|it| !it.starts_with("--")).collect();
    let number = |at: usize| arguments.get(at).and_then(|text| text.parse::<usize>().ok());
    let (rows, repeats) = (number(0).unwrap_or(500), number(1).unwrap_or(0));
    let kind =
        if arguments.get(2).is_some_and(|word| word == "points") { SessionKind::POINT } else { SessionKind::POSE };
    let is_alone = arguments.get(3).is_some_and(|word| word == "alone");
    let (noise_position_m, noise_rotation_rad) = (5e-5, 5e-4);
    let noise = Noise::new(noise_position_m, noise_rotation_rad);
    let simulation = Simulation {
        count: rows,
        noise_position_m,
        noise_rotation_rad,
        device_anywhere: false,
        ..Simulation::default()
    };
    let made = simulation.run(&elbow(), kind).expect("a simulation of a finite robot");
    let all = made.data.all_rows();
    let options = CalibrationOptions::default();
    let prior = {
        let packed = PackedValues::new(&made.nominal, made.data.all_readings(), 6);
        Prior::from_session(&Session::new(&made.nominal, &made.data, &packed, false), Tolerance::default())
    };
    let prior = (!is_alone).then_some((&prior, 1.0));
    let fit = || {
        let packed = PackedValues::new(&made.nominal, made.data.all_readings(), 6);
        let session = Session::new(&made.nominal, &made.data, &packed, false);
        let session = session.with_length(made.nominal.reach_m() / 3.0);
        let start = nominal_estimate(&made.nominal, &made.data);
        std::hint::black_box(fit_screws(session, &all, start, noise, prior, &options));
    };
    if repeats == 0 {
        return fit();
    }
    let mut times: Vec<f64> = (0..repeats)
        .map(|_| {
            let begin = ProcessTime::now();
            fit();
            begin.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!("{{\"rows\": {rows}, \"cpu_ms\": {}, \"least_ms\": {}}}", times[repeats / 2], times[0]);
}
