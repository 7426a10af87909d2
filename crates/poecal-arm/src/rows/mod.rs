//! Many configurations, eight side by side.

#![allow(clippy::needless_range_loop, reason = "loops over configurations go over several lists alike")]

mod chain;
mod frames;
mod weights;

pub(crate) use chain::{ConfigurationBatch, PassOutputs};
use nalgebra::Vector3;

use crate::arm::{Arm, take_first};
use crate::arm_state::MOST_JOINTS;
use crate::lie::{Pose, rotation};

/// Configurations side by side.
const WIDTH: usize = 8;

impl Arm {
    /// [`Arm::forward_kinematics`] of many configurations, their readings one after the other, as many as there are in both lists. The
    /// numbers are the same; it is faster, since eight configurations are computed side by side.
    #[inline(always)]
    pub fn forward_kinematics_of(&self, readings: &[f64], tips: &mut [Pose]) {
        let mut rows = ConfigurationBatch::<WIDTH, MOST_JOINTS>::new();
        for (some, out) in readings.chunks(WIDTH * self.joints()).zip(tips.chunks_mut(WIDTH)) {
            load(self, some, &mut rows);
            rows.place(self.parts(), PassOutputs::Tips);
            let count = some.len() / self.joints();
            out.iter_mut().take(count).enumerate().for_each(|(row, out)| *out = rows.tip.pose(row));
        }
    }

    /// Jacobians of many configurations, their readings one after the other. Each has six rows of as many numbers as readings: the motion of
    /// the tip's point (m/rad, or m/m) and its rotation (rad/rad, or rad/m), base frame, as [`Arm::jacobian`].
    #[inline(always)]
    pub fn jacobians_of(&self, readings: &[f64], jacobians: &mut [f64]) {
        let n = self.joints();
        let mut rows = ConfigurationBatch::<WIDTH, MOST_JOINTS>::new();
        for (some, out) in readings.chunks(WIDTH * n).zip(jacobians.chunks_mut(6 * WIDTH * n)) {
            load(self, some, &mut rows);
            rows.place(self.parts(), PassOutputs::Motions);
            for reading in 0..n {
                let column = rows.column(reading);
                for (row, out) in out.chunks_exact_mut(6 * n).take(some.len() / n).enumerate() {
                    for (k, it) in column.iter().flatten().enumerate() {
                        out[k * n + reading] = it[row];
                    }
                }
            }
        }
    }

    /// Deflection of the tip under weights in many configurations, their readings one after the other: the shift of its point (m), and its
    /// rotation as a rotation vector (rad), base frame. It is relative to the tip without compliance under weights ([`crate::GravityTorque`]): `p − p₀`
    /// and `log(R R₀ᵀ)`.
    #[inline(always)]
    pub fn sag_of(&self, readings: &[f64], sag: &mut [[f64; 6]]) {
        let (mut rows, mut bare) =
            (ConfigurationBatch::<WIDTH, MOST_JOINTS>::new(), ConfigurationBatch::<WIDTH, MOST_JOINTS>::new());
        for (some, out) in readings.chunks(WIDTH * self.joints()).zip(sag.chunks_mut(WIDTH)) {
            load(self, some, &mut rows);
            bare.q = rows.q;
            rows.place(self.parts(), PassOutputs::Tips);
            bare.place(self.parts(), PassOutputs::Unloaded);
            for (row, out) in out.iter_mut().take(some.len() / self.joints()).enumerate() {
                let (tip, bare) = (rows.tip.pose(row), bare.tip.pose(row));
                let shift = tip.translation - bare.translation;
                let turn = rotation::log(&(tip.rotation * bare.rotation.transpose()));
                *out = [shift.x, shift.y, shift.z, turn.x, turn.y, turn.z];
            }
        }
    }

    /// Motion of the tip with each reading: of its point (m/rad, or m/m) and its rotation (rad/rad, or rad/m), base frame. It is for the
    /// point of the tip, like the hybrid or `LOCAL_WORLD_ALIGNED` Jacobian of other libraries. The effect of weights is included.
    #[must_use]
    pub fn jacobian(&self, q: &[f64]) -> [(Vector3<f64>, Vector3<f64>); MOST_JOINTS] {
        let placed = ConfigurationBatch::from_readings(&take_first::<MOST_JOINTS>(q))
            .place_with(|rows| rows.place(self.parts(), PassOutputs::Motions));
        core::array::from_fn(|reading| placed.column(reading))
    }
}

/// Loads readings of configurations, one after the other, side by side; unused places keep their values.
#[inline(always)]
fn load(arm: &Arm, readings: &[f64], rows: &mut ConfigurationBatch<WIDTH, MOST_JOINTS>) {
    for (row, readings) in readings.chunks_exact(arm.joints()).enumerate() {
        for (to, from) in rows.q.iter_mut().zip(readings) {
            to[row] = *from;
        }
    }
}
