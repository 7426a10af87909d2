//! Cholesky factor of a small dense matrix and solutions with it. Rows are filled up to whole wide numbers, so that no loop has a rest.

use super::vector::{Vector, WIDTH, Wide};

/// The factor `R` of `RᵀR`: upper, row after row; its diagonal, and what is below it, means nothing.
#[derive(Clone, Debug)]
pub(crate) struct Factor {
    n: usize,
    rows: Vec<Wide>,
    /// Inverses of the diagonal.
    inverses: Vec<f64>,
}

/// Factor of the matrix given by its upper triangle (row-major `n × n`) plus `damping` on the diagonal; `None` if that is not positive
/// definite.
#[inline(always)]
pub(super) fn cholesky<V: Vector>(upper: &[f64], n: usize, damping: f64) -> Option<Factor> {
    let stride = n.div_ceil(WIDTH);
    let mut factor = Factor { n, rows: vec![Wide::ZERO; n * stride], inverses: Vec::with_capacity(n) };
    for (i, source) in upper.chunks_exact(n.max(1)).enumerate() {
        let (above, rest) = factor.rows.split_at_mut(i * stride);
        let (first, row) = (i / WIDTH, &mut rest[..stride]);
        for (wide, source) in row.iter_mut().zip(source.chunks(WIDTH)).skip(first) {
            wide.0[..source.len()].copy_from_slice(source);
        }
        // Four rows above at a time: each number of this row is loaded and stored a quarter as often.
        let mut fours = above.chunks_exact(4 * stride);
        for four in &mut fours {
            let (a, b) = four.split_at(2 * stride);
            let ((a, b), (c, d)) = (a.split_at(stride), b.split_at(stride));
            let lane = i % WIDTH;
            let factors = [a[first].0[lane], b[first].0[lane], c[first].0[lane], d[first].0[lane]];
            subtract::<V, 4>(
                &mut row[first..],
                [&a[first..], &b[first..], &c[first..], &d[first..]],
                factors,
            );
        }
        for other in fours.remainder().chunks_exact(stride) {
            subtract::<V, 1>(&mut row[first..], [&other[first..]], [other[first].0[i % WIDTH]]);
        }
        let pivot = row[first].0[i % WIDTH] + damping;
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        let inverse = 1.0 / pivot.sqrt();
        factor.inverses.push(inverse);
        let inverse = V::splat(inverse);
        for wide in &mut row[first..] {
            for part in 0..WIDTH / V::LANES {
                (V::load(wide, part) * inverse).store(wide, part);
            }
        }
    }
    Some(factor)
}

/// `row -= Σ factor · other`.
#[inline(always)]
fn subtract<V: Vector, const N: usize>(row: &mut [Wide], others: [&[Wide]; N], factors: [f64; N]) {
    for (at, wide) in row.iter_mut().enumerate() {
        for part in 0..WIDTH / V::LANES {
            let mut value = V::load(wide, part);
            for (other, factor) in others.iter().zip(factors) {
                value = V::load(&other[at], part).times_from(V::splat(factor), value);
            }
            value.store(wide, part);
        }
    }
}

/// Solves `Rᵀ x = b` in place.
#[inline(always)]
pub(super) fn lower_solve<V: Vector>(factor: &Factor, x: &mut [f64]) {
    let stride = factor.n.div_ceil(WIDTH);
    let mut wide = vec![Wide::ZERO; stride];
    for (wide, x) in wide.iter_mut().zip(x.chunks(WIDTH)) {
        wide.0[..x.len()].copy_from_slice(x);
    }
    for (i, row) in factor.rows.chunks_exact(stride.max(1)).enumerate() {
        let first = i / WIDTH;
        x[i] = wide[first].0[i % WIDTH] * factor.inverses[i];
        subtract::<V, 1>(&mut wide[first..], [&row[first..]], [x[i]]);
    }
}

/// Solves `RᵀR x = b` in place.
#[inline(always)]
pub(super) fn solve<V: Vector>(factor: &Factor, x: &mut [f64]) {
    lower_solve::<V>(factor, x);
    let stride = factor.n.div_ceil(WIDTH);
    let mut found = vec![Wide::ZERO; stride];
    for (i, row) in factor.rows.chunks_exact(stride.max(1)).enumerate().rev() {
        let (block, lane) = (i / WIDTH, i % WIDTH);
        let mut sum = V::splat(0.0);
        for (row, found) in row[block + 1..].iter().zip(&found[block + 1..]) {
            for part in 0..WIDTH / V::LANES {
                sum = V::load(row, part).times_plus(V::load(found, part), sum);
            }
        }
        // A vector that has just been written in part takes long to be loaded.
        let own: f64 = (lane + 1..WIDTH).map(|other| row[block].0[other] * found[block].0[other]).sum();
        x[i] = (x[i] - (sum.sum() + own)) * factor.inverses[i];
        found[block].0[lane] = x[i];
    }
}
