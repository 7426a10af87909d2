//! Comparison of two robots' forward kinematics on random configurations.

use std::borrow::Cow;

use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use poecal_arm::lie::{Pose, rotation};
use poecal_model::robot::Robot;
use poecal_model::simulate::Configurations;

/// Largest difference of two robots' poses: of the tip, and of instruments and targets with a body of their own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Difference of the position, metres.
    pub position_m: f64,
    /// Difference of the orientation, radians.
    pub rotation_rad: f64,
}

impl Difference {
    /// Compares forward kinematics, of instruments and targets by their names, on `count` random configurations within the first robot's limits.
    #[must_use]
    pub fn from_robots(robot: &Robot, other: &Robot, count: usize) -> Self {
        ReferencePoses::new(robot, count).difference(other)
    }

    /// True if neither exceeds its bound; NaN does.
    #[must_use]
    pub fn is_within(&self, position_m: f64, rotation_rad: f64) -> bool {
        self.position_m <= position_m && self.rotation_rad <= rotation_rad
    }
}

/// A robot's poses on random configurations, for comparison with any number of robots.
pub struct ReferencePoses<'a> {
    robot: &'a Robot,
    /// Readings of all configurations.
    readings: Vec<f64>,
    /// Poses of the tip, then of instruments and targets.
    poses: Vec<Vec<Pose>>,
}

impl<'a> ReferencePoses<'a> {
    /// The poses on `count` random configurations within the robot's limits.
    pub fn new(robot: &'a Robot, count: usize) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(1);
        let random = Configurations::new(robot);
        let mut readings = Vec::new();
        (0..count).for_each(|_| readings.extend(random.random(&mut generator)));
        let mounts = robot.instruments.iter().chain(&robot.mounted);
        let tip = robot.forward_kinematics_of(&readings).collect();
        let further = mounts.map(|mount| robot.with_tip_at(mount).forward_kinematics_of(&readings).collect());
        let poses = std::iter::once(tip).chain(further).collect();
        ReferencePoses { robot, readings, poses }
    }

    /// True if they are of this very robot.
    pub fn is_of(&self, robot: &Robot) -> bool {
        std::ptr::eq(self.robot, robot)
    }

    /// Largest difference of the other robot's poses from these; not a number if it lacks a joint, an instrument or a target.
    pub fn difference(&self, other: &Robot) -> Difference {
        let none = Difference { position_m: f64::NAN, rotation_rad: f64::NAN };
        let Some(readings) = self.readings_of(other) else { return none };
        let mut largest = Difference { position_m: 0.0, rotation_rad: 0.0 };
        let mut compare = |poses: &[Pose], other: &Robot| {
            for (a, b) in poses.iter().zip(other.forward_kinematics_of(&readings)) {
                largest.position_m = larger_or_nan(largest.position_m, (a.translation - b.translation).norm());
                let turn = rotation::log(&(a.rotation.transpose() * b.rotation)).norm();
                largest.rotation_rad = larger_or_nan(largest.rotation_rad, turn);
            }
        };
        let mut poses = self.poses.iter();
        if let Some(tip) = poses.next() {
            compare(tip, other);
        }
        for (mounts, others) in [(&self.robot.instruments, &other.instruments), (&self.robot.mounted, &other.mounted)] {
            for mount in mounts {
                let Some(found) = others.iter().find(|other| other.name == mount.name) else { return none };
                if let Some(poses) = poses.next() {
                    compare(poses, &other.with_tip_at(found));
                }
            }
        }
        largest
    }

    /// The readings in the other robot's order, by their names; `None` if it has others.
    fn readings_of(&self, other: &Robot) -> Option<Cow<'_, [f64]>> {
        let (ours, theirs) = (self.robot.reading_names(), other.reading_names());
        if ours == theirs || self.robot.is_serial() && ours.len() == theirs.len() {
            return Some(Cow::Borrowed(&self.readings));
        }
        let at = |name: &String| ours.iter().position(|own| own == name);
        let places = theirs.iter().map(at).collect::<Option<Vec<usize>>>()?;
        // Readings that a robot without factors lacks are 0 here.
        if places.len() < self.robot.joint_reading_names().len() {
            return None;
        }
        let rows = self.readings.chunks_exact(ours.len().max(1));
        let sorted = rows.flat_map(|row| places.iter().filter_map(|&place| row.get(place).copied()));
        Some(Cow::Owned(sorted.collect()))
    }
}

/// The larger number, or NaN if either is NaN.
fn larger_or_nan(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}
