//! Proof that two robots are the same: forward kinematics compared on random configurations.

use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use crate::lie::rotation;
use crate::robot::Robot;
use crate::simulate::Configurations;

/// Largest difference of two robots' tip poses.
///
/// ```
/// let none = poecal::io::Difference { position_m: 0.0, rotation_rad: 0.0 };
/// assert!(none.is_within(1e-12, 1e-12));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Of the tip's place, metres.
    pub position_m: f64,
    /// Of the tip's orientation, radians.
    pub rotation_rad: f64,
}

impl Difference {
    /// Compares forward kinematics on `count` random configurations within the first robot's limits.
    #[must_use]
    pub fn of(robot: &Robot, other: &Robot, count: usize) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(1);
        let mut largest = Difference { position_m: 0.0, rotation_rad: 0.0 };
        let configurations = Configurations::new(robot);
        let readings: Vec<Vec<f64>> = (0..count).map(|_| configurations.random(&mut generator)).collect();
        let first = robot.forward_kinematics_of(readings.iter().map(Vec::as_slice));
        for (a, b) in first.zip(other.forward_kinematics_of(readings.iter().map(Vec::as_slice))) {
            largest.position_m = larger(largest.position_m, (a.translation - b.translation).norm());
            let turn = rotation::log(&(a.rotation.transpose() * b.rotation)).norm();
            largest.rotation_rad = larger(largest.rotation_rad, turn);
        }
        largest
    }

    /// Whether neither exceeds its bound; not a number exceeds any.
    #[must_use]
    pub fn is_within(&self, position_m: f64, rotation_rad: f64) -> bool {
        self.position_m <= position_m && self.rotation_rad <= rotation_rad
    }
}

/// The larger number, or NaN if either is: a difference that is no number must not pass.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}
