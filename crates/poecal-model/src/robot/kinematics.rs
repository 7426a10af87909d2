//! Forward kinematics by the product of exponentials.

#![allow(clippy::needless_range_loop, reason = "loops over configurations go over several lists alike")]

use nalgebra::{Matrix3, Vector3};

use super::{Body, Joint, Robot, TermFunctions};
use poecal_arm::lie::{Pose, Screw, hat};
use poecal_numerics::kernels::{self as lanes, SimdLevel, WIDTH};

impl Robot {
    /// Joint values of a configuration by its readings (order of [`Robot::reading_names`]); mimic joints follow their leader,
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
        let found = TermFunctions::new(self).evaluate(values, factors);
        let mut more = vec![0.0; values.len()];
        for (term, basis) in self.terms.iter().zip(found) {
            if let Some(more) = more.get_mut(term.joint) {
                *more += term.coefficient * basis;
            }
        }
        values.iter_mut().zip(more).for_each(|(value, more)| *value += more);
    }

    /// `base_from_tip`, theory.md §2 (6), at a configuration by its readings (radians, metres; order of [`Robot::reading_names`]).
    #[must_use]
    pub fn forward_kinematics(&self, readings: &[f64]) -> Pose {
        self.motion(&self.joint_values(readings)) * self.home
    }

    /// [`Robot::forward_kinematics`] of several configurations, their readings one after the other. The numbers are the same; it is
    /// faster, since eight configurations are computed side by side.
    pub fn forward_kinematics_of(&self, readings: &[f64]) -> impl Iterator<Item = Pose> {
        let path = self.joints_to(self.tip_body());
        let (joints, indices) = self.path(&path, &self.reading_indices());
        let width = self.reading_names().len().max(1);
        let exponentials: Vec<JointExponential> =
            joints.iter().map(|it| JointExponential::from_screw(&it.screw)).collect();
        let mut values = vec![[0.0; WIDTH]; joints.len()];
        readings.chunks(WIDTH * width).flat_map(move |some| {
            let some = some.chunks_exact(width);
            let count = some.len();
            for (lane, readings) in some.enumerate() {
                let all = (!self.terms.is_empty()).then(|| self.joint_values(readings));
                for (k, values) in values.iter_mut().enumerate() {
                    values[lane] = match &all {
                        Some(all) => all[path[k]],
                        None => joints[k].reading.value(readings[indices[k]]),
                    };
                }
            }
            let rows = product(&exponentials, &values);
            (0..count).map(move |lane| Pose::from_rows(|i, j| rows[i][j][lane]) * self.home)
        })
    }

    /// Frames of the joints in the base, `exp(ξ₁θ₁) … exp(ξᵢθᵢ) base_from_joint_i`, for drawings of the robot. The configuration is passed
    /// as readings (radians, metres; order of [`Robot::reading_names`]).
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

    /// Rigid motion `T_n = exp(ξ₁θ₁) … exp(ξₙθₙ)` of the tip's link from its pose at zero, for *joint values* θ:
    /// theory.md §2 (6).
    #[must_use]
    pub fn motion(&self, joint_values: &[f64]) -> Pose {
        self.motion_of(self.tip_body(), joint_values)
    }

    /// The same motion of another body.
    #[must_use]
    pub fn motion_of(&self, body: Body, joint_values: &[f64]) -> Pose {
        let (joints, values) = self.path(&self.joints_to(body), joint_values);
        let exponentials: Vec<JointExponential> =
            joints.iter().map(|it| JointExponential::from_screw(&it.screw)).collect();
        let values: Vec<[f64; 1]> = values.into_iter().map(|value| [value]).collect();
        let rows = product(&exponentials, &values);
        Pose::from_rows(|i, j| rows[i][j][0])
    }
}

/// Poses of several configurations, by rows: three directions and a translation.
type PoseRows<const N: usize> = [[[f64; N]; 4]; 3];

/// Motion of a joint, `exp(ξ̂θ) = I + sin θ F + (1 - cos θ) G`, or `I + θ F` for a prismatic joint: theory.md §1 (2a).
#[derive(Clone, Copy, Debug)]
struct JointExponential {
    slides: bool,
    first: [[f64; 4]; 3],
    second: [[f64; 4]; 3],
}

impl JointExponential {
    fn from_screw(screw: &Screw) -> Self {
        let rows = |turn: &Matrix3<f64>, shift: &Vector3<f64>| {
            std::array::from_fn(|i| [turn[(i, 0)], turn[(i, 1)], turn[(i, 2)], shift[i]])
        };
        if screw.is_prismatic() {
            let none = Matrix3::zeros();
            let (first, second) = (rows(&none, &screw.v()), rows(&none, &Vector3::zeros()));
            return JointExponential { slides: true, first, second };
        }
        let (w, point) = (screw.w(), screw.w().cross(&screw.v()));
        let (first, second) = (hat(&w), w * w.transpose() - Matrix3::identity());
        let (first, second) = (rows(&first, &-(first * point)), rows(&second, &-(second * point)));
        JointExponential { slides: false, first, second }
    }

    /// Moves poses by the joint's motion. No product is fused with a sum, so that the bits are the same by all instructions. `1 - cos θ` is
    /// added to numbers of about one, so that its rounding at small angles is negligible.
    #[inline(always)]
    fn advance<const N: usize>(&self, rows: &mut PoseRows<N>, values: &[f64; N], found: &[(f64, f64); N]) {
        let (mut first, mut second) = (*values, [0.0; N]);
        if !self.slides {
            for l in 0..N {
                (first[l], second[l]) = (found[l].1, 1.0 - found[l].0);
            }
        }
        let mut change = [[[0.0; N]; 4]; 3];
        for i in 0..3 {
            for j in 0..4 {
                for l in 0..N {
                    change[i][j][l] = first[l] * self.first[i][j] + second[l] * self.second[i][j];
                }
            }
        }
        for row in rows {
            let [x, y, z, _] = *row;
            for j in 0..4 {
                for l in 0..N {
                    row[j][l] += x[l] * change[0][j][l] + y[l] * change[1][j][l] + z[l] * change[2][j][l];
                }
            }
        }
    }
}

/// Product of the motions of all joints at their values: theory.md §2 (6).
fn product<const N: usize>(joints: &[JointExponential], values: &[[f64; N]]) -> PoseRows<N> {
    let mut found = vec![[(0.0, 0.0); N]; values.len()];
    lanes::cosines_and_sines(SimdLevel::best_level(), values.as_flattened(), found.as_flattened_mut());
    let one = |i: usize, j: usize| [f64::from(u8::from(i == j)); N];
    let mut rows: PoseRows<N> = std::array::from_fn(|i| std::array::from_fn(|j| one(i, j)));
    lanes::by_best(
        #[inline(always)]
        || {
            for (joint, (values, found)) in joints.iter().zip(values.iter().zip(&found)) {
                joint.advance(&mut rows, values, found);
            }
        },
    );
    rows
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
