//! Predictions of several rows side by side.

use nalgebra::Vector3;

use super::{Linkage, PassedJoint, RowError, Session, Sight};
use poecal_arm::lie::Pose;
use poecal_model::measurement::{InitialGuess, Kernel, NUMBERS, Observation};
use poecal_numerics::kernels::{self as lanes, FixedMotion, FrameColumns, LaneBlock, SimdLevel, WIDTH};

/// [`WIDTH`] rows of one route side by side: joint values, frames of the last link, targets in it, measurements and errors.
pub(crate) struct SideBySide<'a> {
    linkage: &'a Linkage,
    route: &'a [PassedJoint],
    /// True if the joint values are those of a row, in their order.
    plain: bool,
    pub(crate) level: SimdLevel,
    joints: Vec<(bool, FixedMotion)>,
    values: Vec<[LaneBlock; 2]>,
    last_links: [[LaneBlock; 4]; 3],
    /// The target of each row, and its pose in the last link.
    targets: [Option<usize>; WIDTH],
    ends: FrameColumns,
    measured: FrameColumns,
    errors: [[LaneBlock; 3]; 2],
}

impl<'a> SideBySide<'a> {
    pub(crate) fn new(linkage: &'a Linkage, route: usize) -> Self {
        let joints: Vec<(bool, FixedMotion)> = linkage.turning_steps(route).collect();
        SideBySide {
            linkage,
            route: &linkage.tree().routes()[route],
            plain: linkage.is_plain(route),
            level: SimdLevel::best_level(),
            values: vec![[LaneBlock::ZERO; 2]; joints.len()],
            joints,
            last_links: [[LaneBlock::ZERO; 4]; 3],
            targets: [None; WIDTH],
            ends: [[LaneBlock::ZERO; 3]; 4],
            measured: [[LaneBlock::ZERO; 3]; 4],
            errors: [[LaneBlock::ZERO; 3]; 2],
        }
    }

    /// Computes `device_from_last_link` after all motions, of each of at most [`WIDTH`] rows.
    pub(crate) fn predict(&mut self, session: &Session<'_>, rows: &[u32]) {
        if self.route.is_empty() {
            (0..WIDTH).for_each(|lane| put_rows(&mut self.last_links, lane, self.linkage.first_device()));
            return;
        }
        if self.plain {
            for (lane, &row) in rows.iter().enumerate() {
                for (wide, &(cosine_or_value, sine)) in self.values.iter_mut().zip(session.packed.row(row as usize)) {
                    wide[0].0[lane] = cosine_or_value;
                    wide[1].0[lane] = sine;
                }
            }
            return lanes::last_links(self.level, &self.joints, &self.values, &mut self.last_links);
        }
        for (lane, &row) in rows.iter().enumerate() {
            let sight = Sight::from(session.observation(row));
            for (wide, &passed) in self.values.iter_mut().zip(self.route) {
                let (_, cosine_or_value, sine) = self.linkage.joint_value(passed, session.packed, row as usize, sight);
                wide[0].0[lane] = cosine_or_value;
                wide[1].0[lane] = sine;
            }
        }
        lanes::last_links(self.level, &self.joints, &self.values, &mut self.last_links);
    }

    /// Computes the errors of the same rows.
    pub(crate) fn compare(&mut self, session: &Session<'_>, rows: &[u32]) {
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
                (None, InitialGuess::Frame(pose)) => put(&mut self.measured, lane, &pose),
                (None, InitialGuess::Place([Some(x), Some(y), Some(z)])) => {
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

    pub(crate) fn last_link(&self, lane: usize) -> Pose {
        Pose::from_rows(|k, column| self.last_links[k][column].0[lane])
    }

    pub(crate) fn error(&self, lane: usize, seen: &Observation) -> RowError {
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
            return RowError::from_values(measurement, values);
        }
        let target = self.predicted_pose(lane, seen);
        match (self.linkage.range(seen.station), measurement.range()) {
            // The length of the read position would lose the sign of a reading below zero.
            (Some(range), Some(measured)) => {
                values[0] = measured - range.reading(&target);
                RowError::from_values(measurement, values)
            }
            (Some(range), None) => RowError::new(measurement, &range.locate_target(&target)),
            (None, _) => RowError::new(measurement, &target),
        }
    }

    /// The predicted pose of a row's target in the frame of its own device.
    pub(crate) fn predicted_pose(&self, lane: usize, seen: &Observation) -> Pose {
        let (_, end) = self.linkage.frames(Sight::from(seen));
        let from_first = self.last_link(lane) * *end;
        let station = self.linkage.station_from_first(seen.station);
        station.map_or(from_first, |&it| it * from_first)
    }
}

/// Writes one lane of frames by rows.
fn put_rows(frames: &mut [[LaneBlock; 4]; 3], lane: usize, pose: &Pose) {
    for (k, row) in frames.iter_mut().enumerate() {
        for (column, wide) in row[..3].iter_mut().enumerate() {
            wide.0[lane] = pose.rotation[(k, column)];
        }
        row[3].0[lane] = pose.translation[k];
    }
}

/// Writes one lane.
fn put(frames: &mut FrameColumns, lane: usize, pose: &Pose) {
    let [rotation @ .., place] = frames;
    for (wide, column) in rotation.iter_mut().flatten().zip(pose.rotation.as_slice()) {
        wide.0[lane] = *column;
    }
    put_row(place, lane, &pose.translation);
}

/// Writes the position of one lane.
fn put_place([.., place]: &mut FrameColumns, lane: usize, position: &Vector3<f64>) {
    put_row(place, lane, position);
}

fn put_row(row: &mut [LaneBlock; 3], lane: usize, vector: &Vector3<f64>) {
    for (wide, number) in row.iter_mut().zip(vector.as_slice()) {
        wide.0[lane] = *number;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::{Estimate, PackedValues, RowChain};
    use poecal_arm::lie::{Screw, rotation};
    use poecal_model::measurement::{Dataset, Measurement, Quantity};
    use poecal_model::robot::{Joint, Robot};

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
            let packed = PackedValues::from_dataset(&robot, &data);
            let session = Session::new(&robot, &data, &packed, false);
            for offsets in [[0.0; 4], [0.3, -0.2, 0.6, 0.1]] {
                let estimate = Estimate::new(&robot, vec![robot.home], Pose::identity()).with_offsets(&offsets);
                let linkage = Linkage::new(&estimate);
                let mut chain = RowChain::default();
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
                        for (found, expected) in [(last, chain.last), (last * *linkage.frames(Sight::from(0)).1, tip)] {
                            let turned = (found.rotation - expected.rotation).norm();
                            let moved = (found.translation - expected.translation).norm();
                            // Rounding of a few products of numbers of about one.
                            assert!(turned < 1e-14 && moved < 1e-14, "{level:?} {row}: {turned:e}, {moved:e}");
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
            let packed = PackedValues::new(&robot, &readings, 4);
            let targets = vec![robot.home, robot.home * Pose::from_xyz_rpy([0.2, 0.0, -0.1], [0.5, 1.0, 2.0])];
            let device_from_base = Pose::from_xyz_rpy([2.0, -1.0, 0.4], [0.1, 0.2, -2.0]);
            let linkage = Linkage::new(&Estimate::new(&robot, targets, device_from_base));
            let mut chain = RowChain::default();
            let mut data = Dataset::new(robot.reading_names());
            data.targets = vec![Some("a".to_owned()), Some("b".to_owned())];
            let mut expected = Vec::new();
            for row in 0..ROWS as usize {
                let target = row % 3 / 2;
                chain.evaluate(&linkage, &packed, row, target);
                // Every seventh row has nearly the largest possible rotation, every fourth is a point.
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
                data.push(&readings[4 * row..4 * row + 4], data.targets[target].clone().as_deref(), measurement)
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
