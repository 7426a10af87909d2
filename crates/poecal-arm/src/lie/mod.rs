//! Rigid motions: poses, twists, screws and their exponentials. Robots and files are elsewhere.
//!
//! Conventions (docs/conventions.md): a twist is `ξ = (v; ω)`, linear part first; perturbations are on the left,
//! `T ← exp(δ) T`; poses are named `a_from_b` and take coordinates in `b` to coordinates in `a`.

pub mod angles;
mod freedom;
mod pose;
pub mod rotation;
mod screw;
pub mod series;
mod twist;

pub use freedom::Freedom;
pub use pose::Pose;
pub use screw::Screw;
pub use twist::{TargetTwist, Twist};

use nalgebra::{Matrix3, Matrix3x6, Vector3};

/// The skew-symmetric matrix `â` with `â b = a × b`: theory.md §1.
#[must_use]
pub fn hat(a: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, -a.z, a.y, a.z, 0.0, -a.x, -a.y, a.x, 0.0)
}

/// `[I, -p̂]`: a point's motion under a spatial twist.
#[must_use]
pub fn by_twist(point: &Vector3<f64>) -> Matrix3x6<f64> {
    let mut derivative = by_turn(&-hat(point), 1.0);
    derivative.fixed_view_mut::<3, 3>(0, 0).fill_with_identity();
    derivative
}

/// `[0, scale · A]`: a derivative that depends on the rotation of a spatial twist only.
#[must_use]
pub fn by_turn(matrix: &Matrix3<f64>, scale: f64) -> Matrix3x6<f64> {
    let mut derivative = Matrix3x6::zeros();
    derivative.fixed_view_mut::<3, 3>(0, 3).copy_from(&(matrix * scale));
    derivative
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector6;

    #[test]
    fn hats_are_cross_products() {
        let (a, b) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(-0.5, 0.1, 2.0));
        assert_eq!(hat(&a) * b, a.cross(&b));
    }

    #[test]
    fn twists_and_turns_move_a_point() {
        let twist = Vector6::new(0.0, 0.0, 0.1, 0.0, 0.0, 2.0);
        assert_eq!(by_twist(&Vector3::x()) * twist, Vector3::new(0.0, 2.0, 0.1));
        let twist = Vector6::new(1.0, 1.0, 1.0, 0.0, 0.0, 2.0);
        assert_eq!(by_turn(&Matrix3::identity(), 3.0) * twist, Vector3::new(0.0, 0.0, 6.0));
    }
}
