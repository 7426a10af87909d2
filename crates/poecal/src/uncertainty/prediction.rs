//! The error to expect of one predicted pose.

use nalgebra::Matrix3;

/// Covariances of a predicted target's place (square metres) and turn (square radians), device axes (theory.md §9 (40)).
///
/// ```
/// use nalgebra::Matrix3;
/// use poecal::uncertainty::PredictedError;
/// let error = PredictedError { position: Matrix3::identity() * 1e-8, rotation: Matrix3::zeros() };
/// assert!((error.sigma_position_m() - 3f64.sqrt() * 1e-4).abs() < 1e-15);
/// // Of three equal components, the distance is below 2.7955 standard deviations in 95 % of all cases.
/// assert!((error.bound_position_m() - 2.7955e-4).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictedError {
    /// Of the place, square metres.
    pub position: Matrix3<f64>,
    /// Of the rotation vector, square radians.
    pub rotation: Matrix3<f64>,
}

impl PredictedError {
    /// Root mean square distance to expect, metres.
    #[must_use]
    pub fn sigma_position_m(&self) -> f64 {
        self.position.trace().max(0.0).sqrt()
    }

    /// Root mean square angle to expect, radians.
    #[must_use]
    pub fn sigma_rotation_rad(&self) -> f64 {
        self.rotation.trace().max(0.0).sqrt()
    }

    /// Distance that is not exceeded in 95 % of all cases, metres.
    #[must_use]
    pub fn bound_position_m(&self) -> f64 {
        bound(&self.position)
    }

    /// Angle that is not exceeded in 95 % of all cases, radians.
    #[must_use]
    pub fn bound_rotation_rad(&self) -> f64 {
        bound(&self.rotation)
    }
}

/// The 95 % quantile of the length of a normal vector: its square is taken as a scaled χ² of equal mean and variance (satterthwaite1946),
/// whose quantile follows wilson1931.
#[must_use]
pub fn bound(covariance: &Matrix3<f64>) -> f64 {
    const Z: f64 = 1.644_853_626_951_472_7;
    let trace = covariance.trace();
    let squares = covariance.norm_squared();
    if trace <= 0.0 || squares <= 0.0 {
        return 0.0;
    }
    let freedom = trace * trace / squares;
    let spread = 2.0 / (9.0 * freedom);
    let quantile = freedom * (1.0 - spread + Z * spread.sqrt()).powi(3);
    (squares / trace * quantile).sqrt()
}
