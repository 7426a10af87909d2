//! The error of one row.

use nalgebra::Vector3;

/// Error of one row: measured minus predicted, in the device's axes; `y - p` and `log(Y Rᵀ)` of theory.md §4 (16).
///
/// ```
/// use nalgebra::Vector3;
/// let error = poecal::estimate::RowError { position_m: Vector3::x(), rotation_rad: None };
/// assert_eq!(error.position_m.norm(), 1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowError {
    /// Position, metres.
    pub position_m: Vector3<f64>,
    /// Rotation vector, radians, if orientation was measured.
    pub rotation_rad: Option<Vector3<f64>>,
}

/// Root mean square length of position errors, metres: theory.md §9. 0 without errors.
pub(crate) fn position_rms_m(errors: &[RowError]) -> f64 {
    let squares: f64 = errors.iter().map(|error| error.position_m.norm_squared()).sum();
    (squares / errors.len().max(1) as f64).sqrt()
}
