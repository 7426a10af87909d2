//! Subspaces of the unknowns, represented by orthonormal columns.

use nalgebra::DMatrix;

use poecal_numerics::linalg;

/// Singular value of (36a) above which a direction counts.
const VISIBLE: f64 = 0.1;

/// The part of `space` that would stay undetermined if the quantities along some directions were known, and the number of dimensions
/// removed: theory.md §7 (36a). The directions are unit vectors, not necessarily orthogonal.
pub(crate) fn remove_directions(space: &DMatrix<f64>, directions: &[Vec<f64>]) -> (DMatrix<f64>, usize) {
    without_beyond(space, directions, VISIBLE)
}

/// The same with another singular value above which a direction counts.
pub(crate) fn without_beyond(space: &DMatrix<f64>, directions: &[Vec<f64>], visible: f64) -> (DMatrix<f64>, usize) {
    let k = space.ncols();
    let basis = orthonormal(directions, space.nrows());
    let seen: Vec<Vec<f64>> = basis
        .iter()
        .map(|direction| {
            space.column_iter().map(|column| column.iter().zip(direction).map(|(a, b)| a * b).sum()).collect()
        })
        .collect();
    let mut gram = vec![0.0; k * k];
    for row in &seen {
        linalg::add_gram(&mut gram, k, row, 0);
    }
    let (values, vectors) = linalg::symmetric_eigen(&gram, k);
    let kept = values.iter().take_while(|&&value| value <= visible * visible).count();
    (space * vectors.columns(0, kept), k - kept)
}

/// Orthonormal basis of the span of some vectors (Gram-Schmidt, repeated once against rounding).
fn orthonormal(vectors: &[Vec<f64>], n: usize) -> Vec<Vec<f64>> {
    const DEPENDENT: f64 = 1e-6;
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for vector in vectors.iter().filter(|vector| vector.len() == n) {
        let mut rest = vector.clone();
        for _ in 0..2 {
            for known in &basis {
                let along: f64 = rest.iter().zip(known).map(|(a, b)| a * b).sum();
                rest.iter_mut().zip(known).for_each(|(a, b)| *a -= along * b);
            }
        }
        let norm = rest.iter().map(|a| a * a).sum::<f64>().sqrt();
        if norm > DEPENDENT {
            rest.iter_mut().for_each(|a| *a /= norm);
            basis.push(rest);
        }
    }
    basis
}

/// Basis of the same space with as many zeros as elimination produces: unit directions of few unknowns each.
pub(crate) fn sparse_basis(space: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let mut rows: Vec<Vec<f64>> = space.column_iter().map(|column| column.iter().copied().collect()).collect();
    let count = rows.len();
    for k in 0..count {
        let pivot = (k..count)
            .flat_map(|r| (0..space.nrows()).map(move |c| (r, c)))
            .max_by(|&(r, c), &(s, d)| rows[r][c].abs().total_cmp(&rows[s][d].abs()));
        let Some((row, column)) = pivot else { break };
        rows.swap(k, row);
        let value = rows[k][column];
        rows[k].iter_mut().for_each(|x| *x /= value);
        let pivot_row = rows[k].clone();
        for (r, other) in rows.iter_mut().enumerate() {
            if r != k {
                let factor = other[column];
                other.iter_mut().zip(&pivot_row).for_each(|(x, p)| *x -= factor * p);
            }
        }
    }
    for row in &mut rows {
        let norm = row.iter().map(|x| x * x).sum::<f64>().sqrt();
        row.iter_mut().for_each(|x| *x /= norm);
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_directions_leave_the_others_undetermined() {
        // Undetermined: e0 + e1 together, and e2.
        let half = 0.5f64.sqrt();
        let space = DMatrix::from_column_slice(4, 2, &[half, half, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        let unit = |k: usize| (0..4).map(|i| f64::from(u8::from(i == k))).collect::<Vec<f64>>();
        let (left, gone) = remove_directions(&space, &[unit(0), unit(1)]);
        assert_eq!((left.ncols(), gone), (1, 1));
        assert!((left[(2, 0)].abs() - 1.0).abs() < 1e-12);
        assert_eq!(remove_directions(&space, &[unit(3)]).1, 0);
        assert_eq!(remove_directions(&space, &[unit(0), unit(2), unit(2)]).1, 2);
        assert_eq!(sparse_basis(&space).len(), 2);
    }
}
