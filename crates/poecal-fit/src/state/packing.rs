//! Joint values of every row with their sines and cosines, computed once and not in each iteration.

use std::sync::Arc;

use rayon::prelude::*;

use poecal_model::measurement::Dataset;
use poecal_model::robot::{JointKind, JointTerm, Robot, Situation, Term, TermFunctions};
use poecal_numerics::kernels::{self as lanes, SimdLevel};
use poecal_numerics::threads;

/// Rows that one thread takes at a time.
const CHUNK: usize = 1024;

/// Joint values θ of all rows, flat: `n` joints a row, radians or metres. Beside θ, `(cos θ, sin θ)` of a revolute joint and `(θ, 0)` of a
/// prismatic one.
#[derive(Clone, Debug, PartialEq)]
pub struct PackedValues {
    joints: usize,
    kinds: Vec<JointKind>,
    values: Vec<(f64, f64)>,
    angles: Vec<f64>,
    /// The terms of the robot, and their functions b in each row.
    terms: Arc<[(usize, Term)]>,
    bases: Vec<f64>,
    /// Rate of each joint value in rows that were measured in motion (rad/s, m/s), and their times from the middle of all, seconds; empty if
    /// there are none.
    rates: Vec<f64>,
    times_s: Vec<f64>,
    /// Configurations of instruments that differ from those of the targets, in rows of their own.
    further: Option<Box<PackedValues>>,
}

impl PackedValues {
    /// Packs the joint values `θ = m ρ + c` (theory.md §2 (7)) of readings (radians, metres), `width` a row in the order of
    /// [`Robot::reading_names`].
    #[must_use]
    pub fn new(robot: &Robot, readings: &[f64], width: usize) -> Self {
        let (indices, width) = (robot.reading_indices(), width.max(1));
        let factors = |row: usize| robot.factors_of(&readings[row * width..][..width]);
        PackedValues::fill(robot, readings.len() / width, factors, |first, angles| {
            let rows = readings[first * width..].chunks_exact(width);
            for (angles, row) in angles.chunks_exact_mut(indices.len().max(1)).zip(rows) {
                for ((angle, joint), &index) in angles.iter_mut().zip(&robot.joints).zip(&indices) {
                    *angle = joint.reading.value(row[index]);
                }
            }
        })
    }

    /// Packs the joint values of a data set's rows, theory.md §2 (7).
    #[must_use]
    pub fn from_dataset(robot: &Robot, data: &Dataset) -> Self {
        let width = data.reading_names().len();
        let mut packed = PackedValues::new(robot, data.all_readings(), width);
        if !data.further_readings().is_empty() {
            packed.further = Some(Box::new(PackedValues::new(robot, data.further_readings(), width)));
        }
        if !data.moving.times_s.is_empty() {
            packed.move_as(robot, data);
        }
        packed
    }

    /// Packs the rates of joint values, of rows that were measured in motion.
    fn move_as(&mut self, robot: &Robot, data: &Dataset) {
        let indices = robot.reading_indices();
        for observation in &data.observations {
            let (rates, time_s) = data.motion(observation).unwrap_or_default();
            self.times_s.push(time_s);
            self.rates.extend(robot.joints.iter().zip(&indices).map(|(joint, &index)| {
                let rate = rates.get(index).copied().unwrap_or_default();
                joint.reading.value(rate) - joint.reading.value(0.0)
            }));
        }
    }

    /// Rates of the joint values of a row (rad/s, m/s), and its time, seconds; `None` if all rows were measured at rest.
    pub(crate) fn motion(&self, row: usize) -> Option<(&[f64], f64)> {
        Some((self.rates.get(row * self.joints..(row + 1) * self.joints)?, *self.times_s.get(row)?))
    }

    /// True if these are the joint values of a data set's rows.
    pub fn is_of(&self, robot: &Robot, data: &Dataset) -> bool {
        let indices = robot.reading_indices();
        let is_row = |row| {
            let (values, readings) = (self.joint_values(row), data.readings(row));
            let mut joints = values.iter().zip(&robot.joints).zip(&indices);
            joints.all(|((&value, joint), &index)| joint.reading.value(readings[index]) == value)
        };
        self.rows() == data.len() && self.joints == robot.joints.len() && (0..self.rows()).all(is_row)
    }

    /// Packs joint values (radians, metres), one a joint and row.
    #[must_use]
    pub fn of_values(robot: &Robot, values: &[f64]) -> Self {
        let joints = robot.joints.len().max(1);
        PackedValues::fill(
            robot,
            values.len() / joints,
            |_| &[],
            |first, angles| {
                angles.copy_from_slice(&values[first * joints..][..angles.len()]);
            },
        )
    }

    /// Packs `rows` rows with their factors; `put` writes the joint values from a first row on.
    fn fill<'a>(
        robot: &Robot,
        rows: usize,
        factors: impl Fn(usize) -> &'a [f64] + Sync,
        put: impl Fn(usize, &mut [f64]) + Sync,
    ) -> Self {
        let joints = robot.joints.len();
        let kinds: Vec<JointKind> = robot.joints.iter().map(|joint| joint.kind).collect();
        let mut angles = vec![0.0; rows * joints];
        let mut values = vec![(0.0, 0.0); rows * joints];
        let fill = |first: usize, angles: &mut [f64], values: &mut [(f64, f64)]| {
            put(first, angles);
            lanes::cosines_and_sines(SimdLevel::best_level(), angles, values);
            if kinds.contains(&JointKind::Prismatic) {
                for (index, (packed, &value)) in values.iter_mut().zip(&*angles).enumerate() {
                    if kinds[index % joints] == JointKind::Prismatic {
                        *packed = (value, 0.0);
                    }
                }
            }
        };
        let len = CHUNK * joints.max(1);
        if rows <= CHUNK || rayon::current_num_threads() == 1 {
            let chunks = angles.chunks_mut(len).zip(values.chunks_mut(len)).enumerate();
            chunks.for_each(|(chunk, (angles, values))| fill(chunk * CHUNK, angles, values));
        } else {
            let chunks = angles.par_chunks_mut(len).zip(values.par_chunks_mut(len)).enumerate();
            chunks.with_max_len(1).for_each(|(chunk, (angles, values))| fill(chunk * CHUNK, angles, values));
        }
        let bases = bases(robot, &angles, factors);
        let terms = robot.terms.iter().map(|it| (it.joint, it.term)).collect();
        PackedValues {
            joints,
            kinds,
            values,
            angles,
            terms,
            bases,
            rates: Vec::new(),
            times_s: Vec::new(),
            further: None,
        }
    }

    /// Value of a joint in a row, or in a further configuration in place of it: θ, and `(cos θ, sin θ)` or `(θ, 0)`.
    pub(crate) fn value_at(&self, row: usize, further: Option<u32>, joint: usize) -> (f64, (f64, f64)) {
        let (packed, row) = match (&self.further, further) {
            (Some(packed), Some(row)) => (&**packed, row as usize),
            _ => (self, row),
        };
        let at = row * packed.joints + joint;
        (packed.angles[at], packed.values[at])
    }

    /// The terms whose functions are packed.
    pub(crate) fn terms(&self) -> &Arc<[(usize, Term)]> {
        &self.terms
    }

    /// Functions b of the packed terms in a row, or in a further configuration in place of it, and its joint values.
    pub(crate) fn bases_at(&self, row: usize, further: Option<u32>) -> Bases<'_> {
        let (packed, row) = match (&self.further, further) {
            (Some(packed), Some(row)) => (&**packed, row as usize),
            _ => (self, row),
        };
        let count = packed.terms.len();
        Bases {
            terms: &packed.terms,
            bases: &packed.bases[row * count..(row + 1) * count],
            values: packed.joint_values(row),
        }
    }

    /// The function b of a term of a joint in a row, or in a further configuration in place of it.
    pub fn basis(&self, row: usize, further: Option<u32>, joint: usize, term: Term) -> f64 {
        self.bases_at(row, further).basis_of_term(joint, term)
    }

    /// Index of a term of a joint among the packed ones, that of its function in each row.
    pub(crate) fn place_of(&self, joint: usize, term: Term) -> Option<usize> {
        self.terms.iter().position(|it| *it == (joint, term))
    }

    /// Function b of a term of a joint, at its [place](PackedValues::place_of), in a row or in a further configuration in place of it.
    pub(crate) fn basis_at(
        &self,
        row: usize,
        further: Option<u32>,
        place: Option<usize>,
        (joint, term): (usize, Term),
    ) -> f64 {
        let found = self.bases_at(row, further);
        let known = place.and_then(|place| found.bases.get(place)).copied();
        known.unwrap_or_else(|| found.basis_of_term(joint, term))
    }

    /// For each joint, true if it is revolute.
    pub fn turns(&self) -> impl Iterator<Item = bool> {
        self.kinds.iter().map(|&kind| kind == JointKind::Revolute)
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.values.len() / self.joints.max(1)
    }

    /// `(cos θ, sin θ)` of a revolute joint or `(θ, 0)` of a prismatic one.
    #[must_use]
    pub fn joint(&self, row: usize, joint: usize) -> (f64, f64) {
        self.values[row * self.joints + joint]
    }

    /// Joint values of a row, radians or metres.
    #[must_use]
    pub fn joint_values(&self, row: usize) -> &[f64] {
        &self.angles[row * self.joints..(row + 1) * self.joints]
    }

    /// All joints of a row.
    #[must_use]
    pub fn row(&self, row: usize) -> &[(f64, f64)] {
        &self.values[row * self.joints..(row + 1) * self.joints]
    }
}

/// Functions b of terms in one configuration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bases<'a> {
    terms: &'a [(usize, Term)],
    bases: &'a [f64],
    values: &'a [f64],
}

impl<'a> Bases<'a> {
    /// Functions of these terms, and of other terms by the joint values.
    pub(crate) fn new(terms: &'a [(usize, Term)], bases: &'a [f64], values: &'a [f64]) -> Self {
        Bases { terms, bases, values }
    }

    /// Function of a term of a joint; one that is not among the robot's is a function of the joint values alone.
    pub(crate) fn basis_of_term(&self, joint: usize, term: Term) -> f64 {
        let at = self.terms.iter().position(|it| *it == (joint, term));
        at.and_then(|at| self.bases.get(at))
            .copied()
            .unwrap_or_else(|| Situation::from_values(self.values).basis(joint, term))
    }

    /// The sum of terms of a joint, each with its place among the robot's terms, if it is there.
    pub(crate) fn sum(&self, terms: &[(usize, JointTerm)]) -> f64 {
        let own = |&(at, it): &(usize, JointTerm)| {
            let known = self.terms.get(at).is_some_and(|known| *known == (it.joint, it.term));
            let basis = if known { self.bases[at] } else { self.basis_of_term(it.joint, it.term) };
            it.coefficient * basis
        };
        terms.iter().map(own).sum()
    }

    /// The packed functions.
    pub(crate) fn packed_functions(&self) -> &'a [f64] {
        self.bases
    }

    /// Joint values of the configuration, radians or metres.
    pub(crate) fn values(&self) -> &'a [f64] {
        self.values
    }
}

/// Functions b of all terms of a robot at joint values, one row after the other.
fn bases<'a>(robot: &Robot, angles: &[f64], factors: impl Fn(usize) -> &'a [f64] + Sync) -> Vec<f64> {
    if robot.terms.is_empty() {
        return Vec::new();
    }
    let (joints, count) = (robot.joints.len().max(1), robot.terms.len());
    let mut bases = vec![0.0; angles.len() / joints * count];
    threads::fill_chunks(&mut bases, CHUNK * count, |chunk, bases| {
        let mut functions = TermFunctions::new(robot);
        let rows = angles[chunk * CHUNK * joints..].chunks_exact(joints);
        for (row, (values, bases)) in rows.zip(bases.chunks_exact_mut(count)).enumerate() {
            functions.write(values, factors(chunk * CHUNK + row), bases);
        }
    });
    bases
}

/// A subsample of `count` rows, or all if there are no more. The rows are spread evenly but not periodically: a fixed stride could
/// coincide with a rhythm of targets or grid lines in the data (theory.md §6, *End*).
#[must_use]
pub fn sample_rows(rows: &[u32], count: usize) -> Vec<u32> {
    if rows.len() <= count {
        return rows.to_vec();
    }
    // One row of each of `count` nearly equal parts, at a position that multiples of the golden ratio spread; so no row comes twice.
    let golden = 0.618_033_988_749_894_9;
    (0..count)
        .filter_map(|k| {
            let (first, next) = (k * rows.len() / count, (k + 1) * rows.len() / count);
            let place = (k as f64 * golden).fract() * (next - first) as f64;
            rows.get(first + place as usize).copied()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::sample_rows;

    #[test]
    fn samples_are_spread_and_not_periodic() {
        let rows: Vec<u32> = (0..900).collect();
        let sample = sample_rows(&rows, 60);
        assert_eq!(sample.len(), 60);
        assert!((0..3).all(|target| sample.iter().any(|row| row % 3 == target)));
        let most = sample_rows(&rows, 800);
        assert!(most.len() == 800 && most.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
