//! Position and orientation of a frame.

use nalgebra::{Matrix3, Vector3};

use super::{Noise, Residual};
use crate::lie::{Pose, TargetTwist, hat, rotation, series};

/// Measured frame, `e = [y - p; log(Y Rᵀ)]` at the target and in the device's axes (theory.md §4 (16)).
///
/// The rotation rows of the sensitivity are `J_r(r)⁻¹`, exact also for large residuals `r = log(Y Rᵀ)`.
///
/// ```
/// use poecal::lie::Pose;
/// use poecal::measurement::{Noise, PoseMeasurement, Residual};
/// let pose = Pose::from_xyz_rpy([0.1, 0.2, 0.3], [0.4, 0.5, 0.6]);
/// let mut e = [1.0; 6];
/// PoseMeasurement { pose }.residual(&pose, &Noise { position_m: 1e-3, rotation_rad: 1e-3 }, &mut e);
/// assert!(e.iter().all(|component| component.abs() < 1e-12));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PoseMeasurement {
    /// `device_from_target`.
    pub pose: Pose,
}

impl Residual for PoseMeasurement {
    fn dim(&self) -> usize {
        6
    }

    fn residual(&self, predicted: &Pose, noise: &Noise, out: &mut [f64]) {
        let position = (self.pose.translation - predicted.translation) / noise.position_m;
        let turn = rotation::log(&(self.pose.rotation * predicted.rotation.transpose())) / noise.rotation_rad;
        out[..3].copy_from_slice(position.as_slice());
        out[3..6].copy_from_slice(turn.as_slice());
    }

    fn project(
        &self,
        predicted: &Pose,
        columns: &[TargetTwist],
        noise: &Noise,
        stride: usize,
        out: &mut [f64],
    ) {
        let weight = 1.0 / noise.position_m;
        // Y (exp(ω̂) R)ᵀ = exp(r̂) exp(-ω̂), so r moves by -J_r(r)⁻¹ ω; J_r(r)⁻¹ = I + r̂/2 + cotc r̂².
        let r = rotation::log(&(self.pose.rotation * predicted.rotation.transpose()));
        let hat_r = hat(&r);
        let turn = (Matrix3::identity() + hat_r * 0.5 + hat_r * hat_r * series::cotc(r.norm_squared()))
            / noise.rotation_rad;
        for (column, (v, w)) in columns.iter().enumerate() {
            let w = turn * w;
            out[column] = v.x * weight;
            out[stride + column] = v.y * weight;
            out[2 * stride + column] = v.z * weight;
            out[3 * stride + column] = w.x;
            out[4 * stride + column] = w.y;
            out[5 * stride + column] = w.z;
        }
    }

    fn wrench(&self, predicted: &Pose, noise: &Noise) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let r = rotation::log(&(self.pose.rotation * predicted.rotation.transpose()));
        Some((
            (self.pose.translation - predicted.translation) / (noise.position_m * noise.position_m),
            r / (noise.rotation_rad * noise.rotation_rad),
        ))
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
