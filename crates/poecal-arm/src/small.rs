//! Linear equations of a few unknowns, without allocation.

// Rows and columns by their numbers, as equations have them.
#![allow(clippy::needless_range_loop)]

/// Solves `A x = b` in place by elimination with row pivots: `b` becomes `x`. `None` if a pivot is below `least` times the largest number
/// of the matrix.
#[inline]
pub(crate) fn solve<const N: usize>(a: &mut [[f64; N]; N], b: &mut [f64; N], least: f64) -> Option<()> {
    let largest = a.iter().flatten().fold(0.0_f64, |most, it| most.max(it.abs()));
    for k in 0..N {
        let (mut row, mut most) = (k, a[k][k].abs());
        for i in k + 1..N {
            if a[i][k].abs() > most {
                (row, most) = (i, a[i][k].abs());
            }
        }
        if most <= least * largest || !most.is_finite() {
            return None;
        }
        a.swap(k, row);
        b.swap(k, row);
        let inverse = 1.0 / a[k][k];
        let pivot = a[k];
        for i in k + 1..N {
            let factor = a[i][k] * inverse;
            for j in k + 1..N {
                a[i][j] -= factor * pivot[j];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..N).rev() {
        let mut sum = b[k];
        for j in k + 1..N {
            sum -= a[k][j] * b[j];
        }
        b[k] = sum / a[k][k];
    }
    Some(())
}

/// Solves `A x = b` for the first `n` unknowns of a symmetric positive definite matrix in place, by Cholesky's factor.
pub(crate) fn solve_symmetric<const N: usize>(
    a: &mut [[f64; N]; N],
    b: &mut [f64; N],
    n: usize,
) -> Option<()> {
    for j in 0..n {
        for k in 0..j {
            let factor = a[j][k];
            for i in j..n {
                a[i][j] -= factor * a[i][k];
            }
        }
        if a[j][j] <= 0.0 || !a[j][j].is_finite() {
            return None;
        }
        let inverse = 1.0 / nalgebra::ComplexField::sqrt(a[j][j]);
        for row in a.iter_mut().take(n).skip(j) {
            row[j] *= inverse;
        }
    }
    for j in 0..n {
        b[j] /= a[j][j];
        for i in j + 1..n {
            b[i] -= a[i][j] * b[j];
        }
    }
    for j in (0..n).rev() {
        for i in j + 1..n {
            b[j] -= a[i][j] * b[i];
        }
        b[j] /= a[j][j];
    }
    Some(())
}

/// Elimination with row pivots in place; the determinant.
pub(crate) fn determinant<const N: usize>(a: &mut [[f64; N]; N]) -> f64 {
    let mut out = 1.0;
    for k in 0..N {
        let mut row = k;
        for i in k + 1..N {
            if a[i][k].abs() > a[row][k].abs() {
                row = i;
            }
        }
        if row != k {
            a.swap(k, row);
            out = -out;
        }
        let pivot = a[k];
        out *= pivot[k];
        if pivot[k] == 0.0 {
            return 0.0;
        }
        let inverse = 1.0 / pivot[k];
        for below in a.iter_mut().skip(k + 1) {
            let factor = below[k] * inverse;
            if factor != 0.0 {
                for j in k + 1..N {
                    below[j] -= factor * pivot[j];
                }
            }
        }
    }
    out
}
