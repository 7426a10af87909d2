//! Poses, Jacobians and sag of a robot's tip in many configurations.

use poecal_arm::Arm;

use poecal_arm::lie::Pose;
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;
use poecal_numerics::kernels::by_best;
use poecal_numerics::threads::fill_chunks;

/// Configurations that a thread processes at a time. Each is computed independently, so that results do not depend on it.
const SOME: usize = 1024;

/// Pose of a robot's tip in many configurations, its Jacobian there, and its deflection by weights, with terms of its joints at stated values of its
/// factors. Eight configurations are computed side by side, and all threads share them; results have the same bits for any number of threads.
///
/// Configurations are passed one after the other, the readings of each (rad, m) in the order of [`Robot::reading_names`] without factors.
#[derive(Clone, Debug)]
pub struct Kinematics {
    arm: Arm,
    /// Index of each reading of the arm among the robot's.
    readings: Vec<usize>,
    /// Number of the robot's joint readings.
    count: usize,
}

impl Kinematics {
    /// Kinematics of a robot, at these values of its factors.
    ///
    /// # Errors
    /// Those of [`Robot::arm`].
    pub fn new(robot: &Robot, factors: &[f64]) -> Result<Self> {
        let (arm, readings) = robot.arm(factors)?;
        Ok(Kinematics { arm, readings, count: robot.joint_reading_names().len() })
    }

    /// `base_from_tip` in each configuration, theory.md §2 (6) and (7).
    #[must_use]
    pub fn forward_kinematics(&self, readings: &[f64]) -> Vec<Pose> {
        let mut tips = vec![Pose::identity(); self.rows(readings)];
        self.of_each(readings, &mut tips, 1, |own, tips| {
            by_best(
                #[inline(always)]
                || self.arm.forward_kinematics_of(own, tips),
            );
        });
        tips
    }

    /// Jacobian in each configuration by rows, six rows with one number per reading: the motion of the tip's point (m/rad, or m/m for a sliding
    /// joint) and its turn (rad/rad, or rad/m), in the base; the contribution of weights is included.
    #[must_use]
    pub fn jacobians(&self, readings: &[f64]) -> Vec<f64> {
        let n = self.readings.len();
        let mut jacobians = vec![0.0; 6 * self.count * self.rows(readings)];
        self.of_each(readings, &mut jacobians, 6 * self.count, |own, jacobians| {
            if self.is_whole() {
                return by_best(
                    #[inline(always)]
                    || self.arm.jacobians_of(own, jacobians),
                );
            }
            // Joints that do not move the tip keep columns of zeros.
            let mut found = vec![0.0; jacobians.len() / self.count * n];
            by_best(
                #[inline(always)]
                || self.arm.jacobians_of(own, &mut found),
            );
            for (all, own) in jacobians.chunks_exact_mut(self.count).zip(found.chunks_exact(n)) {
                self.readings.iter().zip(own).for_each(|(&at, it)| all[at] = *it);
            }
        });
        jacobians
    }

    /// Deflection of the tip by weights in each configuration: shift of its point (m) and its turn, as a rotation vector (rad), in the base, relative
    /// to joints and links without compliance. Zero if the model has no such terms.
    #[must_use]
    pub fn sag(&self, readings: &[f64]) -> Vec<[f64; 6]> {
        let mut sag = vec![[0.0; 6]; self.rows(readings)];
        self.of_each(readings, &mut sag, 1, |own, sag| {
            by_best(
                #[inline(always)]
                || self.arm.sag_of(own, sag),
            );
        });
        sag
    }

    /// Number of configurations in their readings.
    fn rows(&self, readings: &[f64]) -> usize {
        readings.len() / self.count.max(1)
    }

    /// True if the arm's readings are those of the robot.
    fn is_whole(&self) -> bool {
        self.readings.iter().copied().eq(0..self.count)
    }

    /// Fills a fixed count of numbers of each configuration from the arm's readings there.
    fn of_each<T: Send>(
        &self,
        readings: &[f64],
        out: &mut [T],
        numbers: usize,
        part: impl Fn(&[f64], &mut [T]) + Sync + Send,
    ) {
        let width = self.count.max(1);
        fill_chunks(out, SOME * numbers, |index, out| {
            let first = index * SOME * width;
            let some = readings.get(first..first + out.len() / numbers * width).unwrap_or_default();
            if self.is_whole() {
                return part(some, out);
            }
            let own = |row: &[f64]| self.readings.iter().map(|&at| row[at]).collect::<Vec<f64>>();
            part(&some.chunks_exact(width).flat_map(own).collect::<Vec<f64>>(), out);
        });
    }
}
