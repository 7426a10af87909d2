//! The problems of Moré, Garbow and Hillstrom with any number of unknowns, numbered as in the paper: residuals and Jacobians.

#![allow(clippy::needless_range_loop, reason = "indices as in the paper's formulas")]

use crate::plain::Evaluation;

/// Residuals and the dense Jacobian of `m` rows, filled in by `fill`.
fn fill_dense(m: usize, n: usize, fill: impl FnOnce(&mut [f64], &mut [Vec<f64>])) -> Evaluation {
    let (mut f, mut rows) = (vec![0.0; m], vec![vec![0.0; n]; m]);
    fill(&mut f, &mut rows);
    (f, rows.concat())
}

/// Numbers from 1, as the paper counts.
fn number(index: usize) -> f64 {
    (index + 1) as f64
}

/// 20
pub(crate) fn watson(x: &[f64]) -> Evaluation {
    let n = x.len();
    fill_dense(31, n, |f, rows| {
        for i in 0..29 {
            let t = number(i) / 29.0;
            let sum: f64 = (0..n).map(|j| x[j] * t.powi(j as i32)).sum();
            let slope: f64 = (1..n).map(|j| j as f64 * x[j] * t.powi(j as i32 - 1)).sum();
            f[i] = slope - sum * sum - 1.0;
            for j in 0..n {
                let own = if j == 0 { 0.0 } else { j as f64 * t.powi(j as i32 - 1) };
                rows[i][j] = own - 2.0 * sum * t.powi(j as i32);
            }
        }
        f[29] = x[0];
        rows[29][0] = 1.0;
        f[30] = x[1] - x[0] * x[0] - 1.0;
        (rows[30][0], rows[30][1]) = (-2.0 * x[0], 1.0);
    })
}

/// 21
pub(crate) fn extended_rosenbrock(x: &[f64]) -> Evaluation {
    let n = x.len();
    fill_dense(n, n, |f, rows| {
        for k in (0..n).step_by(2) {
            f[k] = 10.0 * (x[k + 1] - x[k] * x[k]);
            (rows[k][k], rows[k][k + 1]) = (-20.0 * x[k], 10.0);
            f[k + 1] = 1.0 - x[k];
            rows[k + 1][k] = -1.0;
        }
    })
}

/// 22
pub(crate) fn extended_powell(x: &[f64]) -> Evaluation {
    let n = x.len();
    fill_dense(n, n, |f, rows| {
        for k in (0..n).step_by(4) {
            let (part, jacobian) = crate::more_problems::powell_singular(&x[k..k + 4]);
            f[k..k + 4].copy_from_slice(&part);
            for (row, part) in rows[k..k + 4].iter_mut().zip(jacobian.chunks(4)) {
                row[k..k + 4].copy_from_slice(part);
            }
        }
    })
}

/// 23
pub(crate) fn penalty_1(x: &[f64]) -> Evaluation {
    let (n, root) = (x.len(), 1e-5_f64.sqrt());
    fill_dense(n + 1, n, |f, rows| {
        for k in 0..n {
            f[k] = root * (x[k] - 1.0);
            rows[k][k] = root;
            rows[n][k] = 2.0 * x[k];
        }
        f[n] = x.iter().map(|x| x * x).sum::<f64>() - 0.25;
    })
}

/// 24
pub(crate) fn penalty_2(x: &[f64]) -> Evaluation {
    let (n, root) = (x.len(), 1e-5_f64.sqrt());
    let e = |value: f64| (value / 10.0).exp();
    fill_dense(2 * n, n, |f, rows| {
        f[0] = x[0] - 0.2;
        rows[0][0] = 1.0;
        for k in 1..n {
            let y = e(number(k)) + e(number(k - 1));
            f[k] = root * (e(x[k]) + e(x[k - 1]) - y);
            (rows[k][k], rows[k][k - 1]) = (root * e(x[k]) / 10.0, root * e(x[k - 1]) / 10.0);
            f[n + k - 1] = root * (e(x[k]) - e(-1.0));
            rows[n + k - 1][k] = root * e(x[k]) / 10.0;
        }
        f[2 * n - 1] = -1.0;
        for k in 0..n {
            f[2 * n - 1] += (n - k) as f64 * x[k] * x[k];
            rows[2 * n - 1][k] = 2.0 * (n - k) as f64 * x[k];
        }
    })
}

/// 25
pub(crate) fn variably_dimensioned(x: &[f64]) -> Evaluation {
    let n = x.len();
    fill_dense(n + 2, n, |f, rows| {
        let sum: f64 = (0..n).map(|k| number(k) * (x[k] - 1.0)).sum();
        for k in 0..n {
            f[k] = x[k] - 1.0;
            rows[k][k] = 1.0;
            (rows[n][k], rows[n + 1][k]) = (number(k), 2.0 * sum * number(k));
        }
        (f[n], f[n + 1]) = (sum, sum * sum);
    })
}

/// 26
pub(crate) fn trigonometric(x: &[f64]) -> Evaluation {
    let n = x.len();
    fill_dense(n, n, |f, rows| {
        let sum: f64 = x.iter().map(|x| x.cos()).sum();
        for i in 0..n {
            f[i] = n as f64 - sum + number(i) * (1.0 - x[i].cos()) - x[i].sin();
            for (slot, x) in rows[i].iter_mut().zip(x) {
                *slot = x.sin();
            }
            rows[i][i] += number(i) * x[i].sin() - x[i].cos();
        }
    })
}

/// 27
pub(crate) fn brown_almost_linear(x: &[f64]) -> Evaluation {
    let n = x.len();
    fill_dense(n, n, |f, rows| {
        let sum: f64 = x.iter().sum();
        for i in 0..n - 1 {
            f[i] = x[i] + sum - number(n);
            rows[i].fill(1.0);
            rows[i][i] = 2.0;
        }
        f[n - 1] = x.iter().product::<f64>() - 1.0;
        for j in 0..n {
            rows[n - 1][j] = (0..n).filter(|&k| k != j).map(|k| x[k]).product();
        }
    })
}

/// 28
pub(crate) fn discrete_boundary_value(x: &[f64]) -> Evaluation {
    let n = x.len();
    let h = 1.0 / number(n);
    fill_dense(n, n, |f, rows| {
        for i in 0..n {
            let base = x[i] + number(i) * h + 1.0;
            f[i] = 2.0 * x[i] + h * h * base.powi(3) / 2.0;
            rows[i][i] = 2.0 + 1.5 * h * h * base * base;
            if i > 0 {
                f[i] -= x[i - 1];
                rows[i][i - 1] = -1.0;
            }
            if i + 1 < n {
                f[i] -= x[i + 1];
                rows[i][i + 1] = -1.0;
            }
        }
    })
}

/// 29
pub(crate) fn discrete_integral_equation(x: &[f64]) -> Evaluation {
    let n = x.len();
    let h = 1.0 / number(n);
    let t = |j: usize| number(j) * h;
    fill_dense(n, n, |f, rows| {
        for i in 0..n {
            f[i] = x[i];
            rows[i][i] = 1.0;
            for j in 0..n {
                let base = x[j] + t(j) + 1.0;
                let weight = if j <= i { (1.0 - t(i)) * t(j) } else { t(i) * (1.0 - t(j)) };
                f[i] += h * weight * base.powi(3) / 2.0;
                rows[i][j] += 1.5 * h * weight * base * base;
            }
        }
    })
}

/// 30
pub(crate) fn broyden_tridiagonal(x: &[f64]) -> Evaluation {
    let n = x.len();
    fill_dense(n, n, |f, rows| {
        for i in 0..n {
            f[i] = (3.0 - 2.0 * x[i]) * x[i] + 1.0;
            rows[i][i] = 3.0 - 4.0 * x[i];
            if i > 0 {
                f[i] -= x[i - 1];
                rows[i][i - 1] = -1.0;
            }
            if i + 1 < n {
                f[i] -= 2.0 * x[i + 1];
                rows[i][i + 1] = -2.0;
            }
        }
    })
}

/// 31
pub(crate) fn broyden_banded(x: &[f64]) -> Evaluation {
    let n = x.len();
    fill_dense(n, n, |f, rows| {
        for i in 0..n {
            f[i] = x[i] * (2.0 + 5.0 * x[i] * x[i]) + 1.0;
            rows[i][i] = 2.0 + 15.0 * x[i] * x[i];
            for j in (i.saturating_sub(5)..n.min(i + 2)).filter(|&j| j != i) {
                f[i] -= x[j] * (1.0 + x[j]);
                rows[i][j] = -1.0 - 2.0 * x[j];
            }
        }
    })
}

/// Number of residuals of the linear problems, as in the paper's tables.
pub(crate) const LINEAR_ROWS: usize = 10;

/// 32
pub(crate) fn linear_full_rank(x: &[f64]) -> Evaluation {
    let n = x.len();
    fill_dense(LINEAR_ROWS, n, |f, rows| {
        let (share, sum) = (2.0 / LINEAR_ROWS as f64, x.iter().sum::<f64>());
        for i in 0..LINEAR_ROWS {
            f[i] = -share * sum - 1.0;
            rows[i].fill(-share);
            if i < n {
                f[i] += x[i];
                rows[i][i] += 1.0;
            }
        }
    })
}

/// 33
pub(crate) fn linear_rank_1(x: &[f64]) -> Evaluation {
    let n = x.len();
    fill_dense(LINEAR_ROWS, n, |f, rows| {
        let sum: f64 = (0..n).map(|j| number(j) * x[j]).sum();
        for i in 0..LINEAR_ROWS {
            f[i] = number(i) * sum - 1.0;
            for j in 0..n {
                rows[i][j] = number(i) * number(j);
            }
        }
    })
}

/// 34
pub(crate) fn linear_rank_1_with_zeros(x: &[f64]) -> Evaluation {
    let n = x.len();
    fill_dense(LINEAR_ROWS, n, |f, rows| {
        let sum: f64 = (1..n - 1).map(|j| number(j) * x[j]).sum();
        f.fill(-1.0);
        for i in 1..LINEAR_ROWS - 1 {
            f[i] += i as f64 * sum;
            for j in 1..n - 1 {
                rows[i][j] = i as f64 * number(j);
            }
        }
    })
}

/// 35, with as many residuals as unknowns
pub(crate) fn chebyquad(x: &[f64]) -> Evaluation {
    let n = x.len();
    fill_dense(n, n, |f, rows| {
        for (j, &x) in x.iter().enumerate() {
            let y = 2.0 * x - 1.0;
            // Shifted Chebyshev polynomials and their derivatives by x, of this degree and of the one before.
            let (mut before, mut value) = (1.0, y);
            let (mut slope_before, mut slope) = (0.0, 2.0);
            for i in 0..n {
                f[i] += value / n as f64;
                rows[i][j] = slope / n as f64;
                (before, value, slope_before, slope) =
                    (value, 2.0 * y * value - before, slope, 4.0 * value + 2.0 * y * slope - slope_before);
            }
        }
        for i in (1..n).step_by(2) {
            f[i] += 1.0 / (number(i) * number(i) - 1.0);
        }
    })
}
