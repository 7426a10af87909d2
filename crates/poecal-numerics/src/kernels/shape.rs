//! Rows of any function of a target's pose: its whitened residual and sensitivity are computed row by row, and everything before and after
//! side by side (theory.md §4 (17)).

use pulp::Simd;

use super::frame::KernelFrame;
use super::influence::NUMBERS;
use super::plan::KernelPlan;
use super::rows::{HALF, RowFunctions};
use super::vector::{LaneBlock, Lanes, Vectors};
use poecal_arm::lie::Pose;

/// Shaped rows side by side.
pub(crate) struct ShapedRows {
    residual: [LaneBlock; NUMBERS],
    sensitivity: [[LaneBlock; 2 * HALF]; NUMBERS],
    /// Whitened columns of unknowns that the kernels do not have.
    given: Vec<[LaneBlock; NUMBERS]>,
}

impl ShapedRows {
    /// Shaped rows of one vector, the first of them at `first`; rows of weight zero are padding.
    #[inline(never)]
    pub(crate) fn new<S: Simd>(
        (shape, given): (&dyn RowFunctions, usize),
        first: usize,
        target: &KernelFrame<S>,
        weight: Lanes<S>,
    ) -> Self {
        let mut frames = [[LaneBlock::ZERO; 4]; 3];
        for (wide, row) in frames.iter_mut().zip(&target.0) {
            wide.iter_mut().zip(row).for_each(|(wide, number)| number.store(wide, 0));
        }
        let mut weights = LaneBlock::ZERO;
        weight.store(&mut weights, 0);
        let mut rows = ShapedRows {
            residual: [LaneBlock::ZERO; NUMBERS],
            sensitivity: [[LaneBlock::ZERO; 2 * HALF]; NUMBERS],
            given: vec![[LaneBlock::ZERO; NUMBERS]; given],
        };
        let mut columns = vec![[0.0; NUMBERS]; given];
        for lane in (0..S::F64_LANES).filter(|&lane| weights.0[lane] != 0.0) {
            let one = shape.row(first + lane, &Pose::from_rows(|i, j| frames[i][j].0[lane]), &mut columns);
            for (wide, value) in rows.residual.iter_mut().zip(one.residual) {
                wide.0[lane] = value;
            }
            let numbers = rows.sensitivity.iter_mut().flatten().zip(one.sensitivity.as_flattened());
            numbers.for_each(|(wide, value)| wide.0[lane] = *value);
            for (wide, column) in rows.given.iter_mut().zip(&columns) {
                wide.iter_mut().zip(column).for_each(|(wide, value)| wide.0[lane] = *value);
            }
        }
        rows
    }

    /// The whitened residual.
    #[inline(always)]
    pub(crate) fn residual<S: Simd>(&self, simd: S) -> [Vectors<S>; 2] {
        let [a, b, c, d, e, f] = &self.residual;
        [
            Vectors([Lanes::load(simd, a, 0), Lanes::load(simd, b, 0), Lanes::load(simd, c, 0)]),
            Vectors([Lanes::load(simd, d, 0), Lanes::load(simd, e, 0), Lanes::load(simd, f, 0)]),
        ]
    }

    /// The residual as force and torque on the target, `Sᵀ e`.
    #[inline(always)]
    pub(crate) fn wrench<S: Simd>(&self, simd: S) -> [Vectors<S>; 2] {
        let mut sum = [[Lanes::splat(simd, 0.0); HALF]; 2];
        for (e, sensitivity) in self.residual.iter().zip(&self.sensitivity) {
            let e = Lanes::load(simd, e, 0);
            for (k, wide) in sensitivity.iter().enumerate() {
                let sum = &mut sum[k / HALF][k % HALF];
                *sum = Lanes::load(simd, wide, 0).times_plus(e, *sum);
            }
        }
        let [shift, turn] = sum;
        [Vectors(shift), Vectors(turn)]
    }

    /// Adds the gradient of the supplied columns, and writes them after the others if columns are needed.
    #[inline(always)]
    pub(crate) fn add_given<S: Simd, const FULL: bool>(
        &self,
        simd: S,
        plan: &KernelPlan,
        (columns, stride): (&mut [[LaneBlock; HALF]], usize),
        gradient: &mut [LaneBlock],
        part: usize,
    ) {
        let first = plan.shifts + plan.turns.len();
        for (k, (given, gradient)) in self.given.iter().zip(gradient).enumerate() {
            for (number, (wide, e)) in given.iter().zip(&self.residual).enumerate().take(plan.slots() * HALF) {
                let value = Lanes::load(simd, wide, 0);
                (value * Lanes::load(simd, e, 0)).add_to(gradient, part);
                if FULL {
                    let column = &mut columns[(first + k) * stride + number / HALF];
                    value.store(&mut column[number % HALF], part);
                }
            }
        }
    }

    /// Replaces the columns of one vector of rows, motions of the target, by the changes of their numbers. These are in `slots`
    /// groups of three numbers, each [`LaneBlock`] triple after the one before.
    #[inline(always)]
    pub(crate) fn project<S: Simd>(
        &self,
        simd: S,
        plan: &KernelPlan,
        columns: &mut [[LaneBlock; HALF]],
        stride: usize,
        part: usize,
    ) {
        let per_length = Lanes::splat(simd, 1.0 / plan.length_m);
        // Rotation columns come first: they need the unchanged translation columns.
        for (turn, &shift) in plan.turns.iter().enumerate() {
            let turned = Vectors::load(simd, &columns[shift * stride], part).scale(per_length);
            let at = (plan.shifts + turn) * stride;
            let moved = (turn < plan.tilts).then(|| Vectors::load(simd, &columns[at], part));
            self.write(simd, plan, moved, Some(turned), &mut columns[at..], part);
        }
        for shift in 0..plan.shifts {
            let moved = Vectors::load(simd, &columns[shift * stride], part);
            self.write(simd, plan, Some(moved), None, &mut columns[shift * stride..], part);
        }
    }

    #[inline(always)]
    fn write<S: Simd>(
        &self,
        simd: S,
        plan: &KernelPlan,
        moved: Option<Vectors<S>>,
        turned: Option<Vectors<S>>,
        out: &mut [[LaneBlock; HALF]],
        part: usize,
    ) {
        for number in 0..plan.slots() * HALF {
            let sensitivity = &self.sensitivity[number];
            let mut change = Lanes::splat(simd, 0.0);
            for (half, motion) in [moved, turned].into_iter().enumerate() {
                let Some(Vectors(motion)) = motion else { continue };
                for (k, value) in motion.into_iter().enumerate() {
                    change = Lanes::load(simd, &sensitivity[HALF * half + k], 0).times_plus(value, change);
                }
            }
            change.store(&mut out[number / HALF][number % HALF], part);
        }
    }
}
