//! Change of covariances by adding or removing a configuration, as a low-rank update (docs/theory.md, *Choosing configurations*).

use nalgebra::DMatrix;

/// A sum of products in eight lanes, so that it vectorises.
#[inline(always)]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
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
pub(crate) fn add(out: &mut [f64], factor: f64, row: &[f64]) {
    out.iter_mut().zip(row).for_each(|(out, row)| *out += factor * row);
}

/// `A B` of small row-major matrices.
pub(crate) fn product(a: &[f64], b: &[f64], m: usize) -> Vec<f64> {
    let mut out = vec![0.0; m * m];
    for i in 0..m {
        for j in 0..m {
            out[i * m + j] = (0..m).map(|k| a[i * m + k] * b[k * m + j]).sum();
        }
    }
    out
}

/// Largest number of measured components of a configuration.
pub(crate) const MOST_NUMBERS: usize = 24;

/// `(sign + S)⁻¹` of a small symmetric matrix by elimination, and the logarithm of `|sign (sign + S)|`; `None` if it is not of one sign.
#[inline(always)]
pub(crate) fn weight<const S: usize>(s: &[f64], m: usize, sign: f64, out: &mut [f64; S]) -> Option<f64> {
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

/// Pivot below which the remainder without some rows is rounding.
const LEAST_PIVOT: f64 = 1e-9;

/// Rows of a changed configuration, against covariances.
#[derive(Clone, Debug)]
pub(crate) struct ChangedRows {
    /// Number of used columns.
    pub(crate) n: usize,
    /// `H⁻¹ Jᵀ` and `P Jᵀ`, a row for each number.
    pub(crate) k: Vec<f64>,
    pub(crate) l: Vec<f64>,
    /// `(sign + J H⁻¹ Jᵀ)⁻¹`, `J P Jᵀ`, and `W T W`.
    pub(crate) w: Vec<f64>,
    pub(crate) t: Vec<f64>,
    pub(crate) wtw: Vec<f64>,
}

impl ChangedRows {
    pub(crate) fn new(
        [h, p]: &[DMatrix<f64>; 2],
        rows: &[f64],
        (m, stride, n): (usize, usize, usize),
        sign: f64,
    ) -> Option<ChangedRows> {
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
        Some(ChangedRows { n, k, l, w, t, wtw })
    }

    pub(crate) fn apply(&self, [h, p]: &mut [DMatrix<f64>; 2], m: usize) {
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

/// Addition or removal of a configuration.
#[derive(Clone, Debug)]
pub(crate) struct PlanChange {
    pub(crate) own: ChangedRows,
    pub(crate) all: Option<ChangedRows>,
    /// `W R` and `W (Z + T W R)`.
    pub(crate) pulled: Vec<f64>,
    pub(crate) turned: Vec<f64>,
}
