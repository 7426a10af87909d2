//! Linear equations of a few unknowns, without allocation.

// Rows and columns are by their numbers, as in the equations.
#![allow(clippy::needless_range_loop)]

use nalgebra::Vector3;

/// Solves `A x = b` in place by elimination with row pivots: `b` becomes `x`. `None` if a pivot is below `least` times the largest number
/// of the matrix.
#[inline]
pub(crate) fn solve<const N: usize>(a: &mut [[f64; N]; N], b: &mut [f64; N], least: f64) -> Option<()> {
    let largest = a.iter().flatten().fold(0.0_f64, |most, it| most.max(it.abs()));
    let mut inverses = [0.0; N];
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
        inverses[k] = inverse;
        let (pivot, right) = (a[k], b[k]);
        for i in k + 1..N {
            let factor = a[i][k] * inverse;
            for j in k + 1..N {
                a[i][j] -= factor * pivot[j];
            }
            b[i] -= factor * right;
        }
    }
    for k in (0..N).rev() {
        let mut sum = b[k];
        for j in k + 1..N {
            sum -= a[k][j] * b[j];
        }
        b[k] = sum * inverses[k];
    }
    Some(())
}

/// Least determinant of three directions by which the others are eliminated.
const LEAST: f64 = 0.05;

/// Joint velocities of six joints, whose columns are `(v, w)`, for a velocity of the tip: the last three joints take the rotation, the first
/// three the rest. `None` if these directions are almost in a plane.
#[inline(always)]
pub(crate) fn solve_halves(
    columns: &[(Vector3<f64>, Vector3<f64>); 6],
    (p, r): (Vector3<f64>, Vector3<f64>),
    least: f64,
) -> Option<[f64; 6]> {
    let [one, two, three, (v4, w4), (v5, w5), (v6, w6)] = columns;
    let across = w5.cross(w6);
    let det = w4.dot(&across);
    if det.abs() <= LEAST || !det.is_finite() {
        return None;
    }
    let inverse = 1.0 / det;
    let (r4, r5, r6) = (across * inverse, w6.cross(w4) * inverse, w4.cross(w5) * inverse);
    let shares = |w: &Vector3<f64>| (r4.dot(w), r5.dot(w), r6.dot(w));
    let rest = |v: &Vector3<f64>, (a, b, c): (f64, f64, f64)| v - v4 * a - v5 * b - v6 * c;
    let (s1, s2, s3, s) = (shares(&one.1), shares(&two.1), shares(&three.1), shares(&r));
    let (u1, u2, u3, u) = (rest(&one.0, s1), rest(&two.0, s2), rest(&three.0, s3), rest(&p, s));
    let across = u2.cross(&u3);
    let det = u1.dot(&across);
    if det.abs() <= least || !det.is_finite() {
        return None;
    }
    let inverse = 1.0 / det;
    let x1 = across.dot(&u) * inverse;
    let x2 = u3.cross(&u1).dot(&u) * inverse;
    let x3 = u1.cross(&u2).dot(&u) * inverse;
    let last = |of: fn(&(f64, f64, f64)) -> f64| of(&s) - of(&s1) * x1 - of(&s2) * x2 - of(&s3) * x3;
    Some([x1, x2, x3, last(|it| it.0), last(|it| it.1), last(|it| it.2)])
}

/// Solves `A x = b` for the first `n` unknowns of a symmetric positive definite matrix in place, by Cholesky's factor.
pub(crate) fn solve_symmetric<const N: usize>(a: &mut [[f64; N]; N], b: &mut [f64; N], n: usize) -> Option<()> {
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

/// Null vector of a singular matrix: elimination with full pivots, and one step of inverse iteration by its triangle.
pub(crate) fn null_vector(a: &mut [[f64; 6]; 6]) -> [f64; 6] {
    let mut order = [0, 1, 2, 3, 4, 5];
    for k in 0..5 {
        let (mut row, mut column, mut most) = (k, k, 0.0);
        for (i, it) in a.iter().enumerate().skip(k) {
            for (j, number) in it.iter().enumerate().skip(k) {
                if number.abs() > most {
                    (row, column, most) = (i, j, number.abs());
                }
            }
        }
        if most == 0.0 {
            break;
        }
        a.swap(k, row);
        order.swap(k, column);
        for it in a.iter_mut() {
            it.swap(k, column);
        }
        let pivot = a[k];
        let inverse = 1.0 / pivot[k];
        for below in a.iter_mut().skip(k + 1) {
            let factor = below[k] * inverse;
            for j in k..6 {
                below[j] -= factor * pivot[j];
            }
        }
    }
    let mut sorted = [0.0; 6];
    sorted[5] = 1.0;
    for k in (0..5).rev() {
        let sum: f64 = (k + 1..6).map(|j| a[k][j] * sorted[j]).sum();
        sorted[k] = if a[k][k] == 0.0 { 0.0 } else { -sum / a[k][k] };
    }
    let mut out = [0.0; 6];
    for (place, value) in order.into_iter().zip(sorted) {
        out[place] = value;
    }
    out
}
