//! The residual of lou2009 for measured frames.

use nalgebra::{Matrix6, Vector3};
use poecal_arm::lie::{Pose, Twist};
use poecal_model::measurement::{PoseResidual, Sensitivity};

/// The paper's residual of a measured frame, `e = log(Y P⁻¹)^∨` (lou2009 after equation 7): the twist about the *device's* origin that moves the
/// predicted frame to the measured one, linear part first.
///
/// Its sensitivity is `J_r(e)⁻¹ = J_l(-e)⁻¹` on the spatial twist, exact also for large residuals. To first order the linear part is
/// `(y - p) + p × r`, so rotation noise counts as position noise times the distance. [`poecal_model::measurement::Measurement`] has the form of a
/// device's data sheet; this form serves comparison (docs/theory.md §4 (16a)).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpatialResidual;

fn error(measured: &Pose, predicted: &Pose) -> Twist {
    (*measured * predicted.inverse()).log()
}

impl PoseResidual for SpatialResidual {
    fn name(&self) -> &'static str {
        "spatial"
    }

    fn residual(&self, measured: &Pose, predicted: &Pose, out: &mut [f64]) {
        let e = error(measured, predicted);
        out[..3].copy_from_slice(e.v.as_slice());
        out[3..6].copy_from_slice(e.w.as_slice());
    }

    fn sensitivity(&self, measured: &Pose, predicted: &Pose, out: &mut [Sensitivity]) {
        let e = error(measured, predicted);
        let of_spatial: Matrix6<f64> = Twist::new(-e.v, -e.w).inverse_left_jacobian();
        for k in 0..3 {
            // Unit motions of the target, as twists about the device's origin.
            let unit = Vector3::ith(k, 1.0);
            let moved = of_spatial * Twist::new(unit, Vector3::zeros()).to_vector();
            let turned = of_spatial * Twist::new(predicted.translation.cross(&unit), unit).to_vector();
            for (row, out) in out[..6].iter_mut().enumerate() {
                (out[k], out[3 + k]) = (moved[row], turned[row]);
            }
        }
    }
}
