//! Position and orientation of a frame, with the residual of lou2009.

use nalgebra::{Matrix3, Matrix6, Vector3};

use super::{Noise, Residual};
use crate::lie::{Pose, TargetTwist, Twist};

/// Measured frame with the paper's residual `e = log(Y P⁻¹)^∨` (lou2009 after equation 7): the twist about the *device's* origin that
/// takes the predicted frame to the measured one, linear part first.
///
/// Its sensitivity is `J_r(e)⁻¹ = J_l(-e)⁻¹` on the spatial twist, exact also for large residuals. To first order the linear part is
/// `(y - p) + p × r`, so rotation noise counts as position noise times the distance: [`super::PoseMeasurement`] is what a device's
/// data sheet describes, this is for comparison (docs/theory.md §4 (16a)).
///
/// ```
/// use poecal::lie::Pose;
/// use poecal::measurement::{Noise, Residual, SpatialPoseMeasurement};
/// let pose = Pose::from_xyz_rpy([0.1, 0.2, 0.3], [0.4, 0.5, 0.6]);
/// let mut e = [1.0; 6];
/// SpatialPoseMeasurement { pose }.residual(&pose, &Noise { position_m: 1e-3, rotation_rad: 1e-3 }, &mut e);
/// assert!(e.iter().all(|component| component.abs() < 1e-12));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SpatialPoseMeasurement {
    /// `device_from_target`.
    pub pose: Pose,
}

impl SpatialPoseMeasurement {
    fn twist(&self, predicted: &Pose) -> Twist {
        (self.pose * predicted.inverse()).log()
    }
}

impl Residual for SpatialPoseMeasurement {
    fn dim(&self) -> usize {
        6
    }

    fn residual(&self, predicted: &Pose, noise: &Noise, out: &mut [f64]) {
        let e = self.twist(predicted);
        out[..3].copy_from_slice((e.v / noise.position_m).as_slice());
        out[3..6].copy_from_slice((e.w / noise.rotation_rad).as_slice());
    }

    fn project(
        &self,
        predicted: &Pose,
        columns: &[TargetTwist],
        noise: &Noise,
        stride: usize,
        out: &mut [f64],
    ) {
        let e = self.twist(predicted);
        let sensitivity: Matrix6<f64> = Twist::new(-e.v, -e.w).inverse_left_jacobian();
        for (column, (v, w)) in columns.iter().enumerate() {
            // From the target's origin to the device's.
            let spatial = Twist::new(v + predicted.translation.cross(w), *w).to_vector();
            let moved = sensitivity * spatial;
            for row in 0..6 {
                let sigma = if row < 3 { noise.position_m } else { noise.rotation_rad };
                out[row * stride + column] = moved[row] / sigma;
            }
        }
    }

    fn wrench(&self, _: &Pose, _: &Noise) -> Option<(Vector3<f64>, Vector3<f64>)> {
        None
    }

    fn rotation_row(&self) -> usize {
        3
    }

    fn position(&self) -> Vector3<f64> {
        self.pose.translation
    }

    fn orientation(&self) -> Option<Matrix3<f64>> {
        Some(self.pose.rotation)
    }
}
