//! A finished fit as the judging of it sees it.

use std::cmp::Ordering;

use crate::analysis::ranges;
use crate::estimate::{Estimate, Packed, RowError, Sight, row_errors};
use crate::measurement::{Dataset, Noise};
use crate::parameters::Parameter;
use crate::problem::Problem;
use crate::robot::Robot;

/// Data, rows, unknowns and optimum of a fit.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// The robot as delivered: names of joints.
    pub robot: &'a Robot,
    /// The measurements.
    pub data: &'a Dataset,
    /// Their joint values.
    pub packed: &'a Packed,
    /// The rows that were fitted.
    pub rows: &'a [u32],
    /// The unknowns.
    pub free: &'a [Parameter],
    /// The noise by which residuals were whitened.
    pub noise: Noise,
    /// Whether that noise is stated, and not what the residuals show.
    pub noise_is_stated: bool,
    /// Metres that a radian counts.
    pub length_m: f64,
    /// Where the fit ended.
    pub estimate: &'a Estimate,
}

impl<'a> View<'a> {
    /// The problem of some of the rows.
    pub(super) fn problem(&self, rows: Vec<u32>) -> Problem<'a> {
        Problem::new(self.data, self.packed, rows, self.free.to_vec(), self.noise, self.length_m)
    }

    /// Errors of an estimate.
    pub(super) fn errors(&self, rows: &[u32], estimate: &Estimate) -> Vec<RowError> {
        row_errors(self.data, self.packed, rows, estimate)
    }

    /// Rows with what was seen in them.
    pub(super) fn with_sights(&self, rows: &[u32]) -> Vec<(usize, Sight)> {
        rows.iter().map(|&row| (row as usize, Sight::from(&self.data.observations[row as usize]))).collect()
    }

    /// Joint values of a row.
    pub(super) fn values(&self, row: u32) -> &'a [f64] {
        self.packed.joint_values(row as usize)
    }

    /// How far each joint moves in some rows.
    pub(super) fn spans(&self, rows: &[u32]) -> Vec<f64> {
        let ranges = ranges(self.robot.joints.len(), self.packed, rows);
        ranges.into_iter().map(|(least, most)| most - least).collect()
    }

    /// Rows in the order of a joint's value.
    pub(super) fn sorted_by(&self, rows: &[u32], joint: usize) -> Vec<u32> {
        let mut sorted = rows.to_vec();
        sorted.sort_unstable_by(|&a, &b| self.by_joint(joint, a, b));
        sorted
    }

    /// Which of two rows comes first by a joint's value, and then by number.
    pub(super) fn by_joint(&self, joint: usize, a: u32, b: u32) -> Ordering {
        self.values(a)[joint].total_cmp(&self.values(b)[joint]).then(a.cmp(&b))
    }
}
