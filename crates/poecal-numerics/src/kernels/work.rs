//! Buffers of one pass over rows: columns and sums.

use std::cell::RefCell;

use super::gram::{TILE, sums_len};
use super::plan::{ArmAtEstimate, KernelPlan};
use super::vector::LaneBlock;

/// Memory of columns that wait for their products, in wide numbers: with the sums it just fits the first-level cache.
const WAITING: usize = 570;
/// Fewest and most blocks that wait: with fewer, the tiles' sums are loaded and stored too often, even if columns fill the second-level
/// cache.
const BLOCKS_WAITING: (usize, usize) = (6, 8);

/// A joint's two translation columns and origin in the current rows, and its gradient: two shifts, two tilts.
#[derive(Clone, Copy)]
pub(crate) struct JointWork {
    pub(crate) shifts: [[LaneBlock; 3]; 2],
    pub(crate) origin: [LaneBlock; 3],
    pub(crate) gradient: [LaneBlock; 4],
}

impl JointWork {
    const ZERO: JointWork =
        JointWork { shifts: [[LaneBlock::ZERO; 3]; 2], origin: [LaneBlock::ZERO; 3], gradient: [LaneBlock::ZERO; 4] };
}

/// Direction of an unknown term in the current rows, times its factor, and its gradient.
#[derive(Clone, Copy)]
pub(crate) struct ValueColumn {
    pub(crate) direction: [LaneBlock; 3],
    pub(crate) gradient: LaneBlock,
}

impl ValueColumn {
    const ZERO: ValueColumn = ValueColumn { direction: [LaneBlock::ZERO; 3], gradient: LaneBlock::ZERO };
}

/// Columns and sums of the current pass.
pub(crate) struct PassWork {
    /// Position rows of each column, block after block.
    pub(crate) jacobian: Vec<[LaneBlock; 3]>,
    /// Rows that rotation adds for each rotation column, in the same order: two or three for each block.
    pub(crate) turned: Vec<LaneBlock>,
    pub(crate) axes: Vec<JointWork>,
    pub(crate) terms: Vec<ValueColumn>,
    pub(crate) products: Vec<LaneBlock>,
    pub(crate) turned_products: Vec<LaneBlock>,
    pub(crate) shift_gradient: Vec<LaneBlock>,
    pub(crate) turn_gradient: Vec<LaneBlock>,
    pub(crate) given_gradient: Vec<LaneBlock>,
    pub(crate) square: LaneBlock,
    /// Blocks that wait at a time.
    pub(crate) waiting: usize,
    /// Rows that rotation adds for each block.
    pub(crate) turned_rows: usize,
}

impl Default for PassWork {
    fn default() -> Self {
        PassWork::EMPTY
    }
}

impl PassWork {
    const EMPTY: PassWork = PassWork {
        jacobian: Vec::new(),
        turned: Vec::new(),
        axes: Vec::new(),
        terms: Vec::new(),
        products: Vec::new(),
        turned_products: Vec::new(),
        shift_gradient: Vec::new(),
        turn_gradient: Vec::new(),
        given_gradient: Vec::new(),
        square: LaneBlock::ZERO,
        waiting: 1,
        turned_rows: 0,
    };

    /// Prepares the buffers of a plan's gradient, at zero, and of its columns if these are needed.
    pub(crate) fn begin(&mut self, arm: &ArmAtEstimate<'_>, with_columns: bool) {
        let plan = arm.plan;
        restart(&mut self.shift_gradient, plan.shifts);
        restart(&mut self.turn_gradient, plan.turns.len());
        restart(&mut self.given_gradient, plan.given);
        self.square = LaneBlock::ZERO;
        self.axes.clear();
        self.axes.resize(plan.joints.len(), JointWork::ZERO);
        self.terms.clear();
        self.terms.resize(plan.terms.len(), ValueColumn::ZERO);
        self.turned_rows = plan.turned_rows(arm.nearly);
        self.products.clear();
        self.turned_products.clear();
        self.waiting = plan.slots();
        if with_columns {
            let [columns, turns] = padded_sizes(plan);
            self.waiting = (WAITING / (3 * columns).max(1)).clamp(BLOCKS_WAITING.0, BLOCKS_WAITING.1);
            self.waiting = self.waiting.next_multiple_of(plan.slots());
            // Columns are written before they are read, except for the padding of the last tile.
            self.jacobian.resize(self.waiting * columns, [LaneBlock::ZERO; 3]);
            self.jacobian[self.waiting * plan.columns()..].fill([LaneBlock::ZERO; 3]);
            let rows = self.turned_rows * self.waiting;
            self.turned.resize(rows * turns, LaneBlock::ZERO);
            self.turned[rows * plan.turns.len()..].fill(LaneBlock::ZERO);
        }
    }

    /// Prepares the sums of products of columns, at zero.
    pub(crate) fn begin_products(&mut self, plan: &KernelPlan, lanes: usize) {
        let [columns, turns] = padded_sizes(plan);
        restart(&mut self.products, sums_len(columns, lanes));
        restart(&mut self.turned_products, if self.turned_rows > 0 { sums_len(turns, lanes) } else { 0 });
    }
}

/// Numbers of position columns and of rotation columns, padded to whole tiles.
fn padded_sizes(plan: &KernelPlan) -> [usize; 2] {
    [plan.columns(), plan.turns.len()].map(|count| count.next_multiple_of(TILE))
}

fn restart(sums: &mut Vec<LaneBlock>, len: usize) {
    sums.clear();
    sums.resize(len, LaneBlock::ZERO);
}

thread_local! {
    /// Buffers of one pass, reused by the next.
    pub(crate) static WORK: RefCell<PassWork> = const { RefCell::new(PassWork::EMPTY) };
}
