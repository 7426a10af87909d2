//! The covariance of the changes between two calibrations, and tests with it.

use nalgebra::{DMatrix, DVector};

use super::ChiSquare;
use crate::calibration_file::CalibrationFile;
use poecal_fit::gauge::screw_motions;
use poecal_model::offsets::{Changes, JointChange};
use poecal_model::robot::JointKind;
use poecal_numerics::distributions::upper_quantile;
use poecal_numerics::error::Result;
use poecal_numerics::linalg;

/// Numbers of a joint: offset, tilt, shift.
const PARTS: usize = 7;
/// Share of the largest eigenvalue below which a direction counts as undetermined: rounding.
const NONE: f64 = 1e-10;
/// Largest difference of held values, metres: rounding of files and of the alignment.
const HELD_M: f64 = 1e-7;

/// Covariance of the changes of all joints, square metres, angles times a length.
pub(crate) struct ChangeCovariance {
    covariance: DMatrix<f64>,
    length_m: f64,
}

impl ChangeCovariance {
    /// The sum of the covariances of both calibrations; `None` if one has no uncertainty.
    pub(crate) fn from_changes(changes: &Changes, files: [&CalibrationFile; 2]) -> Result<Option<Self>> {
        let length_m = changes.length_m();
        let size = PARTS * changes.joints.len();
        let mut covariance = DMatrix::zeros(size, size);
        for file in files {
            if file.uncertainty.is_none() {
                return Ok(None);
            }
            let (found, _) = file.uncertainty(&[])?;
            let n = found.layout.dim();
            let by_steps = changes.by_steps(&screw_motions(&found.estimate, &found.layout));
            let mut rows = DMatrix::zeros(size, n);
            for (joint, (entry, change)) in by_steps.iter().zip(&changes.joints).enumerate() {
                let offset = change.offset.map_or(0.0, |_| unit(change.kind, length_m));
                let tilts = entry.tilt.iter().map(|row| (row, length_m));
                let shifts = entry.shift.iter().map(|row| (row, 1.0));
                let all = std::iter::once((&entry.offset, offset)).chain(tilts).chain(shifts);
                for (part, (row, scale)) in all.enumerate() {
                    for (k, value) in row.iter().enumerate() {
                        rows[(PARTS * joint + part, k)] = scale * value;
                    }
                }
            }
            covariance += &rows * DMatrix::from_row_slice(n, n, &found.covariance) * rows.transpose();
        }
        Ok(Some(ChangeCovariance { covariance, length_m }))
    }

    /// A joint's change with its standard deviations.
    pub(crate) fn with_sigmas(&self, joint: usize, change: &JointChange) -> JointChange {
        let variance = |part: usize| {
            let at = PARTS * joint + part;
            self.covariance[(at, at)].max(0.0)
        };
        let sum = |parts: std::ops::Range<usize>| parts.map(variance).sum::<f64>().sqrt();
        let turns = change.kind == JointKind::Revolute;
        JointChange {
            sigma_offset: change.offset.map(|_| variance(0).sqrt() / unit(change.kind, self.length_m)),
            sigma_tilt: Some(sum(1..4) / self.length_m),
            sigma_shift: turns.then(|| sum(4..7)),
            is_estimated: true,
            ..*change
        }
    }

    /// The test of some joints, which noise fails with a probability of `chance`.
    pub(crate) fn test(&self, joints: &[usize], changes: &Changes, chance: f64) -> ChiSquare {
        let places: Vec<usize> =
            joints.iter().flat_map(|joint| (0..PARTS).map(move |part| PARTS * joint + part)).collect();
        let of = |place: &usize| -> f64 {
            let (Some(change), part) = (changes.joints.get(place / PARTS), place % PARTS) else { return 0.0 };
            match part {
                0 => change.offset.unwrap_or(0.0) * unit(change.kind, self.length_m),
                1..4 => change.tilt[part - 1] * self.length_m,
                _ => change.shift[part - 4],
            }
        };
        let size = places.len();
        let difference = DVector::from_iterator(size, places.iter().map(of));
        let upper: Vec<f64> = (0..size * size).map(|k| self.covariance[(places[k / size], places[k % size])]).collect();
        let (values, vectors) = linalg::symmetric_eigen(&upper, size);
        let largest = values.last().copied().unwrap_or(0.0);
        let (mut value, mut freedom) = (0.0, 0);
        for (variance, direction) in values.iter().zip(vectors.column_iter()) {
            if *variance > NONE * largest {
                value += direction.dot(&difference).powi(2) / variance;
                freedom += 1;
            }
        }
        // Values that both calibrations held have no noise: any difference is a change.
        if freedom == 0 && difference.norm() > HELD_M {
            (value, freedom) = ((difference.norm() / HELD_M).powi(2), 1);
        }
        let limit = if freedom == 0 { 0.0 } else { upper_quantile(chance, freedom) };
        ChiSquare { value, freedom, limit }
    }
}

/// Metres that one unit of an offset equals.
fn unit(kind: JointKind, length_m: f64) -> f64 {
    if kind == JointKind::Revolute { length_m } else { 1.0 }
}
