//! Changes of readings or measurements that undo a hypothetical mistake.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector4};

use crate::lie::{Pose, rotation};
use crate::measurement::{
    Dataset, DirectionMeasurement, FlushMeasurement, HeightMeasurement, Measurement, Observation,
    PointMeasurement, PoseMeasurement,
};

/// A change of every row. Columns are indices of readings.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Change {
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
    /// Each reading paired with the measurement so many rows later in the same stream.
    Shift(i32, Stream),
    /// Lengths of a kind times a factor; the last says whether no other kind is measured.
    Resize(f64, Lengths, bool),
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
    pub(super) fn apply(&self, data: &Dataset) -> Dataset {
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
        let mut changed = observation.measurement;
        match &mut changed {
            Measurement::Point(PointMeasurement { position }) => {
                if let Change::Resize(factor, Lengths::Positions, _) = self {
                    *position *= *factor;
                } else if let Change::ResizeAxis(axis, factor) = self {
                    position[*axis] *= *factor;
                } else if let Change::Mirror(mirror, _) = self {
                    *position = mirror * *position;
                }
            }
            Measurement::Components(seen) => {
                if let Change::Resize(factor, Lengths::Positions, _) = self {
                    seen.position *= *factor;
                } else if let Change::ResizeAxis(axis, factor) = self {
                    seen.position[*axis] *= *factor;
                }
            }
            Measurement::Pose(PoseMeasurement { pose }) => *pose = self.pose(row, pose),
            Measurement::Distance(seen) => {
                if let Change::Resize(factor, Lengths::Distances, _) = self {
                    seen.distance *= factor;
                }
                seen.zero_is_unknown |= *self == Change::FreeZero;
            }
            Measurement::Height(HeightMeasurement { height })
            | Measurement::Flush(FlushMeasurement { height, .. }) => {
                if let Change::Resize(factor, Lengths::Heights, _) = self {
                    *height *= factor;
                }
            }
            Measurement::Direction(seen) => {
                if let Change::ScaleTilts(factor) = self {
                    *seen = DirectionMeasurement::of_tilts(seen.tilts().map(|tilt| factor * tilt));
                }
            }
            Measurement::Socket(_) => {}
        }
        changed
    }

    /// A measured pose with the change.
    fn pose(&self, row: usize, seen: &Pose) -> Pose {
        let Pose { rotation: turned, translation } = *seen;
        match self {
            Change::Resize(factor, Lengths::Positions, _) => Pose::new(turned, translation * *factor),
            Change::ResizeAxis(axis, factor) => {
                let mut place = translation;
                place[*axis] *= *factor;
                Pose::new(turned, place)
            }
            Change::Scale(..)
            | Change::Scales(_)
            | Change::Exchange(..)
            | Change::Combine { .. }
            | Change::Add(..)
            | Change::Shift(..)
            | Change::Resize(..)
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

/// What is measured as a length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lengths {
    /// Coordinates of positions.
    Positions,
    /// Distances, and radii of spheres.
    Distances,
    /// Heights over planes.
    Heights,
}

impl Lengths {
    /// All of them.
    pub(super) const ALL: [Lengths; 3] = [Lengths::Positions, Lengths::Distances, Lengths::Heights];

    /// Its name.
    pub(super) fn words(self) -> &'static str {
        match self {
            Lengths::Positions => "positions",
            Lengths::Distances => "distances",
            Lengths::Heights => "heights",
        }
    }

    /// Whether a measurement has one, other than zero.
    pub(super) fn is_of(self, seen: &Measurement) -> bool {
        match seen {
            Measurement::Point(_) | Measurement::Components(_) | Measurement::Pose(_) => {
                self == Lengths::Positions
            }
            Measurement::Distance(seen) => self == Lengths::Distances && seen.distance != 0.0,
            Measurement::Height(HeightMeasurement { height })
            | Measurement::Flush(FlushMeasurement { height, .. }) => {
                self == Lengths::Heights && *height != 0.0
            }
            Measurement::Socket(_) | Measurement::Direction(_) => false,
        }
    }
}

/// Rows that a shift counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stream {
    /// Those of the same target.
    Target,
    /// All rows: the target's name stays with the reading.
    File,
}

/// A data set without rows, with the same readings, targets and places.
pub(super) fn like(data: &Dataset) -> Dataset {
    let mut empty = data.only(&[]);
    empty.pose_residual = None;
    empty
}

/// Adds a row, unless the change made it not finite.
pub(super) fn push(data: &mut Dataset, readings: &[f64], observation: Observation) {
    data.push_observation(readings, observation).ok();
}

/// Readings of each row with the measurement of the same stream and file `by` such rows later.
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
