//! Forward kinematics by the product of exponentials.

use super::Robot;
use crate::lanes::{self, Level};
use crate::lie::Pose;

impl Robot {
    /// Joint values of a configuration given as readings (order of [`Robot::reading_names`]); mimic joints follow their leader:
    /// theory.md §2 (7).
    #[must_use]
    pub fn joint_values(&self, readings: &[f64]) -> Vec<f64> {
        let indices = self.reading_indices();
        self.joints
            .iter()
            .zip(indices)
            .map(|(joint, index)| joint.reading.value(readings.get(index).copied().unwrap_or(0.0)))
            .collect()
    }

    /// `base_from_tip`, theory.md §2 (6), at a configuration given as readings (radians, metres; order of [`Robot::reading_names`]).
    #[must_use]
    pub fn forward_kinematics(&self, readings: &[f64]) -> Pose {
        self.motion(&self.joint_values(readings)) * self.home
    }

    /// [`Robot::forward_kinematics`] of one configuration after the other.
    pub fn forward_kinematics_of<'a>(
        &'a self,
        configurations: impl Iterator<Item = &'a [f64]>,
    ) -> impl Iterator<Item = Pose> {
        let indices = self.reading_indices();
        let mut values = vec![0.0; self.joints.len()];
        let mut sines = Sines::default();
        configurations.map(move |readings| {
            for ((value, joint), &index) in values.iter_mut().zip(&self.joints).zip(&indices) {
                *value = joint.reading.value(readings.get(index).copied().unwrap_or(0.0));
            }
            sines.motion(self, &values) * self.home
        })
    }

    /// Frames of the joints in the base, `exp(ξ₁θ₁) … exp(ξᵢθᵢ) base_from_joint_i`, at a configuration given as readings (radians, metres;
    /// order of [`Robot::reading_names`]): what a drawing of the robot needs.
    ///
    /// ```
    /// let robot = poecal::simulate::elbow();
    /// let frames = robot.joint_poses(&[0.3; 6]);
    /// // The tip is fixed to the last link.
    /// let tip = frames[5] * robot.last_joint_from_tip();
    /// assert!((tip.translation - robot.forward_kinematics(&[0.3; 6]).translation).norm() < 1e-14);
    /// ```
    #[must_use]
    pub fn joint_poses(&self, readings: &[f64]) -> Vec<Pose> {
        let mut base_from_link = Pose::identity();
        let values = self.joint_values(readings);
        let joints = self.joints.iter().zip(values);
        joints
            .map(|(joint, value)| {
                base_from_link = base_from_link * joint.screw.exp(value);
                base_from_link * joint.frame
            })
            .collect()
    }

    /// The rigid motion `T_n = exp(ξ₁θ₁) … exp(ξₙθₙ)` of the last link from its place at zero, for *joint values* θ:
    /// theory.md §2 (6).
    #[must_use]
    pub fn motion(&self, joint_values: &[f64]) -> Pose {
        Sines::default().motion(self, joint_values)
    }
}

/// Room for joint values and their halves, and `(cos, sin)` of both.
#[derive(Default)]
struct Sines {
    values: Vec<f64>,
    found: Vec<(f64, f64)>,
}

impl Sines {
    /// [`Robot::motion`], all sines at once.
    fn motion(&mut self, robot: &Robot, joint_values: &[f64]) -> Pose {
        self.values.clear();
        self.values.extend_from_slice(joint_values);
        self.values.extend(joint_values.iter().map(|value| 0.5 * value));
        self.found.resize(self.values.len(), (0.0, 0.0));
        lanes::cosines_and_sines(Level::best(), &self.values, &mut self.found);
        let (whole, halves) = self.found.split_at(joint_values.len());
        let each = robot.joints.iter().zip(joint_values).zip(whole.iter().zip(halves));
        each.fold(Pose::identity(), |pose, ((joint, &value), ((_, sine), (_, half)))| {
            pose * joint.screw.exp_with(value, *sine, *half)
        })
    }
}
