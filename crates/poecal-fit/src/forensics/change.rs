//! Changes of readings or measurements that undo a hypothetical mistake.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector4};

use poecal_arm::lie::{Pose, rotation};
use poecal_model::measurement::{Dataset, Measurement, Observation, Quantity};

/// A change of every row. Columns are indices of readings.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum RowChange {
    /// Readings of some columns times a factor.
    Scale(Vec<usize>, f64),
    /// Each column times a factor of its own.
    Scales(Vec<f64>),
    /// Two columns exchanged.
    Exchange(usize, usize),
    /// A column times the first factor, plus another times the second.
    Combine { column: usize, own: f64, other: usize, factor: f64 },
    /// A number added to a column, radians or metres.
    Add(usize, f64),
    /// Each reading paired with the measurement this many rows later in the same stream.
    Shift(i32, ShiftedRows),
    /// Lengths of a quantity times a factor; the last is true if no other quantity is measured.
    Resize(f64, Quantity, bool),
    /// Positions of the rows of a file times a factor.
    ResizeFile(f64, u32),
    /// One coordinate of positions times a factor.
    ResizeAxis(usize, f64),
    /// The zero of all distances unknown.
    FreeZero,
    /// Tilts of directions times a factor.
    ScaleTilts(f64),
    /// Parts of the quaternion to be taken as x, y, z, w.
    Quaternion([usize; 4]),
    /// Poses inverted.
    Invert,
    /// Orientations inverted, positions kept.
    Transpose,
    /// Orientations replaced, one for each row.
    Turn(Vec<Option<Matrix3<f64>>>),
    /// Positions mirrored; orientations too if true.
    Mirror(Matrix3<f64>, bool),
}

impl RowChange {
    /// The data with the change. Rows without a partner after a shift are dropped.
    pub(crate) fn apply(&self, data: &Dataset) -> Dataset {
        if let RowChange::Shift(by, stream) = self {
            return shift_rows(data, *by, *stream);
        }
        let mut changed = empty_like(data);
        changed.change_further(|readings| self.change_readings(readings));
        let mut readings = Vec::new();
        for (row, observation) in data.observations.iter().enumerate() {
            readings.clear();
            readings.extend_from_slice(data.readings(row));
            self.change_readings(&mut readings);
            let measurement = self.measurement(row, observation);
            push(&mut changed, &readings, Observation { measurement, ..*observation });
        }
        changed
    }

    fn change_readings(&self, readings: &mut [f64]) {
        match self {
            RowChange::Scale(columns, factor) => {
                columns.iter().for_each(|&column| readings[column] *= factor);
            }
            RowChange::Scales(factors) => {
                readings.iter_mut().zip(factors).for_each(|(reading, factor)| *reading *= factor);
            }
            RowChange::Exchange(a, b) => readings.swap(*a, *b),
            RowChange::Combine { column, own, other, factor } => {
                readings[*column] = own * readings[*column] + factor * readings[*other];
            }
            RowChange::Add(column, offset) => readings[*column] += offset,
            RowChange::Shift(..)
            | RowChange::Resize(..)
            | RowChange::ResizeFile(..)
            | RowChange::ResizeAxis(..)
            | RowChange::FreeZero
            | RowChange::ScaleTilts(_)
            | RowChange::Quaternion(_)
            | RowChange::Invert
            | RowChange::Transpose
            | RowChange::Turn(_)
            | RowChange::Mirror(..) => {}
        }
    }

    fn measurement(&self, row: usize, observation: &Observation) -> Measurement {
        let seen = observation.measurement;
        match self {
            RowChange::Resize(factor, quantity, _) => {
                let mut resized = seen;
                if seen.function().leading_quantity() == *quantity {
                    resized.lengths_mut().iter_mut().for_each(|length| *length *= factor);
                }
                resized
            }
            RowChange::ResizeAxis(axis, factor) => {
                let mut resized = seen;
                if seen.has(Quantity::Position) {
                    resized.lengths_mut()[*axis] *= factor;
                }
                resized
            }
            RowChange::ResizeFile(factor, file) => {
                let mut resized = seen;
                if observation.source.file == *file && seen.has(Quantity::Position) {
                    resized.lengths_mut().iter_mut().for_each(|length| *length *= factor);
                }
                resized
            }
            RowChange::FreeZero => seen.with_unknown_zero(),
            RowChange::ScaleTilts(factor) => seen.with_angles_times(*factor),
            RowChange::Mirror(mirror, _) if !seen.sees_orientation() => {
                seen.map_pose(|pose| Pose::from_translation(mirror * pose.translation)).unwrap_or(seen)
            }
            RowChange::Quaternion(_)
            | RowChange::Invert
            | RowChange::Transpose
            | RowChange::Turn(_)
            | RowChange::Mirror(..) => seen.frame().map_or(seen, |pose| Measurement::of_pose(&self.pose(row, &pose))),
            RowChange::Scale(..)
            | RowChange::Scales(_)
            | RowChange::Exchange(..)
            | RowChange::Combine { .. }
            | RowChange::Add(..)
            | RowChange::Shift(..) => seen,
        }
    }

    /// A measured pose with the change.
    fn pose(&self, row: usize, seen: &Pose) -> Pose {
        let Pose { rotation: turned, translation } = *seen;
        match self {
            RowChange::Scale(..)
            | RowChange::Scales(_)
            | RowChange::Exchange(..)
            | RowChange::Combine { .. }
            | RowChange::Add(..)
            | RowChange::Shift(..)
            | RowChange::Resize(..)
            | RowChange::ResizeFile(..)
            | RowChange::ResizeAxis(..)
            | RowChange::FreeZero
            | RowChange::ScaleTilts(_) => *seen,
            RowChange::Quaternion(places) => {
                let q = rotation::to_quaternion_xyzw(&turned);
                let [x, y, z, w] = places.map(|place| q[place]);
                Pose::new(rotation::from_quaternion_xyzw(&Vector4::new(x, y, z, w)), translation)
            }
            RowChange::Invert => seen.inverse(),
            RowChange::Transpose => Pose::new(turned.transpose(), translation),
            RowChange::Turn(others) => Pose::new(others.get(row).copied().flatten().unwrap_or(turned), translation),
            RowChange::Mirror(mirror, turns) => {
                let turned = if *turns { mirror * turned * mirror } else { turned };
                Pose::new(turned, mirror * translation)
            }
        }
    }
}

/// Rows that a shift counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ShiftedRows {
    /// Rows of the same target.
    Target,
    /// All rows: the target's name stays with the reading.
    File,
}

/// A data set without rows, with the same readings, targets and stations.
pub(crate) fn empty_like(data: &Dataset) -> Dataset {
    let mut empty = data.select_rows(&[]);
    empty.pose_residual = None;
    empty
}

/// Adds a row, unless the change made it not finite.
pub(crate) fn push(data: &mut Dataset, readings: &[f64], observation: Observation) {
    data.push_observation(readings, observation).ok();
}

/// Readings of each row with the measurement `by` rows later in the same stream and file.
fn shift_rows(data: &Dataset, by: i32, stream: ShiftedRows) -> Dataset {
    let mut streams: BTreeMap<(Option<usize>, u32), Vec<usize>> = BTreeMap::new();
    for (row, observation) in data.observations.iter().enumerate() {
        let target = (stream == ShiftedRows::Target).then_some(observation.target);
        streams.entry((target, observation.source.file)).or_default().push(row);
    }
    let mut partner = vec![None; data.len()];
    let distance = by.unsigned_abs() as usize;
    for rows in streams.values() {
        for pair in rows.windows(distance + 1) {
            let (first, last) = (pair[0], pair[distance]);
            let (from, to) = if by > 0 { (first, last) } else { (last, first) };
            partner[from] = Some(to);
        }
    }
    let mut changed = empty_like(data);
    for (row, to) in partner.iter().enumerate() {
        if let Some(to) = *to {
            let measurement = data.observations[to].measurement;
            push(&mut changed, data.readings(row), Observation { measurement, ..data.observations[row] });
        }
    }
    changed
}
