//! What an estimate predicts of many rows, several side by side.

use super::{Estimate, Linkage, Packed};
use crate::lanes::{self, Level, Step, WIDTH, Wide};
use crate::lie::Pose;
use crate::measurement::{Dataset, Observation};
use crate::threads;

/// Rows that one thread takes at a time.
const CHUNK: usize = 1024;

/// What `each` makes of a row and of the predicted `device_from_target` there, row after row (theory.md §4 (13)).
pub(crate) fn map_predictions<T: Send>(
    data: &Dataset,
    packed: &Packed,
    rows: &[u32],
    estimate: &Estimate,
    each: impl Fn(&Observation, &Pose) -> T + Sync,
) -> Vec<T> {
    let linkage = Linkage::new(estimate);
    threads::concat_chunks(rows, CHUNK, |_, rows| {
        let mut found = Vec::with_capacity(rows.len());
        let mut side_by_side = SideBySide::new(&linkage);
        for rows in rows.chunks(WIDTH) {
            let last = side_by_side.last_links(packed, rows);
            for (lane, &row) in rows.iter().enumerate() {
                let observation = &data.observations[row as usize];
                found.push(each(observation, &(last(lane) * *linkage.end(observation.target))));
            }
        }
        found
    })
}

/// Joint values of [`WIDTH`] rows side by side, and the frames that they lead to.
struct SideBySide<'a> {
    linkage: &'a Linkage,
    level: Level,
    joints: Vec<(bool, Step)>,
    values: Vec<[Wide; 2]>,
    frames: [[Wide; 4]; 3],
}

impl<'a> SideBySide<'a> {
    fn new(linkage: &'a Linkage) -> Self {
        let joints: Vec<(bool, Step)> = linkage.turning_steps().collect();
        SideBySide {
            linkage,
            level: Level::best(),
            values: vec![[Wide::ZERO; 2]; joints.len()],
            joints,
            frames: [[Wide::ZERO; 4]; 3],
        }
    }

    /// `device_from_last_link` after all motions, of each of at most [`WIDTH`] rows.
    fn last_links(&mut self, packed: &Packed, rows: &[u32]) -> impl Fn(usize) -> Pose {
        for (lane, &row) in rows.iter().enumerate() {
            let values = packed.joint_values(row as usize).iter().zip(packed.row(row as usize));
            for (joint, (wide, (&value, &packed))) in self.values.iter_mut().zip(values).enumerate() {
                let (_, cosine_or_value, sine) = self.linkage.joint_value(joint, value, packed);
                wide[0].0[lane] = cosine_or_value;
                wide[1].0[lane] = sine;
            }
        }
        lanes::last_links(self.level, &self.joints, &self.values, &mut self.frames);
        let frames = &self.frames;
        |lane| Pose::from_rows(|k, column| frames[k][column].0[lane])
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::estimate::Chain;
    use crate::lie::Screw;
    use crate::robot::{Joint, Robot};

    const ROWS: u32 = 21;

    /// Two robots, of which the first joint turns or slides.
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

    /// The last links of all rows, as the vector instructions of a level find them.
    fn last_links(level: Level, linkage: &Linkage, packed: &Packed) -> Vec<Pose> {
        let mut side_by_side = SideBySide { level, ..SideBySide::new(linkage) };
        let mut found = Vec::new();
        for rows in (0..ROWS).collect::<Vec<_>>().chunks(WIDTH) {
            found.extend((0..rows.len()).map(side_by_side.last_links(packed, rows)));
        }
        found
    }

    #[test]
    fn last_links_are_where_the_chain_and_forward_kinematics_have_them_at_every_level() {
        let readings: Vec<f64> =
            (0..4 * ROWS).map(|k| f64::from((k * k * 7 + 3 * k) % 31) / 9.0 - 1.7).collect();
        for robot in robots() {
            let packed = Packed::new(&robot, &readings, 4);
            for offsets in [[0.0; 4], [0.3, -0.2, 0.6, 0.1]] {
                let mut estimate = Estimate::new(&robot, vec![robot.home], Pose::identity());
                estimate.joint_offset = offsets.to_vec();
                let linkage = Linkage::new(&estimate);
                let mut chain = Chain::default();
                for level in lanes::levels() {
                    for (row, last) in last_links(level, &linkage, &packed).into_iter().enumerate() {
                        let values: Vec<f64> = packed
                            .joint_values(row)
                            .iter()
                            .zip(offsets)
                            .map(|(value, offset)| value + offset)
                            .collect();
                        let tip = robot.forward_kinematics(&values);
                        chain.evaluate(&linkage, &packed, row, 0);
                        for (found, expected) in [(last, chain.last), (last * *linkage.end(0), tip)] {
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
}
