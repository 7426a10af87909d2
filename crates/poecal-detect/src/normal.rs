//! Sums of products of the rows of a least-squares fit.

use nalgebra::{SMatrix, SVector};

/// Rows that are added at once: their products are read and written once for all of them, and two of them in one instruction.
const ROWS: usize = 4;

/// The normal equations of rows that come one by one.
pub(crate) struct Normal<const N: usize> {
    /// Rows that wait, by unknowns, with their residuals.
    columns: [[f64; ROWS]; N],
    residuals: [f64; ROWS],
    waiting: usize,
    /// Below the diagonal; even and odd rows by themselves.
    products: [[[f64; 2]; N]; N],
    right: [[f64; 2]; N],
    squares: [f64; 2],
}

fn add(sum: &mut [f64; 2], a: &[f64; ROWS], b: &[f64; ROWS]) {
    sum[0] += a[0] * b[0] + a[2] * b[2];
    sum[1] += a[1] * b[1] + a[3] * b[3];
}

impl<const N: usize> Normal<N> {
    pub(crate) fn new() -> Self {
        Normal {
            columns: [[0.0; ROWS]; N],
            residuals: [0.0; ROWS],
            waiting: 0,
            products: [[[0.0; 2]; N]; N],
            right: [[0.0; 2]; N],
            squares: [0.0; 2],
        }
    }

    pub(crate) fn add(&mut self, row: [f64; N], residual: f64) {
        let at = self.waiting % ROWS;
        self.columns.iter_mut().zip(row).for_each(|(column, it)| column[at] = it);
        self.residuals[at] = residual;
        self.waiting = at + 1;
        if self.waiting == ROWS {
            self.take();
        }
    }

    fn take(&mut self) {
        for (i, own) in self.columns.iter().enumerate() {
            let sums = self.products[i].iter_mut().zip(&self.columns).take(i + 1);
            sums.for_each(|(sum, other)| add(sum, own, other));
            add(&mut self.right[i], own, &self.residuals);
        }
        add(&mut self.squares, &self.residuals, &self.residuals);
        self.waiting = 0;
    }

    /// The matrix, the right side, and the sum of the squares of the residuals.
    pub(crate) fn finished(mut self) -> (SMatrix<f64, N, N>, SVector<f64, N>, f64) {
        if self.waiting > 0 {
            // Rows of nothing fill up the last ones.
            for at in self.waiting..ROWS {
                self.columns.iter_mut().for_each(|column| column[at] = 0.0);
                self.residuals[at] = 0.0;
            }
            self.take();
        }
        let product = |i: usize, j: usize| self.products[i.max(j)][i.min(j)].iter().sum();
        let right = SVector::from(self.right.map(|it| it[0] + it[1]));
        (SMatrix::from_fn(product), right, self.squares[0] + self.squares[1])
    }

    /// The same with rows that have the last unknowns alone.
    pub(crate) fn finished_with<const M: usize>(
        self,
        last: Normal<M>,
    ) -> (SMatrix<f64, N, N>, SVector<f64, N>, f64) {
        let ((mut normal, mut right, squares), last) = (self.finished(), last.finished());
        let mut own = normal.fixed_view_mut::<M, M>(N - M, N - M);
        own += last.0;
        let mut own = right.fixed_rows_mut::<M>(N - M);
        own += last.1;
        (normal, right, squares + last.2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_single_rows() {
        for count in 0..10 {
            let rows = (0..count)
                .map(|k| (SVector::from([1.0, f64::from(k), f64::from(k * k)]), f64::from(k) - 2.5));
            let mut found = Normal::<3>::new();
            rows.clone().for_each(|(row, residual)| found.add([row.x, row.y, row.z], residual));
            let (normal, right, squares) = found.finished();
            let expected = rows.clone().fold(SMatrix::zeros(), |sum, it| sum + it.0 * it.0.transpose());
            // Whole numbers and halves: without rounding.
            assert_eq!(normal, expected);
            assert_eq!(right, rows.clone().fold(SVector::zeros(), |sum, it| sum + it.0 * it.1));
            assert_eq!(squares, rows.map(|it| it.1 * it.1).sum::<f64>());
        }
    }
}
