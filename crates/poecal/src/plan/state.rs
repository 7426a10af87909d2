//! The expected errors of a fit, and how they change with a configuration more or less (docs/theory.md, *Choosing configurations*).

use nalgebra::DMatrix;

use super::experiment::{Blocks, inverse};
use crate::lanes::by_best;

/// A sum of products in eight lanes, so that it vectorises.
#[inline(always)]
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    for (a, b) in a.iter().zip(b) {
        for (lane, (a, b)) in lanes.iter_mut().zip(a.iter().zip(b)) {
            *lane += a * b;
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    let [a, b, c, d, e, f, g, h] = lanes;
    ((a + b) + (c + d)) + ((e + f) + (g + h)) + rest
}

/// `out += factor * row`.
#[inline(always)]
pub(super) fn add(out: &mut [f64], factor: f64, row: &[f64]) {
    out.iter_mut().zip(row).for_each(|(out, row)| *out += factor * row);
}

/// What is minimised: weights of the expected squared errors of the calibrated and of the corrected model, and of the logarithm of the
/// determinant of geometry's covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Weights {
    pub(super) calibrated: f64,
    pub(super) corrected: f64,
    pub(super) determinant: f64,
}

/// What does not change while configurations are chosen: priors, and moments of the workspace.
#[derive(Clone, Debug)]
pub(super) struct Aim {
    /// Number of unknowns of geometry; those after them are modes of unit prior.
    pub(super) geometry: usize,
    /// Prior information of all.
    pub(super) prior: DMatrix<f64>,
    /// Moments of the workspace.
    pub(super) moments: DMatrix<f64>,
    pub(super) weights: Weights,
    /// Information of rows for the calibrated model, which takes for noise what it does not describe, as a share of that for the corrected one.
    pub(super) share: f64,
}

/// Expected squared errors over the workspace, m².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Squares {
    /// Of the calibrated model: by noise and prior, where all that it does not describe were noise.
    pub(crate) noise: f64,
    /// The same with the noise that is.
    pub(crate) true_noise: f64,
    /// Of the calibrated model: by the terms that it does not have.
    pub(crate) terms: f64,
    /// Of the corrected model.
    pub(crate) corrected: f64,
    /// Logarithm of the determinant of geometry's information.
    pub(crate) determinant: f64,
}

impl Squares {
    /// Of the calibrated model, as it is made small.
    pub(crate) fn calibrated(&self) -> f64 {
        self.noise + self.terms
    }

    /// Of the calibrated model, as it is.
    pub(crate) fn expected(&self) -> f64 {
        self.true_noise + self.terms
    }

    /// What is minimised.
    pub(super) fn value(&self, weights: &Weights) -> f64 {
        weights.calibrated * self.calibrated() + weights.corrected * self.corrected
            - weights.determinant * self.determinant
    }
}

impl Aim {
    /// Prior information with unit priors of modes.
    pub(super) fn new(prior: &DMatrix<f64>, moments: DMatrix<f64>, weights: Weights, share: f64) -> Self {
        let (g, n) = (prior.nrows(), moments.nrows());
        let mut all = DMatrix::identity(n, n);
        all.view_mut((0, 0), (g, g)).copy_from(prior);
        Aim { geometry: g, prior: all, moments, weights, share }
    }

    fn modes(&self) -> usize {
        self.moments.nrows() - self.geometry
    }

    /// Moments of geometry, of geometry with modes, and of modes.
    fn parts(&self) -> [DMatrix<f64>; 3] {
        let (g, c) = (self.geometry, self.modes());
        let part = |at, size| self.moments.view(at, size).into_owned();
        [part((0, 0), (g, g)), part((0, g), (g, c)), part((g, g), (c, c))]
    }
}

/// Covariances, and what the criterion needs of them, of a fit with some information.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// Covariance of all unknowns, and `H⁻¹ M H⁻¹`.
    all: [DMatrix<f64>; 2],
    /// The same of geometry alone.
    own: [DMatrix<f64>; 2],
    /// How terms pull geometry, `A = H⁻¹ J_gᵀ J_c`, and `E = H⁻¹ (M_gg A - M_gc)`.
    pull: [DMatrix<f64>; 2],
}

impl State {
    /// Of the information of measurements; none if it is not positive definite with the prior.
    pub(super) fn new(aim: &Aim, gram: &DMatrix<f64>) -> Option<(State, Squares)> {
        let (g, c) = (aim.geometry, aim.modes());
        let [mgg, mgc, mcc] = aim.parts();
        let prior = aim.prior.view((0, 0), (g, g));
        let h = gram.view((0, 0), (g, g)) * aim.share + prior;
        let own = inverse(&h)?;
        let spread = &mgg * &own;
        let a = &own * gram.view((0, g), (g, c)) * aim.share;
        let d = &mgg * &a - &mgc;
        let bias = a.dot(&(&d - &mgc)) + mcc.trace();
        let determinant = if aim.weights.determinant > 0.0 { log_determinant(&h)? } else { 0.0 };
        let e = &own * &d;
        let p = &own * &spread;
        // H⁻¹ (share² N + Λ) H⁻¹ with share N = H - Λ.
        let noise = spread.trace();
        let true_noise = aim.share * noise + (1.0 - aim.share) * p.dot(&prior);
        let mut squares = Squares { noise, true_noise, terms: bias.max(0.0), corrected: 0.0, determinant };
        let (all, q) = if aim.weights.corrected > 0.0 {
            let all = inverse(&(gram + &aim.prior))?;
            let spread = &aim.moments * &all;
            squares.corrected = spread.trace();
            let q = &all * &spread;
            (all, q)
        } else {
            (DMatrix::zeros(0, 0), DMatrix::zeros(0, 0))
        };
        Some((State { all: [all, q], own: [own, p], pull: [a, e] }, squares))
    }

    /// What changes with these rows more (`sign` 1) or less (-1); none if nothing would remain positive definite.
    pub(super) fn change(&self, aim: &Aim, rows: &[f64], numbers: usize, sign: f64) -> Option<Change> {
        let (g, c) = (aim.geometry, aim.modes());
        let n = g + c;
        let scaled = scaled(rows, aim);
        let own = Part::new(&self.own, &scaled, (numbers, n, g), sign)?;
        let all = if self.all[0].nrows() > 0 {
            Some(Part::new(&self.all, rows, (numbers, n, n), sign)?)
        } else {
            None
        };
        // R = J_c - J_g A and Z = J_g E.
        let (mut r, mut z) = (vec![0.0; numbers * c], vec![0.0; numbers * c]);
        own_rows(self, aim, &scaled, numbers, &mut r, &mut z);
        let m = numbers;
        let (mut pulled, mut turned) = (vec![0.0; m * c], vec![0.0; m * c]);
        let tw = product(&own.t, &own.w, m);
        let wtw = product(&own.w, &tw, m);
        for i in 0..m {
            for j in 0..m {
                add(&mut pulled[i * c..(i + 1) * c], own.w[i * m + j], &r[j * c..(j + 1) * c]);
                add(&mut turned[i * c..(i + 1) * c], own.w[i * m + j], &z[j * c..(j + 1) * c]);
                add(&mut turned[i * c..(i + 1) * c], wtw[i * m + j], &r[j * c..(j + 1) * c]);
            }
        }
        Some(Change { own, all, pulled, turned })
    }

    /// The state after a change.
    pub(super) fn apply(&mut self, change: &Change, numbers: usize) {
        change.own.apply(&mut self.own, numbers);
        if let Some(all) = &change.all {
            all.apply(&mut self.all, numbers);
        }
        let [a, e] = &mut self.pull;
        let (g, c) = a.shape();
        for column in 0..c {
            for row in 0..g {
                let (mut of_a, mut of_e) = (0.0, 0.0);
                for i in 0..numbers {
                    let (k, l) = (change.own.k[i * g + row], change.own.l[i * g + row]);
                    of_a += k * change.pulled[i * c + column];
                    of_e += l * change.pulled[i * c + column] - k * change.turned[i * c + column];
                }
                a[(row, column)] += of_a;
                e[(row, column)] += of_e;
            }
        }
    }
}

fn log_determinant(matrix: &DMatrix<f64>) -> Option<f64> {
    let n = matrix.nrows();
    let (values, _) = crate::linalg::symmetric_eigen(matrix.as_slice(), n);
    values.iter().all(|&value| value > 0.0).then(|| values.iter().map(|value| value.ln()).sum())
}

/// Rows as the calibrated model counts them.
fn scaled(rows: &[f64], aim: &Aim) -> Vec<f64> {
    let root = aim.share.sqrt();
    rows.iter().map(|value| value * root).collect()
}

/// `R = J_c - J_g A` and `Z = J_g E` of rows.
#[inline(always)]
fn own_rows(state: &State, aim: &Aim, rows: &[f64], numbers: usize, r: &mut [f64], z: &mut [f64]) {
    let (g, c) = (aim.geometry, aim.modes());
    let [a, e] = &state.pull;
    for i in 0..numbers {
        let row = &rows[i * (g + c)..(i + 1) * (g + c)];
        for column in 0..c {
            let own =
                |matrix: &DMatrix<f64>| dot(&row[..g], &matrix.as_slice()[column * g..(column + 1) * g]);
            r[i * c + column] = row[g + column] - own(a);
            z[i * c + column] = own(e);
        }
    }
}

/// `A B` of small row-major matrices.
fn product(a: &[f64], b: &[f64], m: usize) -> Vec<f64> {
    let mut out = vec![0.0; m * m];
    for i in 0..m {
        for j in 0..m {
            out[i * m + j] = (0..m).map(|k| a[i * m + k] * b[k * m + j]).sum();
        }
    }
    out
}

/// Largest number of numbers of a configuration.
pub(super) const MOST_NUMBERS: usize = 24;

/// `(sign + S)⁻¹` of a small symmetric matrix by elimination, and the logarithm of `|sign (sign + S)|`; none if it is not of one sign.
#[inline(always)]
fn weight<const S: usize>(s: &[f64], m: usize, sign: f64, out: &mut [f64; S]) -> Option<f64> {
    // sign (sign + S) = 1 + sign S is positive definite.
    let mut work = [0.0; S];
    for i in 0..m {
        for j in 0..m {
            work[i * m + j] = sign * s[i * m + j] + if i == j { 1.0 } else { 0.0 };
            out[i * m + j] = if i == j { sign } else { 0.0 };
        }
    }
    let mut logarithm = 0.0;
    for k in 0..m {
        let pivot = work[k * m + k];
        if pivot.is_nan() || pivot <= LEAST_PIVOT {
            return None;
        }
        logarithm += pivot.ln();
        for j in 0..m {
            work[k * m + j] /= pivot;
            out[k * m + j] /= pivot;
        }
        for i in (0..m).filter(|&i| i != k) {
            let factor = work[i * m + k];
            for j in 0..m {
                work[i * m + j] -= factor * work[k * m + j];
                out[i * m + j] -= factor * out[k * m + j];
            }
        }
    }
    Some(logarithm)
}

/// Pivot below which what remains without some rows is rounding.
const LEAST_PIVOT: f64 = 1e-9;

/// Rows of a changed configuration, against covariances.
#[derive(Clone, Debug)]
pub(super) struct Part {
    /// Columns that count.
    n: usize,
    /// `H⁻¹ Jᵀ` and `P Jᵀ`, a row for each number.
    k: Vec<f64>,
    l: Vec<f64>,
    /// `(sign + J H⁻¹ Jᵀ)⁻¹`, `J P Jᵀ`, and `W T W`.
    w: Vec<f64>,
    t: Vec<f64>,
    wtw: Vec<f64>,
}

impl Part {
    fn new(
        [h, p]: &[DMatrix<f64>; 2],
        rows: &[f64],
        (m, stride, n): (usize, usize, usize),
        sign: f64,
    ) -> Option<Part> {
        let times = |matrix: &DMatrix<f64>| {
            let mut out = vec![0.0; m * n];
            for i in 0..m {
                for column in 0..n {
                    let own = &matrix.as_slice()[column * n..(column + 1) * n];
                    out[i * n + column] = dot(&rows[i * stride..i * stride + n], own);
                }
            }
            out
        };
        let (k, l) = (times(h), times(p));
        let between = |of: &[f64]| {
            let mut out = vec![0.0; m * m];
            for i in 0..m {
                for j in 0..m {
                    out[i * m + j] = dot(&rows[i * stride..i * stride + n], &of[j * n..(j + 1) * n]);
                }
            }
            out
        };
        let (s, t) = (between(&k), between(&l));
        let mut w = [0.0; MOST_NUMBERS * MOST_NUMBERS];
        weight(&s, m, sign, &mut w)?;
        let w = w[..m * m].to_vec();
        let wtw = product(&w, &product(&t, &w, m), m);
        Some(Part { n, k, l, w, t, wtw })
    }

    fn apply(&self, [h, p]: &mut [DMatrix<f64>; 2], m: usize) {
        let n = self.n;
        // W K, W L and W T W K.
        let times = |w: &[f64], of: &[f64]| {
            let mut out = vec![0.0; m * n];
            for i in 0..m {
                for j in 0..m {
                    add(&mut out[i * n..(i + 1) * n], w[i * m + j], &of[j * n..(j + 1) * n]);
                }
            }
            out
        };
        let (wk, wl, wtwk) = (times(&self.w, &self.k), times(&self.w, &self.l), times(&self.wtw, &self.k));
        for column in 0..n {
            let (h, p) = (&mut h.as_mut_slice()[column * n..][..n], &mut p.as_mut_slice()[column * n..][..n]);
            for i in 0..m {
                let (k, l) = (&self.k[i * n..(i + 1) * n], &self.l[i * n..(i + 1) * n]);
                add(h, -wk[i * n + column], k);
                add(p, wtwk[i * n + column] - wl[i * n + column], k);
                add(p, -wk[i * n + column], l);
            }
        }
    }
}

/// A configuration more or less.
#[derive(Clone, Debug)]
pub(super) struct Change {
    own: Part,
    all: Option<Part>,
    /// `W R` and `W (Z + T W R)`.
    pulled: Vec<f64>,
    turned: Vec<f64>,
}

/// What the criterion needs of each candidate, kept up to date.
#[derive(Clone, Debug)]
pub(super) struct Caches {
    m: usize,
    c: usize,
    /// For each candidate: `S`, `T` of geometry, of all, `R Rᵀ`, `Z Rᵀ`.
    small: Vec<f64>,
    /// For each candidate: `R` and `Z`.
    long: Vec<f64>,
}

/// Candidates that one thread takes at a time.
const CHUNK: usize = 256;

impl Caches {
    fn small_len(&self) -> usize {
        6 * self.m * self.m
    }

    fn long_len(&self) -> usize {
        2 * self.m * self.c
    }

    pub(super) fn new(state: &State, aim: &Aim, blocks: &Blocks) -> Self {
        let (m, c) = (blocks.numbers, aim.modes());
        let mut made = Caches { m, c, small: Vec::new(), long: Vec::new() };
        let count = blocks.count();
        made.small = vec![0.0; count * made.small_len()];
        made.long = vec![0.0; count * made.long_len()];
        made.each(|index, small, long| {
            let rows = blocks.of(index);
            by_best(
                #[inline(always)]
                || begin(state, aim, (rows, m), (small, long)),
            );
        });
        made
    }

    /// Calls with the parts of each candidate.
    fn each(&mut self, one: impl Fn(usize, &mut [f64], &mut [f64]) + Sync + Send) {
        let (small_len, long_len) = (self.small_len(), self.long_len());
        let count = self.small.len() / small_len.max(1);
        if long_len == 0 {
            crate::threads::fill_chunks(&mut self.small, CHUNK * small_len, |chunk, some| {
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
        crate::threads::fill_chunks(&mut parts, 1, |_, some| {
            for (first, small, long) in some {
                let both = small.chunks_exact_mut(small_len).zip(long.chunks_exact_mut(long_len));
                for (at, (small, long)) in both.enumerate() {
                    one(*first + at, small, long);
                }
            }
        });
    }

    /// Brings all up to date after a change.
    pub(super) fn apply(&mut self, aim: &Aim, blocks: &Blocks, change: &Change) {
        match self.m {
            ..=3 => self.apply_of::<9>(aim, blocks, change),
            4..=6 => self.apply_of::<36>(aim, blocks, change),
            _ => self.apply_of::<{ MOST_NUMBERS * MOST_NUMBERS }>(aim, blocks, change),
        }
    }

    fn apply_of<const S: usize>(&mut self, aim: &Aim, blocks: &Blocks, change: &Change) {
        let (m, c, root) = (self.m, self.c, aim.share.sqrt());
        self.each(|index, small, long| {
            let rows = blocks.of(index);
            by_best(
                #[inline(always)]
                || follow::<S>((rows, blocks.columns), (small, long), (m, c, root), change),
            );
        });
    }

    /// By how much the criterion falls with a candidate more; below zero if its rows cannot be used.
    pub(super) fn gain(&self, index: usize, weights: &Weights) -> f64 {
        match self.m {
            ..=3 => self.gain_of::<9>(index, weights),
            4..=6 => self.gain_of::<36>(index, weights),
            _ => self.gain_of::<{ MOST_NUMBERS * MOST_NUMBERS }>(index, weights),
        }
    }

    fn gain_of<const S: usize>(&self, index: usize, weights: &Weights) -> f64 {
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
    pub(super) fn count(&self) -> usize {
        self.small.len() / self.small_len().max(1)
    }
}

/// What a candidate is to begin with.
#[inline(always)]
fn begin(state: &State, aim: &Aim, (rows, m): (&[f64], usize), (small, long): (&mut [f64], &mut [f64])) {
    let (g, c) = (aim.geometry, aim.modes());
    let scaled = scaled(rows, aim);
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

/// What a candidate is after a change.
#[inline(always)]
fn follow<const S: usize>(
    (rows, n): (&[f64], usize),
    (small, long): (&mut [f64], &mut [f64]),
    (m, c, root): (usize, usize, f64),
    change: &Change,
) {
    let Change { own, all, pulled, turned } = change;
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
                    for ((r, z), (pulled, turned)) in
                        r.iter_mut().zip(z.iter_mut()).zip(pulled.iter().zip(turned))
                    {
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
