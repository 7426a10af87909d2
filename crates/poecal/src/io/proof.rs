//! Comparison of two robots' forward kinematics on random configurations.

use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use crate::lie::{Pose, rotation};
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
    /// Of the tip's position, metres.
    pub position_m: f64,
    /// Of the tip's orientation, radians.
    pub rotation_rad: f64,
}

impl Difference {
    /// Compares forward kinematics on `count` random configurations within the first robot's limits.
    #[must_use]
    pub fn of(robot: &Robot, other: &Robot, count: usize) -> Self {
        Reference::new(robot, count).difference(other)
    }

    /// Whether neither exceeds its bound; NaN does.
    #[must_use]
    pub fn is_within(&self, position_m: f64, rotation_rad: f64) -> bool {
        self.position_m <= position_m && self.rotation_rad <= rotation_rad
    }
}

/// A robot's tip poses on random configurations, for comparison with any number of robots.
pub(super) struct Reference<'a> {
    robot: &'a Robot,
    /// Readings of all configurations.
    readings: Vec<f64>,
    poses: Vec<Pose>,
}

impl<'a> Reference<'a> {
    /// On `count` random configurations within the robot's limits.
    pub(super) fn new(robot: &'a Robot, count: usize) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(1);
        let random = Configurations::new(robot);
        let mut readings = Vec::new();
        (0..count).for_each(|_| readings.extend(random.random(&mut generator)));
        let poses = robot.forward_kinematics_of(&readings).collect();
        Reference { robot, readings, poses }
    }

    /// Whether they are of this very robot.
    pub(super) fn is_of(&self, robot: &Robot) -> bool {
        std::ptr::eq(self.robot, robot)
    }

    /// Largest difference of the other robot's tip poses from these.
    pub(super) fn difference(&self, other: &Robot) -> Difference {
        let mut largest = Difference { position_m: 0.0, rotation_rad: 0.0 };
        let poses = other.forward_kinematics_of(&self.readings);
        for (a, b) in self.poses.iter().zip(poses) {
            largest.position_m = larger(largest.position_m, (a.translation - b.translation).norm());
            let turn = rotation::log(&(a.rotation.transpose() * b.rotation)).norm();
            largest.rotation_rad = larger(largest.rotation_rad, turn);
        }
        largest
    }
}

/// The larger number, or NaN if either is NaN.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}
