//! Changes of readings or measurements that undo a hypothetical mistake.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector4};

use poecal_arm::lie::{Pose, rotation};
use poecal_model::measurement::{Dataset, Measurement, Observation, Quantity};

/// A change of every row. Columns are indices of readings.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Change {
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
    Shift(i32, Stream),
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

impl Change {
    /// The data with the change. Rows without a partner after a shift are dropped.
    pub(crate) fn apply(&self, data: &Dataset) -> Dataset {
        if let Change::Shift(by, stream) = self {
            return shifted(data, *by, *stream);
        }
        let mut changed = like(data);
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
            Change::Scale(columns, factor) => {
                columns.iter().for_each(|&column| readings[column] *= factor);
            }
            Change::Scales(factors) => {
                readings.iter_mut().zip(factors).for_each(|(reading, factor)| *reading *= factor);
            }
            Change::Exchange(a, b) => readings.swap(*a, *b),
            Change::Combine { column, own, other, factor } => {
                readings[*column] = own * readings[*column] + factor * readings[*other];
            }
            Change::Add(column, offset) => readings[*column] += offset,
            Change::Shift(..)
            | Change::Resize(..)
            | Change::ResizeFile(..)
            | Change::ResizeAxis(..)
            | Change::FreeZero
            | Change::ScaleTilts(_)
            | Change::Quaternion(_)
            | Change::Invert
            | Change::Transpose
            | Change::Turn(_)
            | Change::Mirror(..) => {}
        }
    }

    fn measurement(&self, row: usize, observation: &Observation) -> Measurement {
        let seen = observation.measurement;
        match self {
            Change::Resize(factor, quantity, _) => {
                let mut resized = seen;
                if seen.function().leading() == *quantity {
                    resized.lengths_mut().iter_mut().for_each(|length| *length *= factor);
                }
                resized
            }
            Change::ResizeAxis(axis, factor) => {
                let mut resized = seen;
                if seen.has(Quantity::Position) {
                    resized.lengths_mut()[*axis] *= factor;
                }
                resized
            }
            Change::ResizeFile(factor, file) => {
                let mut resized = seen;
                if observation.source.file == *file && seen.has(Quantity::Position) {
                    resized.lengths_mut().iter_mut().for_each(|length| *length *= factor);
                }
                resized
            }
            Change::FreeZero => seen.with_unknown_zero(),
            Change::ScaleTilts(factor) => seen.with_angles_times(*factor),
            Change::Mirror(mirror, _) if !seen.sees_orientation() => {
                seen.changed(|pose| Pose::from_translation(mirror * pose.translation)).unwrap_or(seen)
            }
            Change::Quaternion(_)
            | Change::Invert
            | Change::Transpose
            | Change::Turn(_)
            | Change::Mirror(..) => {
                seen.frame().map_or(seen, |pose| Measurement::of_pose(&self.pose(row, &pose)))
            }
            Change::Scale(..)
            | Change::Scales(_)
            | Change::Exchange(..)
            | Change::Combine { .. }
            | Change::Add(..)
            | Change::Shift(..) => seen,
        }
    }

    /// A measured pose with the change.
    fn pose(&self, row: usize, seen: &Pose) -> Pose {
        let Pose { rotation: turned, translation } = *seen;
        match self {
            Change::Scale(..)
            | Change::Scales(_)
            | Change::Exchange(..)
            | Change::Combine { .. }
            | Change::Add(..)
            | Change::Shift(..)
            | Change::Resize(..)
            | Change::ResizeFile(..)
            | Change::ResizeAxis(..)
            | Change::FreeZero
            | Change::ScaleTilts(_) => *seen,
            Change::Quaternion(places) => {
                let q = rotation::to_quaternion_xyzw(&turned);
                let [x, y, z, w] = places.map(|place| q[place]);
                Pose::new(rotation::from_quaternion_xyzw(&Vector4::new(x, y, z, w)), translation)
            }
            Change::Invert => seen.inverse(),
            Change::Transpose => Pose::new(turned.transpose(), translation),
            Change::Turn(others) => {
                Pose::new(others.get(row).copied().flatten().unwrap_or(turned), translation)
            }
            Change::Mirror(mirror, turns) => {
                let turned = if *turns { mirror * turned * mirror } else { turned };
                Pose::new(turned, mirror * translation)
            }
        }
    }
}

/// Rows that a shift counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stream {
    /// Rows of the same target.
    Target,
    /// All rows: the target's name stays with the reading.
    File,
}

/// A data set without rows, with the same readings, targets and stations.
pub(crate) fn like(data: &Dataset) -> Dataset {
    let mut empty = data.only(&[]);
    empty.pose_residual = None;
    empty
}

/// Adds a row, unless the change made it not finite.
pub(crate) fn push(data: &mut Dataset, readings: &[f64], observation: Observation) {
    data.push_observation(readings, observation).ok();
}

/// Readings of each row with the measurement `by` rows later in the same stream and file.
fn shifted(data: &Dataset, by: i32, stream: Stream) -> Dataset {
    let mut streams: BTreeMap<(Option<usize>, u32), Vec<usize>> = BTreeMap::new();
    for (row, observation) in data.observations.iter().enumerate() {
        let target = (stream == Stream::Target).then_some(observation.target);
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
    let mut changed = like(data);
    for (row, to) in partner.iter().enumerate() {
        if let Some(to) = *to {
            let measurement = data.observations[to].measurement;
            push(&mut changed, data.readings(row), Observation { measurement, ..data.observations[row] });
        }
    }
    changed
}
