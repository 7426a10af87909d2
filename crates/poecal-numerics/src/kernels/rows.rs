//! Input of a pass from rows that measured another function of a target's pose than its position and orientation.

use super::influence::NUMBERS;
use poecal_arm::lie::Pose;

/// Numbers of the two halves of a sensitivity, and rows of a column in memory.
pub(crate) const HALF: usize = 3;

/// Whitened residual of a row, and the change of each predicted number by a translation and by a rotation of the target.
#[derive(Clone, Copy, Debug)]
pub struct ShapedRow {
    /// Whitened residual.
    pub residual: [f64; NUMBERS],
    /// Change of each number by a translation and by a rotation of the target.
    pub sensitivity: [[f64; 2 * HALF]; NUMBERS],
}

impl ShapedRow {
    /// A row of weight zero.
    pub const NONE: ShapedRow = ShapedRow { residual: [0.0; NUMBERS], sensitivity: [[0.0; 2 * HALF]; NUMBERS] };
}

/// Functions of the rows of a pass.
pub trait RowFunctions: Sync {
    /// Function of the row with this index among the packed ones, for its predicted target. Writes the columns of unknowns that the kernels
    /// do not have.
    fn row(&self, place: usize, predicted: &Pose, given: &mut [[f64; NUMBERS]]) -> ShapedRow;
}
