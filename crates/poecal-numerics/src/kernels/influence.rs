//! Influence of several rows: their blocks of the hat matrix, and their studentised residuals (theory.md §6 (34d) and (34e)).

use pulp::Simd;

use super::dense::Factor;
use super::vector::{LaneBlock, Lanes, from_index, parts};

/// Length of a row's residual: three numbers of a position, three of a rotation.
pub const NUMBERS: usize = 6;

/// For each of several rows the trace of `H = J N⁻¹ Jᵀ`, and `eᵀ ((1 + least) I - w H)⁻¹ (I + (1 - w) H)⁻¹ e`: theory.md §6 (34d) and
/// (34e). The Jacobian's columns follow one another and are overwritten; rotation rows of the first `shifts` of them are zero.
#[inline(always)]
pub(crate) fn influences<S: Simd>(
    simd: S,
    factor: &Factor,
    shifts: usize,
    jacobian: &mut [[LaneBlock; NUMBERS]],
    residual: &[LaneBlock; NUMBERS],
    weight: &LaneBlock,
    least: f64,
) -> [LaneBlock; 2] {
    let mut found = [LaneBlock::ZERO; 2];
    let jacobian = &mut jacobian[..factor.n];
    for part in parts(simd) {
        for i in 0..factor.n {
            let (done, later) = jacobian.split_at_mut(i);
            let mut own: [Lanes<S>; NUMBERS] = from_index(
                simd,
                #[inline(always)]
                |k| Lanes::load(simd, &later[0][k], part),
            );
            let (moved, turned) = done.split_at(shifts.min(i));
            let mut above = factor.column(i);
            for (column, value) in moved.iter().zip(&mut above) {
                let value = Lanes::splat(simd, value);
                own = from_index(
                    simd,
                    #[inline(always)]
                    |k| match own[k] {
                        own if k < NUMBERS / 2 => Lanes::load(simd, &column[k], part).times_from(value, own),
                        own => own,
                    },
                );
            }
            for (column, value) in turned.iter().zip(above) {
                let value = Lanes::splat(simd, value);
                own = from_index(
                    simd,
                    #[inline(always)]
                    |k| Lanes::load(simd, &column[k], part).times_from(value, own[k]),
                );
            }
            let inverse = Lanes::splat(simd, factor.inverses[i]);
            for (own, wide) in own.into_iter().zip(&mut later[0]) {
                (own * inverse).store(wide, part);
            }
        }
        let hat = sum_products(simd, jacobian, part);
        let trace = (1..NUMBERS).fold(hat[0][0], |sum, k| sum + hat[k][k]);
        trace.store(&mut found[0], part);
        let weight = Lanes::load(simd, weight, part);
        let whole = Lanes::splat(simd, 1.0);
        let residual: [Lanes<S>; NUMBERS] = from_index(
            simd,
            #[inline(always)]
            |k| Lanes::load(simd, &residual[k], part),
        );
        let left_out = solve_lanes(simd, &hat, -weight, Lanes::splat(simd, 1.0 + least), residual);
        let judged = solve_lanes(simd, &hat, whole - weight, whole, left_out);
        let sum = (1..NUMBERS).fold(residual[0] * judged[0], |sum, k| residual[k].times_plus(judged[k], sum));
        sum.store(&mut found[1], part);
    }
    found
}

/// `Σ yᵢ yᵢᵀ` of these columns, its upper triangle.
#[inline(always)]
fn sum_products<S: Simd>(simd: S, columns: &[[LaneBlock; NUMBERS]], part: usize) -> [[Lanes<S>; NUMBERS]; NUMBERS] {
    let mut sum = [[Lanes::splat(simd, 0.0); NUMBERS]; NUMBERS];
    for column in columns {
        let own: [Lanes<S>; NUMBERS] = from_index(
            simd,
            #[inline(always)]
            |k| Lanes::load(simd, &column[k], part),
        );
        for (k, row) in sum.iter_mut().enumerate() {
            *row = from_index(
                simd,
                #[inline(always)]
                |l| if l < k { row[l] } else { own[k].times_plus(own[l], row[l]) },
            );
        }
    }
    sum
}

/// Solution of `(diagonal I + share H) x = b`. A pivot that is not positive, by rounding, counts as infinite.
#[inline(always)]
fn solve_lanes<S: Simd>(
    simd: S,
    hat: &[[Lanes<S>; NUMBERS]; NUMBERS],
    share: Lanes<S>,
    diagonal: Lanes<S>,
    mut x: [Lanes<S>; NUMBERS],
) -> [Lanes<S>; NUMBERS] {
    // Arrays are not mapped by `map`: its closure would not be compiled for the vector instructions.
    let mut rows = *hat;
    for (k, row) in rows.iter_mut().enumerate() {
        for value in row.iter_mut() {
            *value = *value * share;
        }
        row[k] = row[k] + diagonal;
    }
    let mut inverses = [diagonal; NUMBERS];
    for k in 0..NUMBERS {
        inverses[k] = Lanes::splat(simd, 1.0).divide_or(rows[k][k], 0.0);
        let own = rows[k];
        for l in k + 1..NUMBERS {
            let factor = own[l] * inverses[k];
            let row = rows[l];
            rows[l] = from_index(
                simd,
                #[inline(always)]
                |m| own[m].times_from(factor, row[m]),
            );
            x[l] = x[k].times_from(factor, x[l]);
        }
    }
    for k in (0..NUMBERS).rev() {
        let mut sum = x[k];
        for l in k + 1..NUMBERS {
            sum = rows[k][l].times_from(x[l], sum);
        }
        x[k] = sum * inverses[k];
    }
    x
}
