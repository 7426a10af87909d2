//! Rigid motions: poses, twists, screws and their exponentials. No robots here, and no files.
//!
//! Conventions (docs/conventions.md): a twist is `ξ = (v; ω)`, linear part first; perturbations are on the left,
//! `T ← exp(δ) T`; poses are named `a_from_b` and take coordinates in `b` to coordinates in `a`.

mod pose;
pub mod rotation;
mod screw;
pub mod series;
mod twist;

pub use pose::Pose;
pub use screw::Screw;
pub use twist::{TargetTwist, Twist};

/// The skew-symmetric matrix `â` with `â b = a × b`: theory.md §1.
///
/// ```
/// use nalgebra::Vector3;
/// let (a, b) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(-0.5, 0.1, 2.0));
/// assert_eq!(poecal::lie::hat(&a) * b, a.cross(&b));
/// ```
#[must_use]
pub fn hat(a: &nalgebra::Vector3<f64>) -> nalgebra::Matrix3<f64> {
    nalgebra::Matrix3::new(0.0, -a.z, a.y, a.z, 0.0, -a.x, -a.y, a.x, 0.0)
}
