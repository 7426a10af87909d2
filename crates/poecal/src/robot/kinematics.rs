//! Forward kinematics by the product of exponentials.

use nalgebra::{Matrix3, Vector3};

use super::{Body, Joint, Robot, TermFunctions};
use crate::lanes::{self, Exponential, SimdLevel, WIDTH, Wide};
use crate::lie::{Pose, Screw, hat};

impl Robot {
    /// Joint values of a configuration given as readings (order of [`Robot::reading_names`]); mimic joints follow their leader,
    /// and terms are added: theory.md §2 (7).
    #[must_use]
    pub fn joint_values(&self, readings: &[f64]) -> Vec<f64> {
        let indices = self.reading_indices();
        let mut values: Vec<f64> = self
            .joints
            .iter()
            .zip(indices)
            .map(|(joint, index)| joint.reading.value(readings.get(index).copied().unwrap_or(0.0)))
            .collect();
        self.add_terms(&mut values, self.factors_of(readings));
        values
    }

    /// Adds the terms of the joints' values.
    fn add_terms(&self, values: &mut [f64], factors: &[f64]) {
        if self.terms.is_empty() {
            return;
        }
        let found = TermFunctions::new(self).at(values, factors);
        let mut more = vec![0.0; values.len()];
        for (term, basis) in self.terms.iter().zip(found) {
            if let Some(more) = more.get_mut(term.joint) {
                *more += term.coefficient * basis;
            }
        }
        values.iter_mut().zip(more).for_each(|(value, more)| *value += more);
    }

    /// `base_from_tip`, theory.md §2 (6), at a configuration given as readings (radians, metres; order of [`Robot::reading_names`]).
    #[must_use]
    pub fn forward_kinematics(&self, readings: &[f64]) -> Pose {
        self.motion(&self.joint_values(readings)) * self.home
    }

    /// [`Robot::forward_kinematics`] of several configurations, their readings one after the other.
    pub fn forward_kinematics_of(&self, readings: &[f64]) -> impl Iterator<Item = Pose> {
        let path = self.joints_to(self.tip_body());
        let (joints, indices) = self.path(&path, &self.reading_indices());
        let width = self.reading_names().len().max(1);
        let exponentials: Vec<Exponential> = joints.iter().map(|joint| exponential(&joint.screw)).collect();
        let mut values = vec![0.0; joints.len() * WIDTH];
        let mut found = vec![(0.0, 0.0); values.len()];
        let mut factors = vec![[Wide::ZERO; 2]; joints.len()];
        readings.chunks(WIDTH * width).flat_map(move |some| {
            let some = some.chunks_exact(width);
            let count = some.len();
            for ((joint, &index), values) in joints.iter().zip(&indices).zip(values.chunks_exact_mut(WIDTH)) {
                for (value, readings) in values.iter_mut().zip(some.clone()) {
                    *value = joint.reading.value(readings.get(index).copied().unwrap_or(0.0));
                }
            }
            if !self.terms.is_empty() {
                for (lane, readings) in some.clone().enumerate() {
                    let (_, all) = self.path(&path, &self.joint_values(readings));
                    values
                        .iter_mut()
                        .skip(lane)
                        .step_by(WIDTH)
                        .zip(all)
                        .for_each(|(value, all)| *value = all);
                }
            }
            lanes::cosines_and_sines(SimdLevel::best(), &values, &mut found);
            let each = joints.iter().zip(&mut factors).zip(found.chunks(WIDTH).zip(values.chunks(WIDTH)));
            for ((joint, [first, second]), (found, values)) in each {
                for (lane, (&found, &value)) in found.iter().zip(values).enumerate() {
                    (first.0[lane], second.0[lane]) = factors_of(&joint.screw, value, found);
                }
            }
            let rows = lanes::product_of_exponentials(SimdLevel::best(), &exponentials, &factors);
            (0..count).map(move |lane| Pose::from_rows(|i, j| rows[i][j].0[lane]) * self.home)
        })
    }

    /// Frames of the joints in the base, `exp(ξ₁θ₁) … exp(ξᵢθᵢ) base_from_joint_i`, at a configuration given as readings (radians, metres;
    /// order of [`Robot::reading_names`]), for pictures of the robot.
    #[must_use]
    pub fn joint_poses(&self, readings: &[f64]) -> Vec<Pose> {
        let mut base_from_links: Vec<Pose> = Vec::with_capacity(self.joints.len());
        let values = self.joint_values(readings);
        for (index, (joint, value)) in self.joints.iter().zip(values).enumerate() {
            let before = self.body_before(index).joint().and_then(|before| base_from_links.get(before));
            base_from_links.push(before.copied().unwrap_or_else(Pose::identity) * joint.screw.exp(value));
        }
        base_from_links.into_iter().zip(&self.joints).map(|(link, joint)| link * joint.frame).collect()
    }

    /// These joints, with their entries of a list of all joints.
    fn path<T: Copy>(&self, path: &[usize], of_all: &[T]) -> (Vec<&Joint>, Vec<T>) {
        path.iter().filter_map(|&at| Some((self.joints.get(at)?, *of_all.get(at)?))).unzip()
    }

    /// The rigid motion `T_n = exp(ξ₁θ₁) … exp(ξₙθₙ)` of the tip's link from its place at zero, for *joint values* θ:
    /// theory.md §2 (6).
    #[must_use]
    pub fn motion(&self, joint_values: &[f64]) -> Pose {
        self.motion_of(self.tip_body(), joint_values)
    }

    /// The same of another body.
    #[must_use]
    pub fn motion_of(&self, body: Body, joint_values: &[f64]) -> Pose {
        let (joints, values) = self.path(&self.joints_to(body), joint_values);
        let mut found = vec![(0.0, 0.0); values.len()];
        lanes::cosines_and_sines(SimdLevel::best(), &values, &mut found);
        let mut rows = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        for ((joint, value), found) in joints.into_iter().zip(values).zip(found) {
            let (first, second) = factors_of(&joint.screw, value, found);
            exponential(&joint.screw).advance(&mut rows, first, second, |number| number);
        }
        Pose::from_rows(|i, j| rows[i][j])
    }
}

/// The two numbers of a joint's motion that depend on its value: `sin θ` and `1 - cos θ` with `(cos θ, sin θ)` known, or θ of a sliding
/// joint. They are added to numbers of about one, so that rounding of `1 - cos θ` at small angles is negligible.
fn factors_of(screw: &Screw, value: f64, (cosine, sine): (f64, f64)) -> (f64, f64) {
    if screw.is_prismatic() { (value, 0.0) } else { (sine, 1.0 - cosine) }
}

/// `exp(ξ̂θ) = I + sin θ F + (1 - cos θ) G`, or `I + θ F` of a sliding joint: theory.md §1 (2a).
fn exponential(screw: &Screw) -> Exponential {
    let rows = |turn: &Matrix3<f64>, shift: &Vector3<f64>| {
        std::array::from_fn(|i| [turn[(i, 0)], turn[(i, 1)], turn[(i, 2)], shift[i]])
    };
    if screw.is_prismatic() {
        let none = Matrix3::zeros();
        return Exponential { first: rows(&none, &screw.v()), second: rows(&none, &Vector3::zeros()) };
    }
    let (w, point) = (screw.w(), screw.w().cross(&screw.v()));
    let (first, second) = (hat(&w), w * w.transpose() - Matrix3::identity());
    Exponential { first: rows(&first, &-(first * point)), second: rows(&second, &-(second * point)) }
}

#[cfg(test)]
mod tests {
    use crate::robot::tests::elbow;

    #[test]
    fn the_tip_is_fixed_to_the_frame_of_the_last_joint() {
        let robot = elbow();
        let tip = robot.joint_poses(&[0.3; 6])[5] * robot.last_joint_from_tip();
        assert!((tip.translation - robot.forward_kinematics(&[0.3; 6]).translation).norm() < 1e-14);
    }
}
