//! Cholesky factor of a small dense matrix and solutions with it. Rows are padded to whole wide numbers, so that no loop has a remainder.

use pulp::Simd;

use super::vector::{LaneBlock, Lanes, WIDTH, from_index, parts};

/// The factor `R` of `RᵀR`: upper, row after row. Elements on and below the diagonal are arbitrary.
#[derive(Clone, Debug, Default)]
pub struct Factor {
    pub(crate) n: usize,
    rows: Vec<LaneBlock>,
    /// Inverses of the diagonal.
    pub(crate) inverses: Vec<f64>,
}

impl Factor {
    /// Elements of a column from the top, of which those above the diagonal are valid.
    #[inline(always)]
    pub(crate) fn column(&self, column: usize) -> impl Iterator<Item = f64> {
        let (block, lane) = (column / WIDTH, column % WIDTH);
        let stride = self.n.div_ceil(WIDTH).max(1);
        self.rows.get(block..).unwrap_or_default().iter().step_by(stride).map(move |wide| wide.0[lane])
    }

    /// Smallest pivot of the factorisation.
    pub(crate) fn smallest_pivot(&self) -> f64 {
        self.inverses.iter().fold(0.0, |most: f64, &inverse| most.max(inverse)).powi(-2)
    }
}

/// Number of rows that are eliminated together.
const PANEL: usize = 4;

/// Factor of the matrix with this upper triangle (row-major `n × n`) plus `damping` on the diagonal; `None` if that is not positive
/// definite.
#[inline(always)]
pub(crate) fn cholesky<S: Simd>(simd: S, upper: &[f64], n: usize, damping: f64) -> Option<Factor> {
    let stride = n.div_ceil(WIDTH);
    let mut rows = vec![LaneBlock::ZERO; n.next_multiple_of(PANEL) * stride];
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
        subtract_all(simd, panel, above, stride, i);
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
                for part in parts(simd) {
                    (Lanes::load(simd, wide, part) * Lanes::splat(simd, inverse)).store(wide, part);
                }
            }
            for (other, later) in later.chunks_exact_mut(stride).enumerate() {
                subtract(simd, &mut later[block..], row, row[0].0[lane + 1 + other]);
            }
        }
    }
    Some(Factor { n, rows, inverses })
}

/// Eliminates the finished rows `above` from the rows of a panel, the first of which is row `i`.
#[inline(always)]
fn subtract_all<S: Simd>(simd: S, panel: &mut [LaneBlock], above: &[LaneBlock], stride: usize, i: usize) {
    let (first, lane) = (i / WIDTH, i % WIDTH);
    for block in first..stride {
        for part in parts(simd) {
            let mut values: [Lanes<S>; PANEL] = from_index(
                simd,
                #[inline(always)]
                |k| Lanes::load(simd, &panel[k * stride + block], part),
            );
            for row in above.chunks_exact(stride) {
                let other = Lanes::load(simd, &row[block], part);
                for (value, &factor) in values.iter_mut().zip(&row[first].0[lane..lane + PANEL]) {
                    *value = other.times_from(Lanes::splat(simd, factor), *value);
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
fn subtract<S: Simd>(simd: S, row: &mut [LaneBlock], other: &[LaneBlock], factor: f64) {
    let factor = Lanes::splat(simd, factor);
    for (wide, other) in row.iter_mut().zip(other) {
        for part in parts(simd) {
            Lanes::load(simd, other, part).times_from(factor, Lanes::load(simd, wide, part)).store(wide, part);
        }
    }
}

/// Solves `Rᵀ x = b` in place.
#[inline(always)]
fn lower_solve<S: Simd>(simd: S, factor: &Factor, x: &mut [f64]) {
    let stride = factor.n.div_ceil(WIDTH);
    let mut wide = vec![LaneBlock::ZERO; stride];
    for (wide, x) in wide.iter_mut().zip(x.chunks(WIDTH)) {
        wide.0[..x.len()].copy_from_slice(x);
    }
    for (i, row) in factor.rows.chunks_exact(stride.max(1)).take(factor.n).enumerate() {
        let first = i / WIDTH;
        x[i] = wide[first].0[i % WIDTH] * factor.inverses[i];
        subtract(simd, &mut wide[first..], &row[first..], x[i]);
    }
}

/// Solves `RᵀR x = b` in place.
#[inline(always)]
pub(crate) fn solve<S: Simd>(simd: S, factor: &Factor, x: &mut [f64]) {
    lower_solve(simd, factor, x);
    let stride = factor.n.div_ceil(WIDTH);
    let mut found = vec![LaneBlock::ZERO; stride];
    for (i, row) in factor.rows.chunks_exact(stride.max(1)).take(factor.n).enumerate().rev() {
        let (block, lane) = (i / WIDTH, i % WIDTH);
        let mut sum = Lanes::splat(simd, 0.0);
        for (row, found) in row[block + 1..].iter().zip(&found[block + 1..]) {
            for part in parts(simd) {
                sum = Lanes::load(simd, row, part).times_plus(Lanes::load(simd, found, part), sum);
            }
        }
        // A vector that has just been written in part takes long to be loaded.
        let own: f64 = (lane + 1..WIDTH).map(|other| row[block].0[other] * found[block].0[other]).sum();
        x[i] = (x[i] - (sum.sum() + own)) * factor.inverses[i];
        found[block].0[lane] = x[i];
    }
}

/// The inverse (row-major) of the matrix that was factorised: `WᵀW` with `W = R⁻ᵀ`, of which row i ends with column i.
#[inline(always)]
pub(crate) fn inverse<S: Simd>(simd: S, factor: &Factor) -> Vec<f64> {
    let n = factor.n;
    let stride = n.div_ceil(WIDTH).max(1);
    let mut lower = vec![LaneBlock::ZERO; n * stride];
    for (i, &pivot) in factor.inverses.iter().enumerate() {
        let (done, own) = lower.split_at_mut(i * stride);
        own[i / WIDTH].0[i % WIDTH] = 1.0;
        for (block, own) in own.iter_mut().enumerate().take(i / WIDTH + 1) {
            for part in parts(simd) {
                let mut sum = Lanes::load(simd, own, part);
                let both = done.chunks_exact(stride).zip(factor.rows.chunks_exact(stride));
                for (row, factor) in both.skip(block * WIDTH) {
                    let value = Lanes::splat(simd, factor[i / WIDTH].0[i % WIDTH]);
                    sum = Lanes::load(simd, &row[block], part).times_from(value, sum);
                }
                (sum * Lanes::splat(simd, pivot)).store(own, part);
            }
        }
    }
    let mut inverse = vec![0.0; n * n];
    for i in 0..n {
        for block in i / WIDTH..stride {
            let mut wide = LaneBlock::ZERO;
            for part in parts(simd) {
                let mut sum = Lanes::splat(simd, 0.0);
                for row in lower.chunks_exact(stride).skip(block * WIDTH) {
                    let value = Lanes::splat(simd, row[i / WIDTH].0[i % WIDTH]);
                    sum = Lanes::load(simd, &row[block], part).times_plus(value, sum);
                }
                sum.store(&mut wide, part);
            }
            for (j, &value) in (block * WIDTH..n).zip(&wide.0) {
                (inverse[i * n + j], inverse[j * n + i]) = (value, value);
            }
        }
    }
    inverse
}
