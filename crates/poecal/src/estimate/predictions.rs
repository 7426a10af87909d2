//! Errors of an estimate's predictions, several rows side by side.

use nalgebra::Vector3;

use super::{Estimate, Linkage, Passed, RowError, Session, Sight};
use crate::lanes::{self, FixedMotion, Frames, SimdLevel, WIDTH, Wide};
use crate::lie::Pose;
use crate::measurement::{ByQuantity, Clue, Dataset, Kernel, NUMBERS, Observation, Written};
use crate::threads;

/// Rows that one thread takes at a time.
const CHUNK: usize = 1024;

impl Session<'_> {
    /// Errors of an estimate, one for each row: measured minus predicted, metres and radians, in the axes of the row's own device frame
    /// (theory.md §4 (15), (16), not whitened).
    #[must_use]
    pub fn errors(&self, rows: &[u32], estimate: &Estimate) -> Vec<RowError> {
        self.map_errors(rows, estimate, |_, error, _| error)
    }

    /// Maps each row by `each`, from its observation and, of each quantity, the sum of squares (m², rad²) and the count of its residual's
    /// numbers, as if the noise of positions were the same in all directions. Residuals are those of theory.md §4 (15), (16), or of the data
    /// set's own formulation (16a).
    pub(crate) fn map_squares<T: Send>(
        &self,
        rows: &[u32],
        estimate: &Estimate,
        each: impl Fn(&Observation, ByQuantity<(f64, usize)>) -> T + Sync,
    ) -> Vec<T> {
        self.map_errors(rows, estimate, |observation, error, predicted| {
            let written = Written::new(&observation.measurement, self.data.pose_residual);
            let error = if written.is_usual() {
                error
            } else {
                let mut values = [0.0; NUMBERS];
                written.residual(&predicted(), &mut values);
                RowError::of(written.measurement, values)
            };
            each(observation, self.alike(observation, error).squares())
        })
    }

    /// An error of a row with noise of its position that is the same in all directions.
    pub(crate) fn alike(&self, observation: &Observation, error: RowError) -> RowError {
        self.data.noise_shape(observation).map_or(error, |shape| error.whitened(shape))
    }

    /// Maps each row by `each`, from its observation, its error in the device's axes (theory.md §4 (16), not whitened) and, on demand, the
    /// predicted `device_from_target` (theory.md §4 (13)).
    fn map_errors<T: Send>(
        &self,
        rows: &[u32],
        estimate: &Estimate,
        each: impl Fn(&Observation, RowError, &dyn Fn() -> Pose) -> T + Sync,
    ) -> Vec<T> {
        let linkage = Linkage::new(estimate);
        threads::concat_chunks(rows, CHUNK, |_, rows| {
            let routes = self.by_route(&linkage, rows);
            if let [(route, _)] = routes[..] {
                return self.map_route(&linkage, route, rows, &each);
            }
            let mut found: Vec<(usize, T)> = Vec::with_capacity(rows.len());
            for (route, places) in routes {
                let own: Vec<u32> = places.iter().map(|&place| rows[place]).collect();
                found.extend(places.into_iter().zip(self.map_route(&linkage, route, &own, &each)));
            }
            found.sort_unstable_by_key(|&(place, _)| place);
            found.into_iter().map(|(_, found)| found).collect()
        })
    }

    fn map_route<T>(
        &self,
        linkage: &Linkage,
        route: usize,
        rows: &[u32],
        each: impl Fn(&Observation, RowError, &dyn Fn() -> Pose) -> T,
    ) -> Vec<T> {
        let mut found = Vec::with_capacity(rows.len());
        let mut side_by_side = SideBySide::new(linkage, route);
        for rows in rows.chunks(WIDTH) {
            side_by_side.predict(self, rows);
            side_by_side.compare(self, rows);
            for (lane, &row) in rows.iter().enumerate() {
                let observation = self.observation(row);
                let predicted = || side_by_side.predicted(lane, observation);
                found.push(each(observation, side_by_side.error(lane, observation), &predicted));
            }
        }
        found
    }

    /// Places of the rows of each route among these; none are listed if all are of the only one.
    fn by_route(&self, linkage: &Linkage, rows: &[u32]) -> Vec<(usize, Vec<usize>)> {
        let routes = linkage.tree().routes().len();
        if routes == 1 {
            return vec![(0, Vec::new())];
        }
        let mut places = vec![Vec::new(); routes];
        for (place, &row) in rows.iter().enumerate() {
            places[linkage.tree().route_index(Sight::from(self.observation(row)))].push(place);
        }
        places.into_iter().enumerate().filter(|(_, places)| !places.is_empty()).collect()
    }
}

/// Rotates the errors of rows from the axes of their own station to those of the first, `e ← R_1 R_sᵀ e` with the rotations of the device
/// frames `X_s` of theory.md §4 (13).
pub(crate) fn turn_to_first(data: &Dataset, rows: &[u32], estimate: &Estimate, errors: &mut [RowError]) {
    if data.station_count() == 1 {
        return;
    }
    for (&row, error) in rows.iter().zip(errors) {
        let own = estimate.device(data.observations[row as usize].station).rotation;
        *error = error.turned(&(estimate.device_from_base.rotation * own.transpose()));
    }
}

/// [`WIDTH`] rows of one route side by side: joint values, frames of the last link, targets in it, measurements and errors.
struct SideBySide<'a> {
    linkage: &'a Linkage,
    route: &'a [Passed],
    /// Whether the joint values are those of a row, in their order.
    plain: bool,
    level: SimdLevel,
    joints: Vec<(bool, FixedMotion)>,
    values: Vec<[Wide; 2]>,
    last_links: [[Wide; 4]; 3],
    /// The target of each row, and its pose in the last link.
    targets: [Option<usize>; WIDTH],
    ends: Frames,
    measured: Frames,
    errors: [[Wide; 3]; 2],
}

impl<'a> SideBySide<'a> {
    fn new(linkage: &'a Linkage, route: usize) -> Self {
        let joints: Vec<(bool, FixedMotion)> = linkage.turning_steps(route).collect();
        SideBySide {
            linkage,
            route: &linkage.tree().routes()[route],
            plain: linkage.is_plain(route),
            level: SimdLevel::best(),
            values: vec![[Wide::ZERO; 2]; joints.len()],
            joints,
            last_links: [[Wide::ZERO; 4]; 3],
            targets: [None; WIDTH],
            ends: [[Wide::ZERO; 3]; 4],
            measured: [[Wide::ZERO; 3]; 4],
            errors: [[Wide::ZERO; 3]; 2],
        }
    }

    /// Computes `device_from_last_link` after all motions, of each of at most [`WIDTH`] rows.
    fn predict(&mut self, session: &Session<'_>, rows: &[u32]) {
        if self.route.is_empty() {
            (0..WIDTH).for_each(|lane| put_rows(&mut self.last_links, lane, self.linkage.first_device()));
            return;
        }
        if self.plain {
            for (lane, &row) in rows.iter().enumerate() {
                for (wide, &(cosine_or_value, sine)) in
                    self.values.iter_mut().zip(session.packed.row(row as usize))
                {
                    wide[0].0[lane] = cosine_or_value;
                    wide[1].0[lane] = sine;
                }
            }
            return lanes::last_links(self.level, &self.joints, &self.values, &mut self.last_links);
        }
        for (lane, &row) in rows.iter().enumerate() {
            let from = session.observation(row).from;
            for (wide, &passed) in self.values.iter_mut().zip(self.route) {
                let (_, cosine_or_value, sine) =
                    self.linkage.joint_value(passed, session.packed, row as usize, from);
                wide[0].0[lane] = cosine_or_value;
                wide[1].0[lane] = sine;
            }
        }
        lanes::last_links(self.level, &self.joints, &self.values, &mut self.last_links);
    }

    /// Computes the errors of the same rows.
    fn compare(&mut self, session: &Session<'_>, rows: &[u32]) {
        let mut framed = false;
        for (lane, &row) in rows.iter().enumerate() {
            let observation = session.observation(row);
            let Observation { target, measurement, station, .. } = observation;
            let is_frame = measurement.function().kernel == Kernel::Pose;
            match (self.linkage.station_from_first(*station), measurement.clue()) {
                // Measurements from further stations are compared in the device frame of the first.
                (Some(station), _) => {
                    put(&mut self.measured, lane, &(station.inverse() * measurement.pose()));
                }
                (None, Clue::Frame(pose)) => put(&mut self.measured, lane, &pose),
                (None, Clue::Place([Some(x), Some(y), Some(z)])) => {
                    put_place(&mut self.measured, lane, &Vector3::new(x, y, z));
                }
                (None, _) => {}
            }
            framed |= is_frame;
            if self.targets[lane] != Some(*target) {
                self.targets[lane] = Some(*target);
                let (_, end) = self.linkage.frames(Sight::from(observation));
                put(&mut self.ends, lane, end);
            }
        }
        lanes::errors(self.level, &self.last_links, &self.ends, &self.measured, framed, &mut self.errors);
    }

    fn last_link(&self, lane: usize) -> Pose {
        Pose::from_rows(|k, column| self.last_links[k][column].0[lane])
    }

    fn error(&self, lane: usize, seen: &Observation) -> RowError {
        let measurement = &seen.measurement;
        let mut values = [0.0; NUMBERS];
        if measurement.is_place() {
            for (values, [x, y, z]) in values.chunks_exact_mut(3).zip(&self.errors) {
                let error = Vector3::new(x.0[lane], y.0[lane], z.0[lane]);
                let own = match self.linkage.station_from_first(seen.station) {
                    Some(station) => station.rotation * error,
                    None => error,
                };
                values.copy_from_slice(own.as_slice());
            }
            return RowError::of(measurement, values);
        }
        let target = self.predicted(lane, seen);
        match (self.linkage.range(seen.station), measurement.range()) {
            // The length of the seen place would lose the sign of a reading below zero.
            (Some(range), Some(measured)) => {
                values[0] = measured - range.reading(&target);
                RowError::of(measurement, values)
            }
            (Some(range), None) => RowError::new(measurement, &range.seen(&target)),
            (None, _) => RowError::new(measurement, &target),
        }
    }

    /// The predicted pose of a row's target in the frame of its own device.
    fn predicted(&self, lane: usize, seen: &Observation) -> Pose {
        let (_, end) = self.linkage.frames(Sight::from(seen));
        let from_first = self.last_link(lane) * *end;
        let station = self.linkage.station_from_first(seen.station);
        station.map_or(from_first, |&it| it * from_first)
    }
}

/// Writes one lane of frames by rows.
fn put_rows(frames: &mut [[Wide; 4]; 3], lane: usize, pose: &Pose) {
    for (k, row) in frames.iter_mut().enumerate() {
        for (column, wide) in row[..3].iter_mut().enumerate() {
            wide.0[lane] = pose.rotation[(k, column)];
        }
        row[3].0[lane] = pose.translation[k];
    }
}

/// Writes one lane.
fn put(frames: &mut Frames, lane: usize, pose: &Pose) {
    let [rotation @ .., place] = frames;
    for (wide, column) in rotation.iter_mut().flatten().zip(pose.rotation.as_slice()) {
        wide.0[lane] = *column;
    }
    put_row(place, lane, &pose.translation);
}

/// Writes the place of one lane.
fn put_place([.., place]: &mut Frames, lane: usize, position: &Vector3<f64>) {
    put_row(place, lane, position);
}

fn put_row(row: &mut [Wide; 3], lane: usize, vector: &Vector3<f64>) {
    for (wide, number) in row.iter_mut().zip(vector.as_slice()) {
        wide.0[lane] = *number;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{Chain, Packed};
    use crate::lie::{Screw, rotation};
    use crate::measurement::{Measurement, Quantity};
    use crate::robot::{Joint, Robot};

    const ROWS: u32 = 21;

    /// Two robots, with a revolute and a prismatic first joint.
    fn robots() -> [Robot; 2] {
        let turning = |name: &str, axis: [f64; 3], point: [f64; 3]| {
            Joint::revolute(name, Screw::revolute(&Vector3::from(axis), &Vector3::from(point)))
        };
        let a = turning("a", [0.0, 0.0, 1.0], [0.1, -0.2, 0.0]);
        let b = turning("b", [0.6, 0.0, -0.8], [0.3, 0.0, 0.5]);
        let c = turning("c", [-1.0, 0.0, 0.0], [0.7, 0.2, 0.5]);
        let lift = Joint::prismatic("lift", Screw::prismatic(&Vector3::new(0.0, 0.6, 0.8)));
        let home = Pose::from_xyz_rpy([0.9, 0.1, 0.6], [0.4, -0.3, 1.0]);
        [[&a, &b, &lift, &c], [&lift, &a, &b, &c]]
            .map(|joints| Robot::new("test", joints.into_iter().cloned().collect(), home).unwrap())
    }

    /// Readings of all rows, within two radians.
    fn readings() -> Vec<f64> {
        (0..4 * ROWS).map(|k| f64::from((k * k * 7 + 3 * k) % 31) / 9.0 - 1.7).collect()
    }

    /// The last links of all rows, by the instructions of a level.
    fn last_links(level: SimdLevel, linkage: &Linkage, session: &Session<'_>) -> Vec<Pose> {
        let mut side_by_side = SideBySide { level, ..SideBySide::new(linkage, 0) };
        let mut found = Vec::new();
        for rows in (0..ROWS).collect::<Vec<_>>().chunks(WIDTH) {
            side_by_side.predict(session, rows);
            found.extend((0..rows.len()).map(|lane| side_by_side.last_link(lane)));
        }
        found
    }

    #[test]
    fn last_links_are_where_the_chain_and_forward_kinematics_have_them_at_every_level() {
        let readings = readings();
        for robot in robots() {
            let mut data = Dataset::new(robot.reading_names());
            for readings in readings.chunks_exact(4) {
                let seen = Measurement::point(Vector3::zeros());
                data.push(readings, None, seen).unwrap();
            }
            let packed = Packed::of(&robot, &data);
            let session = Session::new(&robot, &data, &packed, false);
            for offsets in [[0.0; 4], [0.3, -0.2, 0.6, 0.1]] {
                let estimate =
                    Estimate::new(&robot, vec![robot.home], Pose::identity()).with_offsets(&offsets);
                let linkage = Linkage::new(&estimate);
                let mut chain = Chain::default();
                for level in lanes::simd_levels() {
                    for (row, last) in last_links(level, &linkage, &session).into_iter().enumerate() {
                        let values: Vec<f64> = packed
                            .joint_values(row)
                            .iter()
                            .zip(offsets)
                            .map(|(value, offset)| value + offset)
                            .collect();
                        let tip = robot.forward_kinematics(&values);
                        chain.evaluate(&linkage, &packed, row, 0);
                        for (found, expected) in
                            [(last, chain.last), (last * *linkage.frames(Sight::from(0)).1, tip)]
                        {
                            let turned = (found.rotation - expected.rotation).norm();
                            let moved = (found.translation - expected.translation).norm();
                            // Rounding of a few products of numbers of about one.
                            assert!(
                                turned < 1e-14 && moved < 1e-14,
                                "{level:?} {row}: {turned:e}, {moved:e}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn errors_are_those_of_the_formulas_at_every_level() {
        let readings = readings();
        for robot in robots() {
            let packed = Packed::new(&robot, &readings, 4);
            let targets =
                vec![robot.home, robot.home * Pose::from_xyz_rpy([0.2, 0.0, -0.1], [0.5, 1.0, 2.0])];
            let device_from_base = Pose::from_xyz_rpy([2.0, -1.0, 0.4], [0.1, 0.2, -2.0]);
            let linkage = Linkage::new(&Estimate::new(&robot, targets, device_from_base));
            let mut chain = Chain::default();
            let mut data = Dataset::new(robot.reading_names());
            data.targets = vec![Some("a".to_owned()), Some("b".to_owned())];
            let mut expected = Vec::new();
            for row in 0..ROWS as usize {
                let target = row % 3 / 2;
                chain.evaluate(&linkage, &packed, row, target);
                // Every seventh is turned by as much as a rotation can be, every fourth a point.
                let angle = if row % 7 == 6 { 3.0 } else { 1e-3 * row as f64 };
                let shift = Vector3::new(1e-3, 2e-4 * row as f64, -0.5);
                let turn = (row % 4 != 3).then(|| Vector3::new(0.6, 0.0, -0.8) * angle);
                let position = chain.target.translation + shift;
                let measurement = match turn {
                    None => Measurement::point(position),
                    Some(turn) => {
                        let pose = Pose::new(rotation::exp(&turn) * chain.target.rotation, position);
                        Measurement::of_pose(&pose)
                    }
                };
                data.push(
                    &readings[4 * row..4 * row + 4],
                    data.targets[target].clone().as_deref(),
                    measurement,
                )
                .unwrap();
                expected.push((shift, turn));
            }
            let session = Session::new(&robot, &data, &packed, false);
            for level in lanes::simd_levels() {
                let mut side_by_side = SideBySide { level, ..SideBySide::new(&linkage, 0) };
                for rows in data.all_rows().chunks(WIDTH) {
                    side_by_side.predict(&session, rows);
                    side_by_side.compare(&session, rows);
                    for (lane, &row) in rows.iter().enumerate() {
                        let found = side_by_side.error(lane, &data.observations[row as usize]);
                        let (shift, turn) = expected[row as usize];
                        assert_eq!(found.length(Quantity::Rotation).is_some(), turn.is_some());
                        let turned = found.vector(Quantity::Rotation) - turn.unwrap_or_default();
                        let apart = (found.vector(Quantity::Position) - shift).norm() + turned.norm();
                        // Rounding of products of rotations, and of a logarithm near half a turn.
                        assert!(apart < 1e-14, "{level:?} {row}: {apart:e}");
                    }
                }
            }
        }
    }
}
