//! How far measurements are from what an estimate predicts.

use nalgebra::Vector3;

use super::{Estimate, Packed, map_predictions};
use crate::lie::rotation;
use crate::measurement::Dataset;

/// Error of one row: measured less predicted, device axes.
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

/// Errors of an estimate, one a row.
#[must_use]
pub fn row_errors(data: &Dataset, packed: &Packed, rows: &[u32], estimate: &Estimate) -> Vec<RowError> {
    map_predictions(data, packed, rows, estimate, |observation, predicted| {
        let model = observation.measurement.residual_model();
        RowError {
            position_m: model.position() - predicted.translation,
            rotation_rad: model
                .orientation()
                .map(|measured| rotation::log(&(measured * predicted.rotation.transpose()))),
        }
    })
}
