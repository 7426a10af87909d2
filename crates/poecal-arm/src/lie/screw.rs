//! Joint screws: unit twists of zero pitch (a revolute axis) or infinite pitch (a prismatic direction).

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

use nalgebra::{Matrix3, Vector3};

use super::{Pose, Twist, rotation};

/// A joint screw in a fixed frame at the zero configuration: revolute `(v; ω)` with `|ω| = 1`, `v·ω = 0`, `v = -ω × q` for any
/// point `q` of the axis; or prismatic `(v; 0)` with `|v| = 1` (murray1994; theory.md §2 (5)).
///
/// ```
/// use nalgebra::Vector3;
/// use poecal_arm::lie::Screw;
/// let axis = Screw::revolute(&Vector3::z(), &Vector3::new(1.0, 0.0, 5.0));
/// let quarter = axis.exp(core::f64::consts::FRAC_PI_2);
/// assert!((quarter.act(&Vector3::zeros()) - Vector3::new(1.0, -1.0, 0.0)).norm() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Screw {
    v: Vector3<f64>,
    w: Vector3<f64>,
}

impl Screw {
    /// The axis along `direction` (any length but zero) through `point` (metres): theory.md §2 (5).
    #[must_use]
    pub fn revolute(direction: &Vector3<f64>, point: &Vector3<f64>) -> Self {
        let w = direction.normalize();
        Screw { v: -w.cross(point), w }
    }

    /// The prismatic direction `direction` (any length but zero): theory.md §2 (5).
    #[must_use]
    pub fn prismatic(direction: &Vector3<f64>) -> Self {
        Screw { v: direction.normalize(), w: Vector3::zeros() }
    }

    /// Screw of a normalised twist, theory.md §5 (22c), as rounded tables need it: `ω/|ω|` and `(v - ω(ω·v))/|ω|` if `ω ≠ 0`, else `v/|v|`. `None` if
    /// the twist is zero or not finite.
    #[must_use]
    pub fn project(twist: &Twist) -> Option<Self> {
        let (angular, linear) = (twist.w.norm(), twist.v.norm());
        if angular > 0.0 && angular.is_finite() && linear.is_finite() {
            let w = twist.w / angular;
            let v = twist.v / angular;
            Some(Screw { v: v - w * w.dot(&v), w })
        } else if angular == 0.0 && linear > 0.0 && linear.is_finite() {
            Some(Screw { v: twist.v / linear, w: Vector3::zeros() })
        } else {
            None
        }
    }

    /// Linear part `v`, metres (or a unit vector, if prismatic).
    #[must_use]
    pub fn v(&self) -> Vector3<f64> {
        self.v
    }

    /// Angular part `ω`, a unit vector (or zero, if prismatic).
    #[must_use]
    pub fn w(&self) -> Vector3<f64> {
        self.w
    }

    /// The screw as a twist.
    #[must_use]
    pub fn twist(&self) -> Twist {
        Twist::new(self.v, self.w)
    }

    /// True if the screw is a prismatic direction.
    #[must_use]
    pub fn is_prismatic(&self) -> bool {
        self.w == Vector3::zeros()
    }

    /// Unit direction: ω of an axis, v of a prismatic direction.
    #[must_use]
    pub fn direction(&self) -> Vector3<f64> {
        if self.is_prismatic() { self.v } else { self.w }
    }

    /// Point of the axis nearest to `point`, `ω × v + ω (ω·p)` by theory.md §2 (5); for a prismatic direction, `point` itself.
    #[must_use]
    pub fn nearest_point(&self, point: &Vector3<f64>) -> Vector3<f64> {
        if self.is_prismatic() {
            return *point;
        }
        let q = self.w.cross(&self.v);
        q + self.w * self.w.dot(&(point - q))
    }

    /// `exp(ξ̂ θ)`, lou2009 (1) and theory.md §1 (2a), θ in radians (revolute) or metres (prismatic).
    #[must_use]
    pub fn exp(&self, theta: f64) -> Pose {
        if self.is_prismatic() {
            return Pose::from_translation(self.v * theta);
        }
        let (sine, half) = (theta.sin(), (0.5 * theta).sin());
        let hat_w = super::hat(&self.w);
        // ω̂² = ω ωᵀ - I.
        let turn = hat_w * sine + (self.w * self.w.transpose() - Matrix3::identity()) * (2.0 * half * half);
        // p = (I - R) q with q = ω × v, since the pitch is zero.
        Pose::new(Matrix3::identity() + turn, -(turn * self.w.cross(&self.v)))
    }

    /// The screw in another frame, or moved as a body: `Ad_T ξ`, theory.md §3 (10).
    #[must_use]
    pub fn transform(&self, pose: &Pose) -> Self {
        if self.is_prismatic() {
            return Screw::prismatic(&(pose.rotation * self.v));
        }
        Screw::revolute(&(pose.rotation * self.w), &pose.act(&self.w.cross(&self.v)))
    }

    /// Smallest rigid motion that takes this screw to `to`, relative to `near`: the shortest arc between the directions,
    /// and for axes the shift from this axis's point nearest to `near` to the other's.
    #[must_use]
    pub fn smallest_motion_to(&self, to: &Screw, near: &Vector3<f64>) -> Pose {
        let turn = rotation::shortest_arc(&self.direction(), &to.direction());
        let from_point = self.nearest_point(near);
        let to_point = to.nearest_point(&from_point);
        Pose::new(turn, to_point - turn * from_point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponential_is_that_of_the_twist() {
        for screw in [
            Screw::revolute(&Vector3::new(0.3, -0.5, 1.0), &Vector3::new(0.4, 2.0, -1.0)),
            Screw::prismatic(&Vector3::new(0.3, -0.5, 1.0)),
        ] {
            for theta in [0.0, 1e-9, 0.4, -3.0] {
                let twist = Twist::new(screw.v() * theta, screw.w() * theta);
                let (a, b) = (screw.exp(theta), Pose::exp(&twist));
                assert!((a.translation - b.translation).norm() < 1e-14);
                assert!((a.rotation - b.rotation).norm() < 1e-14);
            }
        }
    }

    #[test]
    fn transforming_a_screw_is_the_adjoint() {
        let pose = Pose::from_xyz_rpy([0.4, -1.0, 2.0], [0.3, -0.8, 2.5]);
        let screw = Screw::revolute(&Vector3::new(0.3, -0.5, 1.0), &Vector3::new(0.4, 2.0, -1.0));
        let direct = pose.transform(&screw.twist()).to_vector();
        assert!((screw.transform(&pose).twist().to_vector() - direct).norm() < 1e-14);
    }

    #[test]
    fn smallest_motion_reaches_the_other_axis() {
        let a = Screw::revolute(&Vector3::new(0.3, -0.5, 1.0), &Vector3::new(0.4, 2.0, -1.0));
        let b = Screw::revolute(&Vector3::new(0.2, -0.6, 1.1), &Vector3::new(0.5, 1.9, -1.0));
        let moved = a.transform(&a.smallest_motion_to(&b, &Vector3::zeros()));
        assert!((moved.twist().to_vector() - b.twist().to_vector()).norm() < 1e-14);
    }
}
