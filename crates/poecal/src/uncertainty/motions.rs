//! How targets move with the unknowns, several configurations in one matrix.

use nalgebra::{DMatrix, Vector3};

use crate::estimate::{Chain, Linkage, Packed};
use crate::problem::Layout;

/// Motions of targets in some `(row of joint values, target)` with each scaled unknown, which has a column: `ROWS` rows a target, 3 of its
/// place or 6 of its place and its turn.
pub(super) fn motions<const ROWS: usize>(
    layout: &Layout,
    linkage: &Linkage,
    packed: &Packed,
    rows: &[(usize, usize)],
) -> DMatrix<f64> {
    let mut chain = Chain::default();
    let mut twists = vec![(Vector3::zeros(), Vector3::zeros()); layout.dim()];
    let height = ROWS * rows.len();
    let mut motions = DMatrix::zeros(height, layout.dim());
    for (at, &(row, target)) in rows.iter().enumerate() {
        chain.evaluate(linkage, packed, row, target);
        layout.target_twists(&chain, target, &mut twists);
        for (column, (v, w)) in motions.as_mut_slice().chunks_exact_mut(height).zip(&twists) {
            let (place, turn) = column[ROWS * at..ROWS * (at + 1)].split_at_mut(3);
            place.copy_from_slice(v.as_slice());
            turn.copy_from_slice(&w.as_slice()[..ROWS - 3]);
        }
    }
    motions
}
