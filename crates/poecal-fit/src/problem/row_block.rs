//! Jacobian and residuals of several rows side by side.

use super::Problem;
use super::fast::{ROWS, RowShapes, fixed_motions, pack};
use super::kernel_columns::KernelColumns;
use super::row_group::RowGroup;
use crate::state::{Estimate, Linkage};
use poecal_numerics::kernels::{self as lanes, ArmAtEstimate, LaneBlock, NUMBERS, WIDTH};

/// Whitened Jacobian of the prediction and residuals of up to [`WIDTH`] rows, one a lane: three numbers of the position, three of the
/// rotation. Numbers that a row does not have are zero.
pub struct RowBlock {
    /// Columns, one after the other.
    pub jacobian: Vec<[LaneBlock; NUMBERS]>,
    pub residual: [LaneBlock; NUMBERS],
    /// Number of values of each row.
    pub numbers: [usize; WIDTH],
}

impl RowBlock {
    fn new(n: usize) -> Self {
        RowBlock {
            jacobian: vec![[LaneBlock::ZERO; NUMBERS]; n],
            residual: [LaneBlock::ZERO; NUMBERS],
            numbers: [0; WIDTH],
        }
    }

    fn clear(&mut self) {
        self.jacobian.fill([LaneBlock::ZERO; NUMBERS]);
        self.residual = [LaneBlock::ZERO; NUMBERS];
        self.numbers = [0; WIDTH];
    }
}

impl Problem<'_> {
    /// Calls `each` with the Jacobian and residuals of up to [`WIDTH`] rows, which it may overwrite, and their positions in `rows`. The
    /// order of the blocks is that of the groups, not of `rows`.
    pub fn for_row_blocks(&self, state: &Estimate, rows: &[u32], mut each: impl FnMut(&[u32], &mut RowBlock)) {
        let mut block = RowBlock::new(self.layout().dim());
        for group in RowGroup::all_from_rows(self, rows, |position, _| position) {
            let arranged = KernelColumns::new(self, state, group.sight, group.form);
            self.by_kernel(state, rows, &(arranged, group.rows), &mut block, &mut each);
        }
    }

    fn by_kernel(
        &self,
        state: &Estimate,
        rows: &[u32],
        (arranged, places): &(KernelColumns, Vec<u32>),
        block: &mut RowBlock,
        each: &mut impl FnMut(&[u32], &mut RowBlock),
    ) {
        let linkage = Linkage::new(state);
        let (steps, end) = fixed_motions(&linkage, arranged.sight);
        let plan = &arranged.plan;
        let columns: Vec<(usize, f64)> = arranged.step_columns().map(|place| (place.at, place.sign)).collect();
        let own: Vec<u32> = places.iter().map(|&place| rows[place as usize]).collect();
        let shapes = RowShapes { problem: self, linkage: &linkage, second: None, arranged, rows: &own };
        let arm = ArmAtEstimate { plan, steps: &steps, end: &end, shape: shapes.as_shape(), nearly: false };
        let mut packed = ROWS.take();
        pack(self, &linkage, arranged, &own, &mut packed);
        let blocks = packed.blocks.chunks_exact(plan.block_len());
        for ((places, packed), first) in places.chunks(WIDTH).zip(blocks).zip((0..).step_by(WIDTH)) {
            block.clear();
            block.numbers[..places.len()].fill(arranged.numbers());
            let RowBlock { jacobian, residual, numbers: _ } = &mut *block;
            lanes::whitened_columns(self.level, &arm, packed, first, &columns, jacobian, residual);
            each(places, block);
        }
        ROWS.set(packed);
    }
}
