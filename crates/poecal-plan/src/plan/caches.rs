//! Data of the criterion for each candidate, kept up to date while configurations are chosen.

use super::blocks::ConfigurationRows;
use super::change::{MOST_NUMBERS, PlanChange, dot, weight};
use super::state::{CovarianceState, CriterionContext, CriterionWeights, own_rows, scale_rows};
use poecal_numerics::kernels::by_best;

/// Data of the criterion for each candidate, kept up to date.
#[derive(Clone, Debug)]
pub(crate) struct Caches {
    m: usize,
    c: usize,
    /// `S`, `T` of geometry, of all, `R Rᵀ`, `Z Rᵀ` for each candidate.
    small: Vec<f64>,
    /// `R` and `Z` for each candidate.
    long: Vec<f64>,
}

/// Candidates that one thread processes at a time.
const CHUNK: usize = 256;

impl Caches {
    fn small_len(&self) -> usize {
        6 * self.m * self.m
    }

    fn long_len(&self) -> usize {
        2 * self.m * self.c
    }

    pub(crate) fn new(state: &CovarianceState, aim: &CriterionContext, blocks: &ConfigurationRows) -> Self {
        let (m, c) = (blocks.numbers, aim.modes());
        let mut made = Caches { m, c, small: Vec::new(), long: Vec::new() };
        let count = blocks.count();
        made.small = vec![0.0; count * made.small_len()];
        made.long = vec![0.0; count * made.long_len()];
        made.for_each_part(|index, small, long| {
            let rows = blocks.rows_of_configuration(index);
            by_best(
                #[inline(always)]
                || begin(state, aim, (rows, m), (small, long)),
            );
        });
        made
    }

    /// Calls with the parts of each candidate.
    fn for_each_part(&mut self, one: impl Fn(usize, &mut [f64], &mut [f64]) + Sync + Send) {
        let (small_len, long_len) = (self.small_len(), self.long_len());
        let count = self.small.len() / small_len.max(1);
        if long_len == 0 {
            poecal_numerics::threads::fill_chunks(&mut self.small, CHUNK * small_len, |chunk, some| {
                for (at, small) in some.chunks_exact_mut(small_len).enumerate() {
                    one(chunk * CHUNK + at, small, &mut []);
                }
            });
            return;
        }
        let mut parts: Vec<(usize, &mut [f64], &mut [f64])> = self
            .small
            .chunks_mut(CHUNK * small_len)
            .zip(self.long.chunks_mut(CHUNK * long_len))
            .enumerate()
            .map(|(chunk, (small, long))| (chunk * CHUNK, small, long))
            .collect();
        debug_assert!(count == 0 || !parts.is_empty());
        poecal_numerics::threads::fill_chunks(&mut parts, 1, |_, some| {
            for (first, small, long) in some {
                let both = small.chunks_exact_mut(small_len).zip(long.chunks_exact_mut(long_len));
                for (at, (small, long)) in both.enumerate() {
                    one(*first + at, small, long);
                }
            }
        });
    }

    /// Brings all up to date after a change.
    pub(crate) fn apply(&mut self, aim: &CriterionContext, blocks: &ConfigurationRows, change: &PlanChange) {
        match self.m {
            ..=3 => self.apply_of::<9>(aim, blocks, change),
            4..=6 => self.apply_of::<36>(aim, blocks, change),
            _ => self.apply_of::<{ MOST_NUMBERS * MOST_NUMBERS }>(aim, blocks, change),
        }
    }

    fn apply_of<const S: usize>(&mut self, aim: &CriterionContext, blocks: &ConfigurationRows, change: &PlanChange) {
        let (m, c, root) = (self.m, self.c, aim.share.sqrt());
        self.for_each_part(|index, small, long| {
            let rows = blocks.rows_of_configuration(index);
            by_best(
                #[inline(always)]
                || follow::<S>((rows, blocks.columns), (small, long), (m, c, root), change),
            );
        });
    }

    /// Decrease of the criterion with an additional candidate; below zero if its rows cannot be used.
    pub(crate) fn gain(&self, index: usize, weights: &CriterionWeights) -> f64 {
        match self.m {
            ..=3 => self.gain_of::<9>(index, weights),
            4..=6 => self.gain_of::<36>(index, weights),
            _ => self.gain_of::<{ MOST_NUMBERS * MOST_NUMBERS }>(index, weights),
        }
    }

    fn gain_of<const S: usize>(&self, index: usize, weights: &CriterionWeights) -> f64 {
        let (m, square) = (self.m, self.m * self.m);
        let small = &self.small[index * self.small_len()..(index + 1) * self.small_len()];
        let part = |at: usize| &small[at * square..(at + 1) * square];
        let mut w = [0.0; S];
        let mut gain = 0.0;
        let trace = |a: &[f64; S], b: &[f64]| a[..square].iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        if weights.calibrated > 0.0 || weights.determinant > 0.0 {
            let Some(logarithm) = weight(part(0), m, 1.0, &mut w) else { return -1.0 };
            let mut bias = 0.0;
            if self.c > 0 {
                // 2 tr(W Xᵀ) + tr(W T W Q), X = Z Rᵀ.
                let wtw = small_product(&w, &small_product::<S>(part(1), &w, m), m);
                bias = 2.0 * trace(&w, part(5)) + trace(&wtw, part(4));
            }
            gain += weights.calibrated * (trace(&w, part(1)) - bias) + weights.determinant * logarithm;
        }
        if weights.corrected > 0.0 {
            if weight(part(2), m, 1.0, &mut w).is_none() {
                return -1.0;
            }
            gain += weights.corrected * trace(&w, part(3));
        }
        gain
    }

    /// Number of candidates.
    pub(crate) fn count(&self) -> usize {
        self.small.len() / self.small_len().max(1)
    }
}

/// Initial data of a candidate.
#[inline(always)]
fn begin(
    state: &CovarianceState,
    aim: &CriterionContext,
    (rows, m): (&[f64], usize),
    (small, long): (&mut [f64], &mut [f64]),
) {
    let (g, c) = (aim.geometry, aim.modes());
    let scaled = scale_rows(rows, aim);
    let mut own = vec![0.0; g + c];
    let parts = [
        (0, &state.own[0], g, &scaled[..]),
        (1, &state.own[1], g, &scaled[..]),
        (2, &state.all[0], g + c, rows),
        (3, &state.all[1], g + c, rows),
    ];
    for (at, matrix, n, rows) in parts {
        if matrix.nrows() != n {
            continue;
        }
        for i in 0..m {
            let row = &rows[i * (g + c)..][..n];
            for (own, column) in own.iter_mut().zip(matrix.as_slice().chunks_exact(n)) {
                *own = dot(row, column);
            }
            for j in 0..m {
                small[at * m * m + i * m + j] = dot(&own[..n], &rows[j * (g + c)..][..n]);
            }
        }
    }
    let (r, z) = long.split_at_mut(m * c);
    own_rows(state, aim, &scaled, m, r, z);
    squares_of(small, r, z, m, c);
}

/// Data of a candidate after a change.
#[inline(always)]
fn follow<const S: usize>(
    (rows, n): (&[f64], usize),
    (small, long): (&mut [f64], &mut [f64]),
    (m, c, root): (usize, usize, f64),
    change: &PlanChange,
) {
    let PlanChange { own, all, pulled, turned } = change;
    let (mut a, mut b) = ([0.0; S], [0.0; S]);
    for (at, part, scale) in [(0, Some(own), root), (2, all.as_ref(), 1.0)] {
        let Some(part) = part else { continue };
        for i in 0..m {
            let row = &rows[i * n..i * n + part.n];
            for j in 0..m {
                a[i * m + j] = scale * dot(row, &part.k[j * part.n..(j + 1) * part.n]);
                b[i * m + j] = scale * dot(row, &part.l[j * part.n..(j + 1) * part.n]);
            }
        }
        if at == 0 && c > 0 {
            let (r, z) = long.split_at_mut(m * c);
            for i in 0..m {
                let (r, z) = (&mut r[i * c..(i + 1) * c], &mut z[i * c..(i + 1) * c]);
                for j in 0..m {
                    let (pulled, turned) = (&pulled[j * c..(j + 1) * c], &turned[j * c..(j + 1) * c]);
                    let (a, b) = (a[i * m + j], b[i * m + j]);
                    for ((r, z), (pulled, turned)) in r.iter_mut().zip(z.iter_mut()).zip(pulled.iter().zip(turned)) {
                        *r -= a * pulled;
                        *z += b * pulled - a * turned;
                    }
                }
            }
        }
        // S -= a W aᵀ, T -= a W bᵀ + b W aᵀ - a W T W aᵀ.
        for i in 0..m {
            let (mut aw, mut rest) = ([0.0; S], [0.0; S]);
            for j in 0..m {
                for k in 0..m {
                    aw[j] += a[i * m + k] * part.w[k * m + j];
                    rest[j] += b[i * m + k] * part.w[k * m + j] - a[i * m + k] * part.wtw[k * m + j];
                }
            }
            for j in 0..m {
                let (mut s, mut t) = (0.0, 0.0);
                for k in 0..m {
                    s += aw[k] * a[j * m + k];
                    t += aw[k] * b[j * m + k] + rest[k] * a[j * m + k];
                }
                small[at * m * m + i * m + j] -= s;
                small[(at + 1) * m * m + i * m + j] -= t;
            }
        }
    }
    let (r, z) = long.split_at(m * c);
    squares_of(small, r, z, m, c);
}

#[inline(always)]
fn small_product<const S: usize>(a: &[f64], b: &[f64], m: usize) -> [f64; S] {
    let mut out = [0.0; S];
    for i in 0..m {
        for j in 0..m {
            out[i * m + j] = (0..m).map(|k| a[i * m + k] * b[k * m + j]).sum();
        }
    }
    out
}

/// `R Rᵀ` and `Z Rᵀ`.
#[inline(always)]
fn squares_of(small: &mut [f64], r: &[f64], z: &[f64], m: usize, c: usize) {
    for i in 0..m {
        for j in 0..m {
            let other = &r[j * c..(j + 1) * c];
            small[4 * m * m + i * m + j] = dot(&r[i * c..(i + 1) * c], other);
            small[5 * m * m + i * m + j] = dot(&z[i * c..(i + 1) * c], other);
        }
    }
}
