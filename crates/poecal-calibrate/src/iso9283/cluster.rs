//! Measured positions of each pose beside its command, for pictures.

use nalgebra::Vector3;

use super::frame::RegisteredBarycentres;
use super::intervals::mean_and_covariance;
use super::rows::PoseCell;
use poecal_numerics::distributions::f_quantile;

/// Points of the rim of an ellipse.
const RIM: usize = 48;

/// Measured positions of a pose, base frame.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseCluster {
    /// The pose, `P1`.
    pub pose: String,
    /// Commanded position, metres.
    pub commanded_m: Vector3<f64>,
    /// Measured less commanded positions, a row each, metres.
    pub errors_m: Vec<Vector3<f64>>,
    /// Error of the barycentre that is predicted for corrected commands, metres.
    pub corrected_m: Option<Vector3<f64>>,
}

impl PoseCluster {
    pub(super) fn new(
        cell: &PoseCell<'_>,
        k: usize,
        found: &RegisteredBarycentres,
        corrected: Option<&RegisteredBarycentres>,
    ) -> Self {
        let commanded_m = cell.commanded_pose().translation;
        let error = |place: &Vector3<f64>| found.base_from_device.act(place) - commanded_m;
        PoseCluster {
            pose: cell.pose.clone(),
            commanded_m,
            errors_m: cell.rows.iter().map(|row| error(&row.position_m)).collect(),
            corrected_m: corrected.map(|it| it.errors[k]),
        }
    }

    /// Error of the barycentre, metres.
    #[must_use]
    pub fn barycentre_m(&self) -> Vector3<f64> {
        mean_and_covariance(self.errors_m.iter().copied()).0
    }

    /// Rim of the ellipse about the barycentre in the plane of two axes in which the position of the next cycle lies with 95 % probability:
    /// `d² ≤ 2 (n² - 1) / (n (n - 2)) F(2, n - 2)` of normally distributed positions. Metres, a closed line.
    #[must_use]
    pub fn ellipse_m(&self, [across, up]: [usize; 2]) -> Vec<[f64; 2]> {
        let (mean, covariance) = mean_and_covariance(self.errors_m.iter().copied());
        let count = self.errors_m.len() as f64;
        let freedom = (count - 2.0).max(1.0);
        let radius = (2.0 * (count * count - 1.0) / (count * freedom) * f_quantile(0.05, 2.0, freedom)).sqrt();
        // Cholesky's factor of the covariance in the plane.
        let first = covariance[(across, across)].max(0.0).sqrt();
        let mixed = if first > 0.0 { covariance[(up, across)] / first } else { 0.0 };
        let second = (covariance[(up, up)] - mixed * mixed).max(0.0).sqrt();
        let rim = |k: usize| {
            let (s, c) = (std::f64::consts::TAU * k as f64 / RIM as f64).sin_cos();
            [mean[across] + radius * first * c, mean[up] + radius * (mixed * c + second * s)]
        };
        (0..=RIM).map(rim).collect()
    }
}
