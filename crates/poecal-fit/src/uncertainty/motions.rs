//! Derivatives of predicted targets by the unknowns, several configurations in one matrix.

use nalgebra::{DMatrix, Matrix3, Vector3};

use crate::problem::Layout;
use crate::state::{Linkage, PackedValues, RowChain, Sight};

/// Target twists `(v; ω)` of theory.md §9 (40), in the device's axes: one column for each scaled unknown, and for each configuration three
/// rows (v), or with two `parts` six (v, then ω).
pub(crate) fn motions(
    layout: &Layout,
    linkage: &Linkage,
    packed: &PackedValues,
    rows: &[(usize, Sight)],
    parts: usize,
) -> DMatrix<f64> {
    let mut chain = RowChain::default();
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

/// `Σ a bᵀ` over the columns of two matrices, for each three rows of both.
pub(crate) fn products(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Vec<Matrix3<f64>> {
    let mut sums = vec![Matrix3::zeros(); a.nrows() / 3];
    let height = a.nrows().max(1);
    let (left, right) = (a.as_slice().chunks_exact(height), b.as_slice().chunks_exact(height));
    // Columns one after the other, in the order of memory.
    for (a, b) in left.zip(right) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.as_chunks::<3>().0.iter().zip(b.as_chunks::<3>().0)) {
            for (sum, b) in sum.data.0.iter_mut().zip(b) {
                sum.iter_mut().zip(a).for_each(|(sum, a)| *sum += a * b);
            }
        }
    }
    sums
}
