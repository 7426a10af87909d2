//! Sessions, fits and robots that many tests need.

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Screw, Twist};
#[cfg(feature = "calibrate")]
use poecal_calibrate::{Calibration, CalibrationOptions, Corrections, calibrate};
#[cfg(feature = "calibrate")]
use poecal_model::measurement::Dataset;
use poecal_model::robot::{Joint, JointLimits, Robot};
use poecal_model::simulate::{SessionKind, Simulation, SimulationResult, elbow, random};
use rand_chacha::ChaCha8Rng;

/// A usual session of a robot.
pub fn simulate_session(robot: &Robot, kind: SessionKind, count: usize, seed: u64) -> SimulationResult {
    Simulation { count, seed, ..Simulation::default() }.run(robot, kind).unwrap()
}

/// A calibration with default options.
#[cfg(feature = "calibrate")]
pub fn calibrate_session(robot: &Robot, data: &Dataset) -> Calibration {
    calibrate(robot, data, &geometry()).unwrap()
}

/// Runs a closure in a pool of this number of threads.
pub fn with_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run)
}

/// The elbow of `simulate` without limits.
#[must_use]
pub fn unlimited_elbow() -> Robot {
    let mut robot = elbow();
    robot.joints.iter_mut().for_each(|joint| joint.limits = None);
    robot
}

/// `a` turns by half a turn in either direction, `lift` slides up to 0.5 m, `b` turns without limits; the tip is 1 m out.
pub fn lifting_robot() -> Robot {
    let z = Vector3::z();
    let a = Joint::revolute("a", Screw::revolute(&z, &Vector3::zeros()));
    let lift = Joint::prismatic("lift", Screw::prismatic(&z));
    let b = Joint::revolute("b", Screw::revolute(&z, &Vector3::new(0.5, 0.0, 0.0)));
    let joints = vec![
        Joint { limits: Some(JointLimits { lower: -3.15, upper: 3.15 }), ..a },
        Joint { limits: Some(JointLimits { lower: 0.0, upper: 0.5 }), ..lift },
        b,
    ];
    Robot::new("test", joints, Pose::from_translation(Vector3::new(1.0, 0.0, 0.3))).unwrap()
}

/// A small random twist: rotation by `angle_rad` and shift by `distance_m` in random directions.
pub fn random_twist(angle_rad: f64, distance_m: f64, generator: &mut ChaCha8Rng) -> Twist {
    Twist::new(random::direction(generator) * distance_m, random::direction(generator) * angle_rad)
}

/// The usual options for geometry alone, without the corrected model: for tests that fit very many robots, and are about these fits.
#[cfg(feature = "calibrate")]
pub fn geometry() -> CalibrationOptions {
    CalibrationOptions { corrections: Corrections::Off, ..CalibrationOptions::default() }
}
