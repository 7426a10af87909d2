//! Derivatives of predicted targets by the unknowns, several configurations in one matrix.

use nalgebra::{DMatrix, Matrix3, Vector3};

use crate::estimate::{Chain, Linkage, Packed, Sight};
use crate::problem::Layout;

/// Target twists `(v; ω)` of theory.md §9 (40), in the device's axes: one column for each scaled unknown, and for each configuration three
/// rows (v), or with two `parts` six (v, then ω).
pub(super) fn motions(
    layout: &Layout,
    linkage: &Linkage,
    packed: &Packed,
    rows: &[(usize, Sight)],
    parts: usize,
) -> DMatrix<f64> {
    let mut chain = Chain::default();
    let mut twists = vec![(Vector3::zeros(), Vector3::zeros()); layout.dim()];
    let height = 3 * parts * rows.len();
    let mut motions = DMatrix::zeros(height, layout.dim());
    for (place, &(row, sight)) in (0..height).step_by(3 * parts).zip(rows) {
        chain.evaluate(linkage, packed, row, sight);
        layout.target_twists(&chain, sight.target, &mut twists);
        for (column, (v, w)) in motions.as_mut_slice().chunks_exact_mut(height).zip(&twists) {
            column[place..place + 3].copy_from_slice(v.as_slice());
            if parts > 1 {
                column[place + 3..place + 6].copy_from_slice(w.as_slice());
            }
        }
    }
    motions
}

/// `Σ a bᵀ` over the columns of two matrices, each restricted to three rows from `first` on.
pub(super) fn products(a: &DMatrix<f64>, b: &DMatrix<f64>, first: usize) -> Matrix3<f64> {
    let cut = |matrix: &DMatrix<f64>, column: usize| {
        let start = column * matrix.nrows() + first;
        Vector3::from_column_slice(&matrix.as_slice()[start..start + 3])
    };
    let mut sum = Matrix3::zeros();
    (0..a.ncols()).for_each(|column| sum += cut(a, column) * cut(b, column).transpose());
    sum
}
