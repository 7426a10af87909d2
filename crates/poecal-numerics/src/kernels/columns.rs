//! Jacobian and residuals of single rows, instead of sums over rows.

use pulp::Simd;

use super::influence::NUMBERS;
use super::kernel::add_rows;
use super::plan::ArmAtEstimate;
use super::vector::{LaneBlock, parts};
use super::work::WORK;

/// Adds the whitened columns of the rows of one block at their places in `jacobian` (translation columns, then rotation columns), each with its sign.
/// It also writes their whitened residuals: three numbers of the position, three of the rotation. Numbers that a column does not have stay unchanged.
/// The block's first row has the index `first` among all. The plan must have no common ratio, so that the rotation rows exist.
#[inline(always)]
pub(crate) fn whitened_columns<S: Simd>(
    simd: S,
    arm: &ArmAtEstimate<'_>,
    block: &[LaneBlock],
    first: usize,
    places: &[(usize, f64)],
    jacobian: &mut [[LaneBlock; NUMBERS]],
    residual: &mut [LaneBlock; NUMBERS],
) {
    let plan = arm.plan;
    let mut work = WORK.take();
    work.begin(arm, true);
    for part in parts(simd) {
        let found = add_rows::<S, true, false>(simd, arm, (block, first), &mut work, 0, part);
        for (k, &value) in found.iter().flat_map(|part| &part.0).enumerate() {
            value.store(&mut residual[k], part);
        }
    }
    let (turned_rows, stride) = (work.turned_rows, work.waiting);
    for (index, &(place, sign)) in places.iter().enumerate() {
        let Some(column) = jacobian.get_mut(place) else { continue };
        if plan.shaped > 0 {
            let own = &work.jacobian[index * stride..][..plan.slots()];
            add(column, own.as_flattened(), sign);
            continue;
        }
        let (position, rotation) = column.split_at_mut(NUMBERS / 2);
        if index < plan.columns() {
            let numbers = if plan.along.is_some() { 1 } else { NUMBERS / 2 };
            add(position, &work.jacobian[index * stride][..numbers], sign);
        }
        if let Some(turn) = index.checked_sub(plan.shifts) {
            let first = turn * turned_rows * stride;
            add(rotation, &work.turned[first..first + turned_rows], sign);
        }
    }
    WORK.set(work);
}

#[inline(always)]
fn add(to: &mut [LaneBlock], from: &[LaneBlock], sign: f64) {
    for (to, from) in to.iter_mut().zip(from) {
        for (to, from) in to.0.iter_mut().zip(from.0) {
            *to += sign * from;
        }
    }
}
