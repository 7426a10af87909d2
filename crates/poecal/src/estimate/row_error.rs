//! How far measurements are from what an estimate predicts.

use nalgebra::Vector3;

use super::predictions::map_errors;
use super::{Estimate, Packed};
use crate::measurement::{Dataset, Noise, Observation, Residual as _, Written};

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
    map_errors(data, packed, rows, estimate, |_, error, _| error)
}

/// Turns errors of some rows from the axes of the place that each was seen from to those of the first, in which they can be compared.
pub(crate) fn turn_to_first(data: &Dataset, rows: &[u32], estimate: &Estimate, errors: &mut [RowError]) {
    if data.station_count() == 1 {
        return;
    }
    for (&row, error) in rows.iter().zip(errors) {
        let own = estimate.device(data.observations[row as usize].station).rotation;
        let turn = estimate.device_from_base.rotation * own.transpose();
        error.position_m = turn * error.position_m;
        error.rotation_rad = error.rotation_rad.map(|rotation| turn * rotation);
    }
}

/// What `each` makes of a row and of its residual's two parts, position and rotation (m², rad²): the sum of squares, and of how many numbers.
pub(crate) fn map_squares<T: Send>(
    data: &Dataset,
    packed: &Packed,
    rows: &[u32],
    estimate: &Estimate,
    each: impl Fn(&Observation, [(f64, usize); 2]) -> T + Sync,
) -> Vec<T> {
    const UNIT: Noise = Noise { position_m: 1.0, rotation_rad: 1.0 };
    map_errors(data, packed, rows, estimate, |observation, error, predicted| {
        let squares = match Written::new(&observation.measurement, data.pose_residual) {
            Written::Usual(_) => {
                let rotation = error.rotation_rad.map_or((0.0, 0), |turn| (turn.norm_squared(), 3));
                [(error.position_m.norm_squared(), 3), rotation]
            }
            Written::Other(pose) => {
                let mut e = [0.0; 6];
                pose.residual(&predicted(), &UNIT, &mut e);
                let (position, rotation) = e.split_at(pose.rotation_row());
                [position, rotation].map(|part| (part.iter().map(|e| e * e).sum(), part.len()))
            }
        };
        each(observation, squares)
    })
}
