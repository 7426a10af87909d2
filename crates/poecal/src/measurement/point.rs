//! Position of a point: lou2009 (19) to (26).

use nalgebra::{Matrix3, Vector3};

use super::{Noise, Residual};
use crate::lie::{Pose, TargetTwist};

/// Measured position of a target point, `e = y - p`, `S = [I 0]` in target-centred form (theory.md §4 (15)).
///
/// ```
/// use nalgebra::Vector3;
/// use poecal::lie::Pose;
/// use poecal::measurement::{Noise, PointMeasurement, Residual};
/// let seen = PointMeasurement { position: Vector3::new(0.0, 0.0, 0.002) };
/// let mut e = [0.0; 3];
/// seen.residual(&Pose::identity(), &Noise { position_m: 0.001, rotation_rad: 1.0 }, &mut e);
/// assert_eq!(e, [0.0, 0.0, 2.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PointMeasurement {
    /// Position in the device's frame, metres.
    pub position: Vector3<f64>,
}

impl Residual for PointMeasurement {
    fn dim(&self) -> usize {
        3
    }

    fn residual(&self, predicted: &Pose, noise: &Noise, out: &mut [f64]) {
        let e = (self.position - predicted.translation) / noise.position_m;
        out[..3].copy_from_slice(e.as_slice());
    }

    fn project(&self, _: &Pose, columns: &[TargetTwist], noise: &Noise, stride: usize, out: &mut [f64]) {
        let weight = 1.0 / noise.position_m;
        for (column, (v, _)) in columns.iter().enumerate() {
            out[column] = v.x * weight;
            out[stride + column] = v.y * weight;
            out[2 * stride + column] = v.z * weight;
        }
    }

    fn wrench(&self, predicted: &Pose, noise: &Noise) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let force = (self.position - predicted.translation) / (noise.position_m * noise.position_m);
        Some((force, Vector3::zeros()))
    }

    fn rotation_row(&self) -> usize {
        3
    }

    fn position(&self) -> Vector3<f64> {
        self.position
    }

    fn orientation(&self) -> Option<Matrix3<f64>> {
        None
    }
}
