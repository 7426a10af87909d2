//! Grossly wrong rows: what they do to a fit, whether they are found, and that clean data are left alone.

use nalgebra::Vector3;
use poecal::calibration::{Calibration, CalibrationOptions, Loss, Robust, calibrate, row_errors};
use poecal::estimate::Packed;
use poecal::lie::{Pose, rotation};
use poecal::measurement::{Dataset, Measurement, PointMeasurement, PoseMeasurement};
use poecal::robot::Robot;
use poecal::simulate::{Kind, Simulated, Simulation, elbow, gantry, random, scara, seven_axis};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

/// A session with a share of its rows made grossly wrong.
struct Session {
    simulation: Simulation,
    kind: Kind,
    made: Simulated,
    spoilt: Dataset,
    gross: Vec<bool>,
}

fn session(robot: &Robot, kind: Kind, count: usize, share: f64, seed: u64) -> Session {
    let simulation = Simulation { count, seed, ..Simulation::default() };
    let made = simulation.run(robot, kind).expect("a finite robot");
    let mut generator = ChaCha8Rng::seed_from_u64(seed ^ 0x6055);
    let mut order: Vec<usize> = (0..count).collect();
    random::shuffle(&mut generator, &mut order);
    let mut gross = vec![false; count];
    let mut spoilt = made.data.clone();
    for (k, &row) in order.iter().take((share * count as f64).round() as usize).enumerate() {
        gross[row] = true;
        let measurement = &mut spoilt.observations[row].measurement;
        *measurement = spoil(measurement, k % 2 == 0, &mut generator);
    }
    Session { simulation, kind, made, spoilt, gross }
}

/// 5 to 100 mm off in any direction, and turned by 1° to 20°.
fn spoil(measurement: &Measurement, turned: bool, generator: &mut ChaCha8Rng) -> Measurement {
    let shift: Vector3<f64> = random::direction(generator) * (5e-3 + 95e-3 * random::uniform(generator));
    let turn = random::direction(generator) * (1.0 + 19.0 * random::uniform(generator)).to_radians();
    let seen = measurement.pose();
    let position = seen.translation + shift;
    if measurement.sees_orientation() {
        let turn = if turned { rotation::exp(&turn) } else { nalgebra::Matrix3::identity() };
        Measurement::Pose(PoseMeasurement { pose: Pose::new(turn * seen.rotation, position) })
    } else {
        Measurement::Point(PointMeasurement { position })
    }
}

fn options(robust: Robust) -> CalibrationOptions {
    CalibrationOptions { held_out: 0.0, robust, ..Default::default() }
}

/// Root mean square position error on 200 configurations free of noise.
fn truth_error_m(session: &Session, found: &Calibration) -> f64 {
    let held_out = session.simulation.held_out(&session.made, session.kind, 200).expect("a finite robot");
    let packed = Packed::new(&found.nominal, held_out.all_readings(), held_out.reading_names().len());
    let rows: Vec<u32> = (0..200).collect();
    let errors = row_errors(&held_out, &packed, &rows, &found.models.calibrated);
    (errors.iter().map(|e| e.position_m.norm_squared()).sum::<f64>() / 200.0).sqrt()
}

#[derive(Default, Debug, Clone, Copy)]
struct Tally {
    sessions: usize,
    clean_squares: f64,
    spoilt_squares: f64,
    worst: f64,
    gross: usize,
    found: usize,
    clean: usize,
    false_alarms: usize,
    missed_auto: usize,
}

fn run(
    robots: &[(&str, Robot)],
    share: f64,
    seeds: std::ops::Range<u64>,
    robust: Robust,
) -> Vec<(String, Tally)> {
    let mut out = vec![];
    for (name, robot) in robots {
        for kind in [Kind::Pose, Kind::Point] {
            let mut t = Tally::default();
            for seed in seeds.clone() {
                let count = 100 + 50 * (seed as usize % 3);
                let s = session(robot, kind, count, share, seed);
                let clean = calibrate(robot, &s.made.data, &options(Robust::Off)).expect("fits");
                let spoilt = calibrate(robot, &s.spoilt, &options(robust)).expect("fits");
                let (a, b) = (truth_error_m(&s, &clean), truth_error_m(&s, &spoilt));
                t.sessions += 1;
                t.clean_squares += a * a;
                t.spoilt_squares += b * b;
                t.worst = t.worst.max(b / a);
                t.missed_auto += usize::from(share > 0.0 && spoilt.robustness.loss.is_none());
                for (row, &gross) in s.gross.iter().enumerate() {
                    let suspected = spoilt.robustness.rows[row].suspected;
                    t.gross += usize::from(gross);
                    t.clean += usize::from(!gross);
                    t.found += usize::from(gross && suspected);
                    t.false_alarms += usize::from(!gross && suspected);
                }
            }
            out.push((format!("{name} {}", kind.word()), t));
        }
    }
    out
}

fn robots() -> Vec<(&'static str, Robot)> {
    vec![("elbow", elbow()), ("scara", scara()), ("seven_axis", seven_axis()), ("gantry", gantry())]
}

#[test]
fn explore() {
    for share in [0.0, 0.1, 0.3, 0.4] {
        let start = std::time::Instant::now();
        for (name, t) in run(&robots(), share, 0..12, Robust::Auto) {
            println!(
                "{share} {name}: ratio {:.3} worst {:.2} found {}/{} false {}/{} missed {}",
                (t.spoilt_squares / t.clean_squares).sqrt(),
                t.worst,
                t.found,
                t.gross,
                t.false_alarms,
                t.clean,
                t.missed_auto
            );
        }
        println!("{:?}", start.elapsed());
    }
}
