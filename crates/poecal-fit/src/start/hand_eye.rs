//! Device rotation from relative rotations alone, `A_ij = R_D B_ij R_Dᵀ` (park1994handeye): no target orientation is needed
//! (theory.md §6 (33)).

use nalgebra::{Matrix3, Vector3};

use super::averaging::rotation_maximising;
use poecal_arm::lie::rotation;
use poecal_numerics::linalg;

/// Device-from-base rotation that maps the arm's relative rotations to the measured ones, and the excitation of the second and
/// third directions of rotation (0 to 1). Near zero, the data have few orientations and the rotation is weakly determined.
pub(crate) fn device_rotation(arm: &[Matrix3<f64>], seen: &[Matrix3<f64>]) -> (Matrix3<f64>, f64) {
    let mut correlation = Matrix3::zeros();
    let mut directions: Vec<Vector3<f64>> = Vec::new();
    let count = arm.len();
    // Pairs at several distances: neighbours alone often share a direction of rotation.
    for step in [1, 2, 5, count / 3 + 1, count / 2 + 1] {
        for i in 0..count.saturating_sub(step) {
            let from = rotation::log(&(arm[i] * arm[i + step].transpose()));
            let to = rotation::log(&(seen[i] * seen[i + step].transpose()));
            correlation += from * to.transpose();
            directions.push(from);
            directions.push(-from);
        }
    }
    let spread = linalg::principal_spread(&directions);
    let excitation = if spread[0] > 0.0 { spread[1] / spread[0] } else { 0.0 };
    (rotation_maximising(&correlation), excitation)
}
