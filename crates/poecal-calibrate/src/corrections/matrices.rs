//! Products and factors of dense matrices.

use nalgebra::DMatrix;

use poecal_numerics::linalg::{self, Factor};
use poecal_numerics::solve::NormalEquations;

/// Rounding of a matrix, as a share of its largest diagonal element.
const ROUNDING: f64 = 1e-16;
/// Rounding if columns of terms and screws may coincide.
pub(crate) const ROUNDING_OF_TERMS: f64 = 1e-13;
/// Information added to each unknown of geometry if the rows do not determine them all, as a share of the largest.
const RIDGE: f64 = 1e-10;

/// Normal information of some of the unknowns.
pub(crate) fn of_some(normal: &NormalEquations, places: &[usize]) -> NormalEquations {
    let (n, k) = (normal.dim(), places.len());
    let mut found = NormalEquations::new(k);
    for (i, &a) in places.iter().enumerate() {
        found.gradient[i] = normal.gradient[a];
        for (j, &b) in places.iter().enumerate() {
            found.gram[i * k + j] = normal.gram[a.min(b) * n + a.max(b)];
        }
    }
    found
}

/// `AᵀA`.
pub(crate) fn square(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    matrix.transpose() * matrix
}

/// Factor of a symmetric matrix; rounding is a share of its largest diagonal element.
pub(crate) fn cholesky(matrix: &DMatrix<f64>, rounding: f64) -> Option<Factor> {
    let largest = matrix.diagonal().iter().copied().fold(0.0, f64::max);
    linalg::cholesky(matrix.as_slice(), matrix.nrows(), rounding * largest)
}

/// Factor of the information of geometry, which may leave unknowns undetermined.
pub(crate) fn of_geometry(mut matrix: DMatrix<f64>) -> Option<Factor> {
    cholesky(&matrix, ROUNDING).or_else(|| {
        let largest = matrix.diagonal().iter().copied().fold(0.0, f64::max);
        (0..matrix.nrows()).for_each(|at| matrix[(at, at)] += RIDGE * largest);
        cholesky(&matrix, ROUNDING)
    })
}

/// `A⁻¹ B` from the factor of A, by one product.
pub(crate) fn solve_factored(factor: &Factor, right: &DMatrix<f64>) -> DMatrix<f64> {
    let n = right.nrows();
    DMatrix::from_column_slice(n, n, &linalg::inverse(factor)) * right
}
