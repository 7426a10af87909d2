//! What a pass asks of rows that measured another function of a target's pose than its position and orientation.

use super::influence::NUMBERS;
use crate::lie::Pose;

/// Numbers of the two halves of a sensitivity, and rows of a column in memory.
pub(super) const HALF: usize = 3;

/// Whitened residual of a row, and the change of each predicted number by a translation and by a rotation of the target.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShapedRow {
    pub(crate) residual: [f64; NUMBERS],
    pub(crate) sensitivity: [[f64; 2 * HALF]; NUMBERS],
}

impl ShapedRow {
    pub(crate) const NONE: ShapedRow =
        ShapedRow { residual: [0.0; NUMBERS], sensitivity: [[0.0; 2 * HALF]; NUMBERS] };
}

/// The functions of the rows of a pass.
pub(crate) trait Shape: Sync {
    /// Of the row at this place among the packed ones, for its predicted target. Writes the columns of unknowns that the kernels do not have.
    fn row(&self, place: usize, predicted: &Pose, given: &mut [[f64; NUMBERS]]) -> ShapedRow;
}
