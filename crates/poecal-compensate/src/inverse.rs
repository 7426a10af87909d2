//! Inverse kinematics of a robot's tip.

use super::{REACHED, Reach};
use poecal_arm::lie::Pose;
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;
use poecal_numerics::threads::concat_chunks;

/// Poses that a thread processes at a time. Each search is independent.
const SOME: usize = 64;

/// Inverse kinematics of a robot's tip, with terms of its joints at stated values of its factors.
#[derive(Clone, Debug)]
pub struct Inverse {
    arm: Reach,
    readings: Vec<usize>,
    /// Number of the robot's joint readings.
    count: usize,
}

impl Inverse {
    /// Inverse kinematics of a robot, at these values of its factors.
    ///
    /// # Errors
    /// Those of [`Robot::arm`].
    pub fn new(robot: &Robot, factors: &[f64]) -> Result<Self> {
        let (arm, readings) = robot.arm(factors)?;
        Ok(Inverse { arm: Reach::new(arm), readings, count: robot.joint_reading_names().len() })
    }

    /// True if all branches can be found: for six turning joints, each with a reading of its own.
    #[must_use]
    pub fn has_branches(&self) -> bool {
        self.arm.branches().is_some()
    }

    /// The configuration nearest to `near` (rad, m, in the order of [`Robot::reading_names`]) that has the tip at a pose of the base; on request
    /// within limits. `None` if there is none.
    #[must_use]
    pub fn solve_nearest(&self, target: &Pose, near: &[f64], within_limits: bool) -> Option<Vec<f64>> {
        let mut q: Vec<f64> = self.readings.iter().map(|&at| near.get(at).copied().unwrap_or(0.0)).collect();
        let start = q.clone();
        self.arm.solve_nearest(target, &mut q);
        if within_limits && !self.is_within(&q) {
            if let Ok(start) = <&[f64; 7]>::try_from(&start[..]) {
                q.copy_from_slice(
                    &self.arm.branches_with_held(self.arm.best_held_joint()?)?.nearest_within_limits(target, start)?,
                );
            } else {
                let start: [f64; 6] = start[..].try_into().ok()?;
                q.copy_from_slice(self.arm.branches()?.within_limits(target, &start).as_slice().first()?);
            }
        }
        let is_reached = self.is_at(&q, target);
        is_reached.then(|| self.all(near, &q))
    }

    /// All configurations that have the tip at a pose, nearest to `near` first; on request within limits, else from -π to π.
    #[must_use]
    pub fn branches(&self, target: &Pose, near: &[f64], within_limits: bool) -> Vec<Vec<f64>> {
        let Some(branches) = self.arm.branches() else { return Vec::new() };
        let mut start = [0.0; 6];
        start.iter_mut().zip(&self.readings).for_each(|(to, &at)| *to = near.get(at).copied().unwrap_or(0.0));
        let found = if within_limits { branches.within_limits(target, &start) } else { branches.branches_at(target) };
        found.as_slice().iter().map(|q| self.all(near, q)).collect()
    }

    /// For an arm of seven turning joints, the index (in the order of [`Robot::reading_names`]) of the reading that is best held as redundancy angle:
    /// without its joint the arm is nearest to one with branches in closed form. `None` for other arms.
    #[must_use]
    pub fn redundant_joint(&self) -> Option<usize> {
        self.readings.get(self.arm.best_held_joint()?).copied()
    }

    /// All configurations of an arm of seven turning joints that have the tip at a pose with one reading held at a value (rad): its index, in the
    /// order of [`Robot::reading_names`], and the value. Nearest to `near` first; on request within limits. Empty for other arms.
    #[must_use]
    pub fn branches_held(
        &self,
        target: &Pose,
        (reading, value): (usize, f64),
        near: &[f64],
        within_limits: bool,
    ) -> Vec<Vec<f64>> {
        let joint = self.readings.iter().position(|it| *it == reading);
        let Some(held) = joint.and_then(|joint| self.arm.branches_with_held(joint)) else {
            return Vec::new();
        };
        let mut start = [0.0; 7];
        start.iter_mut().zip(&self.readings).for_each(|(to, &at)| *to = near.get(at).copied().unwrap_or(0.0));
        let found =
            if within_limits { held.within_limits(target, value, &start) } else { held.branches_at(target, value) };
        found.as_slice().iter().map(|q| self.all(near, q)).collect()
    }

    /// Results of `find` for each of many poses, whose index it receives too, by all threads, in their order.
    #[must_use]
    pub fn of_many<T: Send>(&self, targets: &[Pose], find: impl Fn(&Self, usize, &Pose) -> T + Sync + Send) -> Vec<T> {
        concat_chunks(targets, SOME, |index, some| {
            let each = some.iter().enumerate();
            each.map(|(row, target)| find(self, index * SOME + row, target)).collect()
        })
    }

    fn is_at(&self, q: &[f64], target: &Pose) -> bool {
        let (metres, radians) = self.arm.arm().forward_kinematics(q).distance_and_angle(target);
        metres <= REACHED && radians <= REACHED
    }

    fn is_within(&self, q: &[f64]) -> bool {
        q.iter().zip(self.arm.arm().limits()).all(|(q, (low, high))| (low - 1e-7..=high + 1e-7).contains(q))
    }

    /// All readings of the robot: those that do not move the tip keep their values.
    fn all(&self, near: &[f64], q: &[f64]) -> Vec<f64> {
        let mut all: Vec<f64> = (0..self.count).map(|at| near.get(at).copied().unwrap_or(0.0)).collect();
        for (&at, value) in self.readings.iter().zip(q) {
            if let Some(it) = all.get_mut(at) {
                *it = *value;
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::Inverse;
    use poecal_testing::sessions::unlimited_elbow as elbow;

    #[test]
    fn the_nearest_configuration_of_each_pose_is_found() {
        let robot = elbow();
        let inverse = Inverse::new(&robot, &[]).unwrap();
        let configurations = [[0.1, 0.2, 0.3, 0.4, 0.5, 0.6], [0.3; 6], [0.4; 6]];
        let targets = configurations.map(|q| robot.forward_kinematics(&q));
        let found = inverse.of_many(&targets, |inverse, _, target| inverse.solve_nearest(target, &[0.2; 6], true));
        assert_eq!(found.len(), 3);
        for (q, found) in configurations.iter().zip(found) {
            assert!(q.iter().zip(found.unwrap()).all(|(q, found)| (q - found).abs() < 1e-9));
        }
    }
}
