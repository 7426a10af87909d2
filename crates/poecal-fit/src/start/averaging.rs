//! Closed forms: the rotation that best turns vectors or frames into others.

use nalgebra::{Matrix3, Matrix4, Vector3, Vector4};

use poecal_arm::lie::{Pose, rotation};
use poecal_numerics::linalg;

/// The rigid motion `T` that minimises `Σ |y_k - T x_k|²` (horn1987: largest eigenvector of a 4×4 matrix, a proper rotation always):
/// theory.md §6 (32).
pub fn rigid_motion(from: &[Vector3<f64>], to: &[Vector3<f64>]) -> Pose {
    let count = from.len().max(1) as f64;
    let from_mean = from.iter().sum::<Vector3<f64>>() / count;
    let to_mean = to.iter().sum::<Vector3<f64>>() / count;
    let mut covariance = Matrix3::zeros();
    for (x, y) in from.iter().zip(to) {
        covariance += (x - from_mean) * (y - to_mean).transpose();
    }
    let turn = rotation_maximising(&covariance);
    Pose::new(turn, to_mean - turn * from_mean)
}

/// The rotation `R` that maximises `tr(R S)` for `S = Σ x yᵀ`: it turns the x onto the y.
pub(crate) fn rotation_maximising(s: &Matrix3<f64>) -> Matrix3<f64> {
    let (d, e, f) = (s[(1, 2)] - s[(2, 1)], s[(2, 0)] - s[(0, 2)], s[(0, 1)] - s[(1, 0)]);
    let trace = s.trace();
    let mut n = Matrix4::zeros();
    n[(0, 0)] = trace;
    for (k, value) in [d, e, f].into_iter().enumerate() {
        n[(0, k + 1)] = value;
        n[(k + 1, 0)] = value;
    }
    for i in 0..3 {
        for j in 0..3 {
            n[(i + 1, j + 1)] = s[(i, j)] + s[(j, i)] - if i == j { trace } else { 0.0 };
        }
    }
    let q = linalg::dominant_eigenvector(&n);
    rotation::from_quaternion_xyzw(&Vector4::new(q[1], q[2], q[3], q[0]))
}

/// Rotation nearest to all of these rotations in the chordal sense.
pub fn mean_rotation(rotations: impl Iterator<Item = Matrix3<f64>>) -> Matrix3<f64> {
    let sum: Matrix3<f64> = rotations.sum();
    rotation_maximising(&sum.transpose())
}

/// The 24 proper rotations of a cube.
pub(crate) fn cube_rotations() -> impl Iterator<Item = Matrix3<f64>> {
    use std::f64::consts::FRAC_PI_2;
    (0..6).flat_map(|face| {
        let up = match face {
            0 => Matrix3::identity(),
            1 => rotation::about(0, FRAC_PI_2),
            2 => rotation::about(0, -FRAC_PI_2),
            3 => rotation::about(0, 2.0 * FRAC_PI_2),
            4 => rotation::about(1, FRAC_PI_2),
            _ => rotation::about(1, -FRAC_PI_2),
        };
        (0..4).map(move |quarter| up * rotation::about(2, f64::from(quarter) * FRAC_PI_2))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rigid_motion_recovers_a_known_one_even_from_coplanar_points() {
        let motion = Pose::from_xyz_rpy([2.0, -1.0, 0.4], [3.0, -1.2, 2.0]);
        let points: Vec<_> =
            (0..12).map(|k| Vector3::new((f64::from(k)).sin(), (f64::from(k) * 1.7).cos(), 0.0)).collect();
        let seen: Vec<_> = points.iter().map(|p| motion.act(p)).collect();
        let found = rigid_motion(&points, &seen);
        assert!((found.rotation - motion.rotation).norm() < 1e-13);
        assert!((found.translation - motion.translation).norm() < 1e-13);
    }

    #[test]
    fn mean_of_one_rotation_is_itself() {
        let r = rotation::from_rpy(0.3, -2.0, 1.0);
        assert!((mean_rotation([r, r].into_iter()) - r).norm() < 1e-13);
    }
}
