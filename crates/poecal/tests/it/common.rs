//! What many tests need: sessions, fits and robots.

use nalgebra::Vector3;
use poecal::calibration::{Calibration, CalibrationOptions, Corrections, calibrate};
use poecal::lie::{Pose, Screw, Twist};
use poecal::measurement::Dataset;
use poecal::robot::{Joint, Limits, Robot};
use poecal::simulate::{Kind, Simulated, Simulation, random};
use rand_chacha::ChaCha8Rng;

/// A usual session of a robot.
pub(crate) fn simulated(robot: &Robot, kind: Kind, count: usize, seed: u64) -> Simulated {
    Simulation { count, seed, ..Simulation::default() }.run(robot, kind).unwrap()
}

/// A calibration as it is done without options.
pub(crate) fn calibrated(robot: &Robot, data: &Dataset) -> Calibration {
    calibrate(robot, data, &geometry()).unwrap()
}

pub(crate) fn with_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run)
}

/// `a` turns by half a turn either way, `lift` slides up to 0.5 m, `b` turns without limits; the tip is 1 m out.
pub(crate) fn lifting_robot() -> Robot {
    let z = Vector3::z();
    let a = Joint::revolute("a", Screw::revolute(&z, &Vector3::zeros()));
    let lift = Joint::prismatic("lift", Screw::prismatic(&z));
    let b = Joint::revolute("b", Screw::revolute(&z, &Vector3::new(0.5, 0.0, 0.0)));
    let joints = vec![
        Joint { limits: Some(Limits { lower: -3.15, upper: 3.15 }), ..a },
        Joint { limits: Some(Limits { lower: 0.0, upper: 0.5 }), ..lift },
        b,
    ];
    Robot::new("test", joints, Pose::from_translation(Vector3::new(1.0, 0.0, 0.3))).unwrap()
}

/// A small random twist: rotation by `angle_rad` and shift by `distance_m` in random directions.
pub(crate) fn random_twist(angle_rad: f64, distance_m: f64, generator: &mut ChaCha8Rng) -> Twist {
    Twist::new(random::direction(generator) * distance_m, random::direction(generator) * angle_rad)
}

/// The usual options for geometry alone, without the corrected model: for tests that fit very many robots, and are about these fits.
pub(crate) fn geometry() -> CalibrationOptions {
    CalibrationOptions { corrections: Corrections::Off, ..CalibrationOptions::default() }
}
