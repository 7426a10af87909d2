//! Position and orientation of a frame.

use nalgebra::{Matrix3, Vector3};

use super::point::XYZ;
use super::{Channel, Channels, Observe, Quantity, Sensitivity};
use crate::lie::{Pose, hat, rotation, series};

/// Measured frame, `e = [y - p; log(Y Rᵀ)]` at the target and in the device's axes (theory.md §4 (16)).
///
/// The rotation rows of the sensitivity are `J_r(r)⁻¹`, exact also for large residuals `r = log(Y Rᵀ)`.
///
/// ```
/// use poecal::lie::Pose;
/// use poecal::measurement::{Observe, PoseMeasurement};
/// let pose = Pose::from_xyz_rpy([0.1, 0.2, 0.3], [0.4, 0.5, 0.6]);
/// let mut e = [1.0; 6];
/// PoseMeasurement { pose }.residual(&pose, &mut e);
/// assert!(e.iter().all(|component| component.abs() < 1e-15));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PoseMeasurement {
    /// `device_from_target`.
    pub pose: Pose,
}

/// The channels of a pose: position, then rotation vector.
pub(super) const POSE: Channels = Channels::new(&[
    XYZ[0],
    XYZ[1],
    XYZ[2],
    Channel { name: "rx", quantity: Quantity::Rotation },
    Channel { name: "ry", quantity: Quantity::Rotation },
    Channel { name: "rz", quantity: Quantity::Rotation },
]);

impl Observe for PoseMeasurement {
    fn channels(&self) -> &'static Channels {
        &POSE
    }

    fn residual(&self, predicted: &Pose, out: &mut [f64]) {
        let turn = rotation::log(&(self.pose.rotation * predicted.rotation.transpose()));
        out[..3].copy_from_slice((self.pose.translation - predicted.translation).as_slice());
        out[3..6].copy_from_slice(turn.as_slice());
    }

    fn sensitivity(&self, predicted: &Pose, out: &mut [Sensitivity]) {
        // Y (exp(ω̂) R)ᵀ = exp(r̂) exp(-ω̂), so r moves by -J_r(r)⁻¹ ω; J_r(r)⁻¹ = I + r̂/2 + cotc r̂².
        let r = rotation::log(&(self.pose.rotation * predicted.rotation.transpose()));
        let hat_r = hat(&r);
        let turn = Matrix3::identity() + hat_r * 0.5 + hat_r * hat_r * series::cotc(r.norm_squared());
        for k in 0..3 {
            (out[k], out[3 + k]) = ([0.0; 6], [0.0; 6]);
            out[k][k] = 1.0;
            for (number, value) in out[3 + k][3..].iter_mut().zip(turn.row(k).iter()) {
                *number = *value;
            }
        }
    }

    fn is_wrench(&self) -> bool {
        true
    }

    fn position(&self) -> Option<Vector3<f64>> {
        Some(self.pose.translation)
    }

    fn orientation(&self) -> Option<Matrix3<f64>> {
        Some(self.pose.rotation)
    }

    fn sees_orientation(&self) -> bool {
        true
    }

    fn is_finite(&self) -> bool {
        let Pose { translation, rotation } = &self.pose;
        translation.iter().chain(rotation.iter()).all(|number| number.is_finite())
    }
}
