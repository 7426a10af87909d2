//! The residual of lou2009 for measured frames.

use nalgebra::Matrix6;
use poecal::lie::{Pose, TargetTwist, Twist};
use poecal::measurement::{Noise, PoseResidual};

/// The paper's residual of a measured frame, `e = log(Y P⁻¹)^∨` (lou2009 after equation 7): the twist about the *device's* origin that
/// takes the predicted frame to the measured one, linear part first.
///
/// Its sensitivity is `J_r(e)⁻¹ = J_l(-e)⁻¹` on the spatial twist, exact also for large residuals. To first order the linear part is
/// `(y - p) + p × r`, so rotation noise counts as position noise times the distance: [`poecal::measurement::PoseMeasurement`] is what a device's
/// data sheet describes, this is for comparison (docs/theory.md §4 (16a)).
///
/// ```
/// use poecal::{lie::Pose, measurement::{Noise, PoseResidual}};
/// use poecal_lou2009::Spatial;
/// let pose = Pose::from_xyz_rpy([0.1, 0.2, 0.3], [0.4, 0.5, 0.6]);
/// let mut e = [1.0; 6];
/// Spatial.residual(&pose, &pose, &Noise { position_m: 1e-3, rotation_rad: 1e-3 }, &mut e);
/// assert!(e.iter().all(|component| component.abs() < 1e-12));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spatial;

fn error(measured: &Pose, predicted: &Pose) -> Twist {
    (*measured * predicted.inverse()).log()
}

impl PoseResidual for Spatial {
    fn name(&self) -> &'static str {
        "spatial"
    }

    fn residual(&self, measured: &Pose, predicted: &Pose, noise: &Noise, out: &mut [f64]) {
        let e = error(measured, predicted);
        out[..3].copy_from_slice((e.v / noise.position_m).as_slice());
        out[3..6].copy_from_slice((e.w / noise.rotation_rad).as_slice());
    }

    fn project(
        &self,
        measured: &Pose,
        predicted: &Pose,
        columns: &[TargetTwist],
        noise: &Noise,
        stride: usize,
        out: &mut [f64],
    ) {
        let e = error(measured, predicted);
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
}
