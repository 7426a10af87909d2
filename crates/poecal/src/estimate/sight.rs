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
