//! One pass over rows: the chain, its columns in local axis frames, residuals, and their products (theory.md §5, §6 (28)).
//!
//! One source serves every width of vector: as many rows as a vector has lanes are computed at a time, in blocks of [`WIDTH`].

use pulp::Simd;

use super::batch::{Batch, RowWrench};
use super::frame::KernelFrame;
use super::gram::{TILE, add_products};
use super::plan::{ArmAtEstimate, KernelPlan, PlaceComponent};
use super::shape::ShapedRows;
use super::totals::PassTotals;
use super::turn::ResidualRotations;
use super::vector::{LaneBlock, Lanes, Vectors, WIDTH, parts};
use super::work::{PassWork, WORK};

/// Sums over all rows of `blocks`.
#[inline(always)]
pub(crate) fn sum_products<S: Simd>(simd: S, arm: &ArmAtEstimate<'_>, blocks: &[LaneBlock]) -> PassTotals {
    sum::<S, true, false>(simd, arm, blocks)
}

/// The same sums without products of columns.
#[inline(always)]
pub(crate) fn sum_gradient<S: Simd>(simd: S, arm: &ArmAtEstimate<'_>, blocks: &[LaneBlock]) -> PassTotals {
    sum::<S, false, false>(simd, arm, blocks)
}

/// [`sum_products`] of a plain plan ([`KernelPlan::is_plain`]).
#[inline(always)]
pub(crate) fn sum_plain_products<S: Simd>(simd: S, arm: &ArmAtEstimate<'_>, blocks: &[LaneBlock]) -> PassTotals {
    sum::<S, true, true>(simd, arm, blocks)
}

/// [`sum_gradient`] of a plain plan.
#[inline(always)]
pub(crate) fn sum_plain_gradient<S: Simd>(simd: S, arm: &ArmAtEstimate<'_>, blocks: &[LaneBlock]) -> PassTotals {
    sum::<S, false, true>(simd, arm, blocks)
}

/// Sums over all rows of `blocks`; products of columns only if `FULL`. `PLAIN` rows are compiled apart: beside the branches for all others
/// their numbers do not stay in registers.
#[inline(always)]
fn sum<S: Simd, const FULL: bool, const PLAIN: bool>(
    simd: S,
    arm: &ArmAtEstimate<'_>,
    blocks: &[LaneBlock],
) -> PassTotals {
    let plan = arm.plan;
    // A pass does not call another, so the buffer is free; if it were not, there would be another.
    let mut own = WORK.take();
    let work = &mut own;
    work.begin(arm, FULL);
    if FULL {
        work.begin_products(plan, S::F64_LANES);
    }
    let len = plan.block_len();
    let (slots, mut first) = (plan.slots(), 0);
    for blocks in blocks.chunks(len * (work.waiting / slots)) {
        for (filled, block) in blocks.chunks_exact(len).enumerate() {
            for part in parts(simd) {
                add_rows::<S, FULL, PLAIN>(simd, arm, (block, first), work, filled * slots, part);
            }
            first += WIDTH;
        }
        if FULL {
            multiply::<S, PLAIN>(simd, plan, work, blocks.len() / len * slots);
        }
    }
    for (joint, axis) in plan.joints.iter().zip(&work.axes) {
        let (Some((shift, tilt)), [a, b, c, d]) = (joint.columns, axis.gradient) else { continue };
        work.shift_gradient[shift..shift + 2].copy_from_slice(&[a, b]);
        if joint.turns {
            work.turn_gradient[tilt..tilt + 2].copy_from_slice(&[c, d]);
        }
    }
    for (term, found) in plan.terms.iter().zip(&work.terms) {
        match term.turn {
            Some(turn) => work.turn_gradient[turn] = found.gradient,
            None => work.shift_gradient[term.shift] = found.gradient,
        }
    }
    let gradient = work.shift_gradient.iter().chain(&work.turn_gradient).chain(&work.given_gradient);
    let totals = PassTotals {
        products: add_up(simd, &work.products),
        turned: add_up(simd, &work.turned_products),
        gradient: gradient.map(total).collect(),
        cost: 0.5 * total(&work.square),
    };
    WORK.set(own);
    totals
}

/// Adds the products of the waiting columns.
#[inline(always)]
fn multiply<S: Simd, const PLAIN: bool>(simd: S, plan: &KernelPlan, work: &mut PassWork, filled: usize) {
    let columns = plan.columns().next_multiple_of(TILE);
    let stride = 3 * work.waiting;
    let used = if plan.along.is_some() { filled } else { 3 * filled };
    let jacobian = work.jacobian.as_flattened();
    let needed = |i: usize, j: usize| PLAIN || plan.needs(i, j);
    add_products(simd, jacobian, (stride, used), columns, &mut work.products, needed);
    let rows = work.turned_rows;
    if rows > 0 {
        let turns = plan.turns.len().next_multiple_of(TILE);
        let (stride, used) = (rows * work.waiting, rows * filled);
        add_products(simd, &work.turned, (stride, used), turns, &mut work.turned_products, |_, _| true);
    }
}

/// Sums over the lanes of each vector.
#[inline(always)]
fn add_up<S: Simd>(simd: S, sums: &[LaneBlock]) -> Vec<f64> {
    let mut out = Vec::with_capacity(sums.len() * (WIDTH / S::F64_LANES));
    for wide in sums {
        for part in parts(simd) {
            out.push(Lanes::load(simd, wide, part).sum());
        }
    }
    out
}

/// The sum over all lanes.
fn total(sum: &LaneBlock) -> f64 {
    let [a, b, c, d, e, f, g, h] = sum.0;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

/// Columns and gradient of part `part` of a block, whose first row has the index `first` among all. Returns the whitened residuals: of
/// position and rotation, or the numbers of shaped rows.
#[inline(always)]
pub(crate) fn add_rows<S: Simd, const FULL: bool, const PLAIN: bool>(
    simd: S,
    arm: &ArmAtEstimate<'_>,
    (block, first): (&[LaneBlock], usize),
    work: &mut PassWork,
    filled: usize,
    part: usize,
) -> [Vectors<S>; 2] {
    let none = [Vectors([Lanes::splat(simd, 0.0); 3]); 2];
    let ArmAtEstimate { plan, steps, end, .. } = *arm;
    let PassWork {
        jacobian,
        turned,
        axes,
        terms,
        shift_gradient,
        turn_gradient,
        given_gradient,
        square: square_sum,
        waiting,
        ..
    } = work;
    let rows = work.turned_rows;
    let Some((noise, rest)) = block.split_first_chunk::<2>() else { return none };
    let Some((position, rest)) = rest.split_first_chunk::<3>() else { return none };
    let (measured, joints) = rest.split_at(if plan.is_pose() { 9 } else { 0 });
    let (weight, per_length) = (Lanes::load(simd, &noise[0], part), Lanes::splat(simd, 1.0 / plan.length_m));
    let weights = &noise[0].0[part * S::F64_LANES..(part + 1) * S::F64_LANES];
    if !FULL && weights.iter().all(|weight| *weight < f64::MIN_POSITIVE) {
        // All rows are padding of the block. The test is row by row, so that the first row of weight above zero ends it.
        return none;
    }
    // The slice is empty without unknowns.
    let columns = jacobian.get_mut(filled..).unwrap_or_default();
    let stride = *waiting;
    let (joints, factors) = joints.split_at(2 * plan.joints.len());
    let mut batch = Batch { plan, part, columns, stride, axes, terms, shift_gradient, turn_gradient };

    if let (false, Some(shape)) = (PLAIN, arm.shape) {
        let whole = Lanes::splat(simd, 1.0);
        let last = batch.chain::<S, PLAIN>(simd, steps, (joints.as_chunks::<2>().0, factors), whole, per_length);
        let target = if plan.joints.is_empty() { KernelFrame::from_step(simd, end) } else { last.compose(simd, end) };
        let rows = ShapedRows::new((shape, plan.given), first + part * S::F64_LANES, &target, weight);
        let residuals = rows.residual(simd);
        let [force, torque] = rows.wrench(simd);
        let square = residuals[0].dot(residuals[0]) + residuals[1].dot(residuals[1]);
        square.add_to(square_sum, part);
        let wrench = RowWrench { weight: whole, per_length, force, torque: torque.scale(per_length) };
        batch.add_device::<S, FULL>(simd, &target, &wrench);
        batch.add_axes::<S, FULL, PLAIN>(simd, &target, &wrench);
        batch.add_place::<S, FULL>(&target, &wrench);
        if FULL {
            rows.project(simd, plan, batch.columns, stride, part);
        }
        rows.add_given::<S, FULL>(simd, plan, (batch.columns, stride), given_gradient, part);
        return residuals;
    }
    let last = batch.chain::<S, PLAIN>(simd, steps, (joints.as_chunks::<2>().0, factors), weight, per_length);
    let target = if plan.joints.is_empty() { KernelFrame::from_step(simd, end) } else { last.compose(simd, end) };
    let place = Vectors::load(simd, position, part);
    let (direction, force, residual) = match plan.along {
        Some(along) if !PLAIN => {
            let (direction, error) = one_number(simd, along, place, target.origin());
            let (number, zero) = (error * weight, Lanes::splat(simd, 0.0));
            (Some(direction), direction.scale(number), Vectors([number, zero, zero]))
        }
        Some(_) | None => {
            let force = (place - target.origin()).scale(weight);
            (None, force, force)
        }
    };
    let mut squares = residual.dot(residual);
    let mut residuals = [residual, none[1]];
    let mut wrench = RowWrench { weight, per_length, force, torque: none[1] };
    let mut turn = None;
    if let [x, y, z] = measured.as_chunks::<3>().0 {
        let measured = [Vectors::load(simd, x, part), Vectors::load(simd, y, part), Vectors::load(simd, z, part)];
        let found = ResidualRotations::new(simd, &measured, &[target.column(0), target.column(1), target.column(2)]);
        let ratio = Lanes::load(simd, &noise[1], part);
        let whitened = found.r.scale(weight * ratio);
        squares = squares + whitened.dot(whitened);
        residuals[1] = whitened;
        wrench.torque = whitened.scale(ratio * per_length);
        turn = Some((found, ratio * per_length));
    }
    squares.add_to(square_sum, part);
    batch.add_device::<S, FULL>(simd, &target, &wrench);
    batch.add_axes::<S, FULL, PLAIN>(simd, &target, &wrench);
    batch.add_place::<S, FULL>(&target, &wrench);
    if let (true, true, Some((turn, ratio))) = (FULL, rows > 0, turn) {
        batch.add_turned(simd, &turn, ratio, turned.get_mut(filled * rows..).unwrap_or_default(), rows);
    }
    if let (true, Some(direction)) = (FULL, direction) {
        project(simd, jacobian, (plan.columns(), stride), filled, direction, part);
    }
    residuals
}

/// Direction along which one number was measured, and the number less the predicted one.
#[inline(always)]
fn one_number<S: Simd>(
    simd: S,
    along: PlaceComponent,
    measured: Vectors<S>,
    predicted: Vectors<S>,
) -> (Vectors<S>, Lanes<S>) {
    match along {
        PlaceComponent::Height => {
            let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
            (Vectors([zero, zero, one]), measured.0[2] - predicted.0[2])
        }
        PlaceComponent::Distance => {
            let distance = predicted.dot(predicted).sqrt();
            // There is one division: it takes as long as a dozen products.
            let inverse = Lanes::splat(simd, 1.0).divide_or(distance, 0.0);
            (predicted.scale(inverse), measured.0[0] - distance)
        }
    }
}

/// Replaces the columns of a block by their components along a direction, block after block in the order of memory: those of three blocks
/// fill one block of positions.
#[inline(always)]
fn project<S: Simd>(
    simd: S,
    columns: &mut [[LaneBlock; 3]],
    (count, stride): (usize, usize),
    filled: usize,
    direction: Vectors<S>,
    part: usize,
) {
    for column in columns.chunks_exact_mut(stride).take(count) {
        let Some(whole) = column.get(filled) else { continue };
        let moved = Vectors::load(simd, whole, part).dot(direction);
        if let Some(number) = column.as_flattened_mut().get_mut(filled) {
            moved.store(number, part);
        }
    }
}
