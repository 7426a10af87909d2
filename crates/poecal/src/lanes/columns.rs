//! Jacobian and residuals of single rows, instead of sums over rows.

use pulp::Simd;

use super::influence::NUMBERS;
use super::kernel::add_rows;
use super::plan::Arm;
use super::vector::{Wide, parts};
use super::work::WORK;

/// Writes the whitened columns of the rows of one block to their places in `jacobian` (translation columns, then rotation columns), and
/// their whitened residuals: three numbers of the position, three of the rotation. Numbers that a column does not have stay unchanged.
/// The plan must have no common ratio, so that the rotation rows exist.
#[inline(always)]
pub(super) fn whitened_columns<S: Simd>(
    simd: S,
    arm: &Arm<'_>,
    block: &[Wide],
    places: &[usize],
    jacobian: &mut [[Wide; NUMBERS]],
    residual: &mut [Wide; NUMBERS],
) {
    let plan = arm.plan;
    let mut work = WORK.take();
    work.begin(arm, true);
    for part in parts(simd) {
        let found = add_rows::<S, true>(simd, arm, block, &mut work, 0, part);
        for (k, &value) in found.iter().flat_map(|part| &part.0).enumerate() {
            value.store(&mut residual[k], part);
        }
    }
    let (turned_rows, stride) = (work.turned_rows, work.waiting);
    for (index, &place) in places.iter().enumerate() {
        let Some(column) = jacobian.get_mut(place) else { continue };
        let (position, rotation) = column.split_at_mut(NUMBERS / 2);
        if index < plan.columns() {
            position.copy_from_slice(&work.jacobian[index * stride]);
        }
        if let Some(turn) = index.checked_sub(plan.shifts) {
            let first = turn * turned_rows * stride;
            rotation[..turned_rows].copy_from_slice(&work.turned[first..first + turned_rows]);
        }
    }
    WORK.set(work);
}
