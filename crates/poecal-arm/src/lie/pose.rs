//! Rigid motions: elements of SE(3).

use core::ops::Mul;
use nalgebra::{Matrix3, Matrix6, Vector3, Vector4};

use super::{Twist, hat, rotation, series};

/// A rigid motion, named `a_from_b`: it takes coordinates in `b` to coordinates in `a`, `x_a = R x_b + p` (theory.md §1
/// (2) and (2a)).
///
/// | operation | symbol | code |
/// |---|---|---|
/// | composition | `T₁ T₂` | `a_from_b * b_from_c` |
/// | inverse | `T⁻¹` | `pose.inverse()` |
/// | action on a point | `R x + p` | `pose.act(&x)` |
/// | exponential | `exp(ξ̂)` | `Pose::exp(&twist)` |
/// | logarithm | `log(T)^∨` | `pose.log()` |
/// | adjoint | `[[R, p̂R], [0, R]]` | `pose.adjoint()` |
///
/// ```
/// use nalgebra::Vector3;
/// use poecal_arm::lie::{Pose, Twist};
/// let base_from_tool = Pose::exp(&Twist::new(Vector3::new(0.1, 0.2, 0.3), Vector3::new(0.0, 0.0, 1.0)));
/// let identity = base_from_tool * base_from_tool.inverse();
/// assert!(identity.log().to_vector().norm() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Pose {
    /// Rotation matrix.
    pub rotation: Matrix3<f64>,
    /// Origin of `b` in `a`, metres.
    pub translation: Vector3<f64>,
}

impl Pose {
    /// The pose of a rotation matrix and a translation (metres).
    #[must_use]
    pub fn new(rotation: Matrix3<f64>, translation: Vector3<f64>) -> Self {
        Pose { rotation, translation }
    }

    /// No motion.
    #[must_use]
    pub fn identity() -> Self {
        Pose::new(Matrix3::identity(), Vector3::zeros())
    }

    /// Pose from numbers: `number` returns the three components of directions and the component of the translation (metres) of each row.
    pub fn from_rows(number: impl Fn(usize, usize) -> f64) -> Self {
        let translation = Vector3::from_fn(|row, _| number(row, 3));
        Pose::new(Matrix3::from_fn(number), translation)
    }

    /// A pure translation, metres.
    #[must_use]
    pub fn from_translation(translation: Vector3<f64>) -> Self {
        Pose::new(Matrix3::identity(), translation)
    }

    /// The pose of a URDF `<origin xyz rpy>` (metres, radians), by [`rotation::from_rpy`].
    #[must_use]
    pub fn from_xyz_rpy(xyz: [f64; 3], rpy: [f64; 3]) -> Self {
        Pose::new(rotation::from_rpy(rpy[0], rpy[1], rpy[2]), Vector3::from(xyz))
    }

    /// The pose of a position (metres) and a quaternion `(x, y, z, w)`, which is normalised, by [`rotation::from_quaternion_xyzw`].
    #[must_use]
    pub fn from_position_quaternion(position: [f64; 3], xyzw: [f64; 4]) -> Self {
        Pose::new(rotation::from_quaternion_xyzw(&Vector4::from(xyzw)), Vector3::from(position))
    }

    /// The quaternion `[x, y, z, w]` of the rotation, `w ≥ 0`, by [`rotation::to_quaternion_xyzw`].
    #[must_use]
    pub fn quaternion_xyzw(&self) -> [f64; 4] {
        rotation::to_quaternion_xyzw(&self.rotation).into()
    }

    /// Distance of the origins of two poses (m), and the angle between their axes (rad).
    #[must_use]
    pub fn distance_and_angle(&self, other: &Self) -> (f64, f64) {
        let turn = rotation::log(&(self.rotation.transpose() * other.rotation));
        ((self.translation - other.translation).norm(), turn.norm())
    }

    /// `T⁻¹ = (Rᵀ, -Rᵀp)`, as theory.md §1 has `T = (R, p)`.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let transposed = self.rotation.transpose();
        Pose::new(transposed, -(transposed * self.translation))
    }

    /// `R x + p`: theory.md §1.
    #[must_use]
    pub fn act(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * point + self.translation
    }

    /// `Ad_T = [[R, p̂R], [0, R]]` acting on `[v; ω]`: theory.md §1 (2).
    #[must_use]
    pub fn adjoint(&self) -> Matrix6<f64> {
        let mut adjoint = Matrix6::zeros();
        adjoint.fixed_view_mut::<3, 3>(0, 0).copy_from(&self.rotation);
        adjoint.fixed_view_mut::<3, 3>(0, 3).copy_from(&(hat(&self.translation) * self.rotation));
        adjoint.fixed_view_mut::<3, 3>(3, 3).copy_from(&self.rotation);
        adjoint
    }

    /// `Ad_T ξ` without the matrix, `(R v + p × R ω; R ω)`: theory.md §1 (2).
    #[must_use]
    pub fn transform(&self, twist: &Twist) -> Twist {
        let w = self.rotation * twist.w;
        Twist::new(self.rotation * twist.v + self.translation.cross(&w), w)
    }

    /// `exp(ξ̂) = (exp(ω̂), V v)` with `V = I + cosc ω̂ + sincc ω̂²`: theory.md §1 (2a).
    #[must_use]
    pub fn exp(twist: &Twist) -> Self {
        let angle_squared = twist.w.norm_squared();
        let hat_w = hat(&twist.w);
        let hat_w2 = hat_w * hat_w;
        let (sinc, cosc, sincc) =
            (series::sinc(angle_squared), series::cosc(angle_squared), series::sincc(angle_squared));
        let v = Matrix3::identity() + hat_w * cosc + hat_w2 * sincc;
        Pose::new(Matrix3::identity() + hat_w * sinc + hat_w2 * cosc, v * twist.v)
    }

    /// The twist ξ with `exp(ξ̂) = T` and `|ω| ≤ π`: theory.md §1 (2a).
    #[must_use]
    pub fn log(&self) -> Twist {
        let w = rotation::log(&self.rotation);
        let hat_w = hat(&w);
        let v_inverse = Matrix3::identity() - hat_w * 0.5 + hat_w * hat_w * series::cotc(w.norm_squared());
        Twist::new(v_inverse * self.translation, w)
    }

    /// The same pose with a rotation matrix freed of accumulated rounding, by [`rotation::orthonormalized`].
    #[must_use]
    pub fn orthonormalized(&self) -> Self {
        Pose::new(rotation::orthonormalized(&self.rotation), self.translation)
    }
}

impl Mul for Pose {
    type Output = Pose;
    fn mul(self, other: Pose) -> Pose {
        Pose::new(self.rotation * other.rotation, self.act(&other.translation))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;

    #[test]
    fn logarithm_inverts_the_exponential_at_every_scale() {
        for angle in [0.0, 1e-8, 0.0999, 0.1001, 1.0, PI - 1e-6] {
            let twist = Twist::new(Vector3::new(0.3, -0.2, 0.5), Vector3::new(0.6, -0.48, 0.64) * angle);
            let error = (Pose::exp(&twist).log().to_vector() - twist.to_vector()).norm();
            println!("angle {angle}: {error:.1e}");
            assert!(error < 2e-14, "{error}");
        }
    }

    #[test]
    fn adjoint_is_conjugation() {
        let pose = Pose::from_xyz_rpy([0.4, -1.0, 2.0], [0.3, -0.8, 2.5]);
        let twist = Twist::new(Vector3::new(0.3, -0.2, 0.5), Vector3::new(0.6, -1.48, 0.64));
        let left = Pose::exp(&pose.transform(&twist));
        let right = pose * Pose::exp(&twist) * pose.inverse();
        assert!((left.translation - right.translation).norm() < 1e-14);
        assert!((left.rotation - right.rotation).norm() < 1e-14);
        assert!((pose.adjoint() * twist.to_vector() - pose.transform(&twist).to_vector()).norm() < 1e-15);
    }

    #[test]
    fn poses_are_apart_by_a_distance_and_an_angle() {
        let moved = Pose::from_translation(Vector3::new(0.0, 0.3, 0.4));
        assert_eq!(Pose::identity().distance_and_angle(&moved), (0.5, 0.0));
    }
}
