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

impl Factor {
    /// The least that remained of a diagonal element when those before it were eliminated.
    pub(crate) fn smallest_pivot(&self) -> f64 {
        self.inverses.iter().fold(0.0, |most: f64, &inverse| most.max(inverse)).powi(-2)
    }
}

/// Rows that are eliminated together.
const PANEL: usize = 4;

/// Factor of the matrix given by its upper triangle (row-major `n × n`) plus `damping` on the diagonal; `None` if that is not positive
/// definite.
#[inline(always)]
pub(super) fn cholesky<V: Vector>(upper: &[f64], n: usize, damping: f64) -> Option<Factor> {
    let stride = n.div_ceil(WIDTH);
    let mut rows = vec![Wide::ZERO; n.next_multiple_of(PANEL) * stride];
    let mut inverses = Vec::with_capacity(n);
    for i in (0..n).step_by(PANEL) {
        let (above, rest) = rows.split_at_mut(i * stride);
        let panel = &mut rest[..PANEL * stride];
        let block = i / WIDTH;
        for (row, source) in panel.chunks_exact_mut(stride).zip(upper[i * n..].chunks_exact(n)) {
            for (wide, source) in row.iter_mut().zip(source.chunks(WIDTH)).skip(block) {
                wide.0[..source.len()].copy_from_slice(source);
            }
        }
        subtract_all::<V>(panel, above, stride, i);
        for k in 0..PANEL.min(n - i) {
            let (done, later) = panel.split_at_mut((k + 1) * stride);
            let row = &mut done[k * stride + block..];
            let lane = i % WIDTH + k;
            let pivot = row[0].0[lane] + damping;
            if pivot.is_nan() || pivot <= 0.0 {
                return None;
            }
            let inverse = 1.0 / pivot.sqrt();
            inverses.push(inverse);
            for wide in row.iter_mut() {
                for part in 0..WIDTH / V::LANES {
                    (V::load(wide, part) * V::splat(inverse)).store(wide, part);
                }
            }
            for (other, later) in later.chunks_exact_mut(stride).enumerate() {
                subtract::<V>(&mut later[block..], row, row[0].0[lane + 1 + other]);
            }
        }
    }
    Some(Factor { n, rows, inverses })
}

/// Takes from the rows of a panel, the first of which is row `i`, what the finished rows above have in common with them.
#[inline(always)]
fn subtract_all<V: Vector>(panel: &mut [Wide], above: &[Wide], stride: usize, i: usize) {
    let (first, lane) = (i / WIDTH, i % WIDTH);
    for block in first..stride {
        for part in 0..WIDTH / V::LANES {
            let mut values: [V; PANEL] = std::array::from_fn(|k| V::load(&panel[k * stride + block], part));
            for row in above.chunks_exact(stride) {
                let other = V::load(&row[block], part);
                for (value, &factor) in values.iter_mut().zip(&row[first].0[lane..lane + PANEL]) {
                    *value = other.times_from(V::splat(factor), *value);
                }
            }
            for (k, value) in values.into_iter().enumerate() {
                value.store(&mut panel[k * stride + block], part);
            }
        }
    }
}

/// `row -= factor · other`.
#[inline(always)]
fn subtract<V: Vector>(row: &mut [Wide], other: &[Wide], factor: f64) {
    let factor = V::splat(factor);
    for (wide, other) in row.iter_mut().zip(other) {
        for part in 0..WIDTH / V::LANES {
            V::load(other, part).times_from(factor, V::load(wide, part)).store(wide, part);
        }
    }
}

/// Solves `Rᵀ x = b` in place.
#[inline(always)]
fn lower_solve<V: Vector>(factor: &Factor, x: &mut [f64]) {
    let stride = factor.n.div_ceil(WIDTH);
    let mut wide = vec![Wide::ZERO; stride];
    for (wide, x) in wide.iter_mut().zip(x.chunks(WIDTH)) {
        wide.0[..x.len()].copy_from_slice(x);
    }
    for (i, row) in factor.rows.chunks_exact(stride.max(1)).take(factor.n).enumerate() {
        let first = i / WIDTH;
        x[i] = wide[first].0[i % WIDTH] * factor.inverses[i];
        subtract::<V>(&mut wide[first..], &row[first..], x[i]);
    }
}

/// Solves `RᵀR x = b` in place.
#[inline(always)]
pub(super) fn solve<V: Vector>(factor: &Factor, x: &mut [f64]) {
    lower_solve::<V>(factor, x);
    let stride = factor.n.div_ceil(WIDTH);
    let mut found = vec![Wide::ZERO; stride];
    for (i, row) in factor.rows.chunks_exact(stride.max(1)).take(factor.n).enumerate().rev() {
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

/// `J N⁻¹ Jᵀ` of a Jacobian (row-major) of at most [`WIDTH`] rows, which stand side by side in the lanes; `columns` is room to work in.
#[inline(always)]
pub(super) fn hat<V: Vector>(
    factor: &Factor,
    jacobian: &[f64],
    columns: &mut Vec<Wide>,
) -> [[f64; WIDTH]; WIDTH] {
    let n = factor.n;
    columns.clear();
    columns.resize(n.next_multiple_of(PANEL), Wide::ZERO);
    for (lane, row) in jacobian.chunks_exact(n.max(1)).take(WIDTH).enumerate() {
        columns.iter_mut().zip(row).for_each(|(wide, &value)| wide.0[lane] = value);
    }
    for part in 0..WIDTH / V::LANES {
        lower_solve_all::<V>(factor, columns, part);
    }
    let mut hat = [Wide::ZERO; WIDTH];
    for part in 0..WIDTH / V::LANES {
        let mut sums = [V::splat(0.0); WIDTH];
        for own in columns.iter() {
            let wide = V::load(own, part);
            for (sum, &value) in sums.iter_mut().zip(&own.0) {
                *sum = wide.times_plus(V::splat(value), *sum);
            }
        }
        sums.into_iter().zip(&mut hat).for_each(|(sum, wide)| sum.store(wide, part));
    }
    hat.map(|wide| wide.0)
}

/// Solves `Rᵀ X = B` in place for the right sides in one part of the lanes.
#[inline(always)]
fn lower_solve_all<V: Vector>(factor: &Factor, columns: &mut [Wide], part: usize) {
    let stride = factor.n.div_ceil(WIDTH);
    for i in (0..factor.n).step_by(PANEL) {
        let (block, lane) = (i / WIDTH, i % WIDTH);
        let (done, rest) = columns.split_at_mut(i);
        let mut values: [V; PANEL] = std::array::from_fn(|k| V::load(&rest[k], part));
        let (above, own) = factor.rows.split_at(i * stride);
        for (done, row) in done.iter().zip(above.chunks_exact(stride)) {
            let done = V::load(done, part);
            let factors = &row[block].0.as_chunks::<PANEL>().0[lane / PANEL];
            for (value, &factor) in values.iter_mut().zip(factors) {
                *value = done.times_from(V::splat(factor), *value);
            }
        }
        for k in 0..PANEL {
            let inverse = factor.inverses.get(i + k).copied().unwrap_or(0.0);
            values[k] = values[k] * V::splat(inverse);
            let factors = &own[k * stride + block].0.as_chunks::<PANEL>().0[lane / PANEL];
            for later in k + 1..PANEL {
                values[later] = values[k].times_from(V::splat(factors[later]), values[later]);
            }
        }
        values.into_iter().zip(rest).for_each(|(value, wide)| value.store(wide, part));
    }
}
