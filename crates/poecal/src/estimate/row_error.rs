//! How far measurements are from what an estimate predicts.

use nalgebra::Vector3;

use super::{Chain, Estimate, Linkage, Packed};
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
    let linkage = Linkage::new(estimate);
    let mut chain = Chain::default();
    rows.iter()
        .map(|&row| {
            let observation = &data.observations[row as usize];
            let model = observation.measurement.residual_model();
            chain.evaluate(&linkage, packed, row as usize, observation.target);
            RowError {
                position_m: model.position() - chain.target.translation,
                rotation_rad: model
                    .orientation()
                    .map(|measured| rotation::log(&(measured * chain.target.rotation.transpose()))),
            }
        })
        .collect()
}
