//! Dense linear algebra of the normal equations: accumulation, Cholesky, symmetric eigenvalues. It is the only file that names
//! nalgebra's decompositions: only `symmetric_eigen`, singular values and the Cholesky factor of six rows, since its SVD with
//! vectors errs on repeated columns.

pub use crate::kernels::Factor;
use crate::kernels::{self as lanes, SimdLevel};
use nalgebra::{Cholesky, DMatrix, DVector, Matrix4, Matrix6, U6, Vector3, Vector4};

/// Adds `Σ rᵀ r` over rows r to the upper triangle of a row-major `n × n` Gram matrix (theory.md §6 (28)). `rows` holds rows of `n`
/// numbers, of which those before `start` are zero and are skipped.
pub fn add_gram(gram: &mut [f64], n: usize, rows: &[f64], start: usize) {
    if n == 0 {
        return;
    }
    let mut quads = rows.chunks_exact(4 * n);
    for quad in &mut quads {
        let (a, rest) = quad.split_at(n);
        let (b, rest) = rest.split_at(n);
        let (c, d) = rest.split_at(n);
        for i in start..n {
            let (ai, bi, ci, di) = (a[i], b[i], c[i], d[i]);
            let out = &mut gram[i * n + i..(i + 1) * n];
            let (a, b, c, d) = (&a[i..], &b[i..], &c[i..], &d[i..]);
            for ((((g, a), b), c), d) in out.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                *g += ai * a + bi * b + (ci * c + di * d);
            }
        }
    }
    for row in quads.remainder().chunks_exact(n) {
        for i in start..n {
            let ri = row[i];
            for (g, r) in gram[i * n + i..(i + 1) * n].iter_mut().zip(&row[i..]) {
                *g += ri * r;
            }
        }
    }
}

/// Adds `Σ rᵀ e` over rows r to a gradient, one residual `e` a row (theory.md §6 (28)).
pub fn add_gradient(gradient: &mut [f64], rows: &[f64], residuals: &[f64]) {
    let n = gradient.len();
    if n == 0 {
        return;
    }
    for (row, e) in rows.chunks_exact(n).zip(residuals) {
        for (g, r) in gradient.iter_mut().zip(row) {
            *g += r * e;
        }
    }
}

/// Cholesky factor of the symmetric matrix with this upper triangle plus `damping` on the diagonal; `None` if that is not positive
/// definite.
pub fn cholesky(upper: &[f64], n: usize, damping: f64) -> Option<Factor> {
    lanes::cholesky(SimdLevel::best_level(), upper, n, damping)
}

/// Cholesky factor of the information of a rigid motion.
pub type Factor6 = Cholesky<f64, U6>;

/// Cholesky factor of six rows; `None` if the matrix is not positive definite.
pub fn cholesky_6(matrix: Matrix6<f64>) -> Option<Factor6> {
    Cholesky::new(matrix)
}

/// Inverse of six rows; `None` if there is none.
pub fn inverse_6(matrix: Matrix6<f64>) -> Option<Matrix6<f64>> {
    matrix.try_inverse()
}

/// Solves `L Lᵀ x = b`.
pub fn cholesky_solve(factor: &Factor, b: &[f64]) -> Vec<f64> {
    let mut x = b.to_vec();
    lanes::solve(SimdLevel::best_level(), factor, &mut x);
    x
}

/// `tr(H⁻¹ P)` from the factor of H and the upper triangle of P, row-major `n × n`.
pub fn trace_of_quotient(factor: &Factor, part: &[f64], n: usize) -> f64 {
    (0..n)
        .map(|j| {
            let column: Vec<f64> = (0..n).map(|i| part[i.min(j) * n + i.max(j)]).collect();
            cholesky_solve(factor, &column)[j]
        })
        .sum()
}

/// The inverse (row-major) of the matrix that was factorised.
pub fn inverse(factor: &Factor) -> Vec<f64> {
    lanes::inverse(SimdLevel::best_level(), factor)
}

/// `A⁻¹ b` of a symmetric matrix; `None` unless it is positive definite.
pub fn solve_symmetric(matrix: DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    Some(Cholesky::new(matrix)?.solve(right))
}

/// `A⁻¹ b`, and `R L⁻ᵀ` of rows, with `A = L Lᵀ`: rows in units in which `A` is 1.
pub fn solved_and_whitened(
    matrix: DMatrix<f64>,
    right: &DVector<f64>,
    rows: &DMatrix<f64>,
) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let n = matrix.nrows();
    let factor = Cholesky::new(matrix)?;
    // One product of matrices is faster than substitution row after row.
    let unit = factor.l_dirty().solve_lower_triangular(&DMatrix::identity(n, n))?;
    Some((factor.solve(right), rows * unit.transpose()))
}

/// `L⁻¹ C` of columns, with a covariance `L Lᵀ`: rows in units in which the covariance is 1. `None` unless it is positive definite.
pub fn whiten_columns(covariance: DMatrix<f64>, columns: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    Cholesky::new(covariance)?.l_dirty().solve_lower_triangular(columns)
}

/// `aᵀb`.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Coefficients of the combination of columns that is nearest to `-target` (all zero beyond their length), by damped normal equations.
pub fn combination(columns: &[Vec<f64>], target: &[f64]) -> Option<Vec<f64>> {
    let count = columns.len();
    let upper: Vec<f64> = (0..count * count).map(|k| dot(&columns[k / count], &columns[k % count])).collect();
    let gradient: Vec<f64> = columns.iter().map(|column| -dot(column, target)).collect();
    Some(cholesky_solve(&cholesky(&upper, count, 1e-9)?, &gradient))
}

/// Eigenvalues (ascending) and eigenvectors (columns) of the symmetric matrix with this upper triangle.
pub fn symmetric_eigen(upper: &[f64], n: usize) -> (Vec<f64>, DMatrix<f64>) {
    if n == 0 {
        return (Vec::new(), DMatrix::zeros(0, 0));
    }
    let matrix = DMatrix::from_fn(n, n, |i, j| upper[i.min(j) * n + i.max(j)]);
    let eigen = matrix.symmetric_eigen();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let values = order.iter().map(|&k| eigen.eigenvalues[k]).collect();
    let mut vectors = DMatrix::zeros(n, n);
    for (column, &k) in order.iter().enumerate() {
        vectors.set_column(column, &eigen.eigenvectors.column(k));
    }
    (values, vectors)
}

/// The unit eigenvector of the largest eigenvalue of a symmetric 4×4 matrix.
pub fn dominant_eigenvector(matrix: &Matrix4<f64>) -> Vector4<f64> {
    let eigen = matrix.symmetric_eigen();
    eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned()
}

/// Directions of greatest, middle and least spread of points about their mean, with the three standard deviations.
pub fn principal_spread(points: &[Vector3<f64>]) -> [f64; 3] {
    let count = points.len().max(1) as f64;
    let mean = points.iter().sum::<Vector3<f64>>() / count;
    let covariance: nalgebra::Matrix3<f64> =
        points.iter().map(|p| (p - mean) * (p - mean).transpose()).sum::<nalgebra::Matrix3<f64>>() / count;
    let mut spread = covariance.symmetric_eigenvalues().map(|value| value.max(0.0).sqrt());
    spread.as_mut_slice().sort_by(|a, b| b.total_cmp(a));
    spread.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gram_and_cholesky_solve_the_normal_equations() {
        let n = 5;
        let rows: Vec<f64> = (0..n * 11).map(|k| ((k * k * 7 + 3 * k) % 17) as f64 - 8.0).collect();
        let mut gram = vec![0.0; n * n];
        add_gram(&mut gram, n, &rows, 0);
        let truth = [1.0, -2.0, 0.5, 3.0, 0.25];
        let residuals: Vec<f64> = rows.chunks(n).map(|row| row.iter().zip(&truth).map(|(a, b)| a * b).sum()).collect();
        let mut gradient = vec![0.0; n];
        add_gradient(&mut gradient, &rows, &residuals);
        let factor = cholesky(&gram, n, 0.0).unwrap();
        let solution = cholesky_solve(&factor, &gradient);
        assert!(solution.iter().zip(&truth).all(|(a, b)| (a - b).abs() < 1e-12), "{solution:?}");
    }

    /// At every level and for every filling of the lanes the inverse has the columns of the solutions.
    #[test]
    fn the_inverse_is_that_of_solutions() {
        for level in lanes::simd_levels() {
            for n in 0..20 {
                let rows: Vec<f64> = (0..n * (n + 3)).map(|k| ((k * k * 7 + 3 * k) % 17) as f64 - 8.0).collect();
                let mut gram = vec![0.0; n * n];
                add_gram(&mut gram, n, &rows, 0);
                let factor = lanes::cholesky(level, &gram, n, 1.0).unwrap();
                let inverse = lanes::inverse(level, &factor);
                assert_eq!(inverse.len(), n * n);
                for (k, row) in inverse.chunks(n.max(1)).enumerate() {
                    let mut unit = vec![0.0; n];
                    unit[k] = 1.0;
                    let column = cholesky_solve(&factor, &unit);
                    let are_same = row.iter().zip(&column).all(|(a, b)| (a - b).abs() < 1e-13);
                    assert!(are_same, "{level:?} {n} {k}: {row:?}, {column:?}");
                }
            }
        }
    }

    /// Reason for `symmetric_eigen`: an SVD with vectors that is wrong on repeated columns would name wrong directions.
    #[test]
    fn eigenvectors_are_right_for_repeated_and_negated_columns() {
        let mut worst: f64 = 0.0;
        for seed in 0..2000_u64 {
            let n = 2 + (seed % 9) as usize;
            let m = n + 3;
            let mut state = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let mut next = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 40) as f64 / f64::from(1 << 23) - 1.0
            };
            let mut rows: Vec<f64> = (0..m * n).map(|_| next()).collect();
            for row in rows.chunks_mut(n) {
                row[n - 1] = if seed % 2 == 0 { row[0] } else { -row[0] };
            }
            let mut gram = vec![0.0; n * n];
            add_gram(&mut gram, n, &rows, 0);
            let (values, vectors) = symmetric_eigen(&gram, n);
            let rebuilt = &vectors * DMatrix::from_diagonal(&nalgebra::DVector::from_vec(values)) * vectors.transpose();
            let exact = DMatrix::from_fn(n, n, |i, j| gram[i.min(j) * n + i.max(j)]);
            let error = (rebuilt - &exact).norm() / exact.norm();
            assert!(error < 1e-13, "{seed}: {error:e}");
            worst = worst.max(error);
        }
        println!("worst relative error of V D Vᵀ: {worst:.1e}");
    }
}
