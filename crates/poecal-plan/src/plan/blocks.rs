//! Rows of configurations as linear functions of the unknowns.

use nalgebra::DMatrix;

use poecal_numerics::linalg;

/// Whitened rows of configurations, one after the other, with `numbers` and `columns` each.
#[derive(Clone, Debug)]
pub(crate) struct ConfigurationRows {
    pub(crate) values: Vec<f64>,
    pub(crate) numbers: usize,
    pub(crate) columns: usize,
}

impl ConfigurationRows {
    /// Number of configurations.
    pub(crate) fn count(&self) -> usize {
        self.values.len() / (self.numbers * self.columns).max(1)
    }

    /// Rows of a configuration, row after row.
    pub(crate) fn rows_of_configuration(&self, index: usize) -> &[f64] {
        let size = self.numbers * self.columns;
        &self.values[index * size..(index + 1) * size]
    }

    /// Information of some configurations together.
    pub(crate) fn gram(&self, some: impl IntoIterator<Item = usize>) -> DMatrix<f64> {
        let n = self.columns;
        let mut upper = vec![0.0; n * n];
        for index in some {
            linalg::add_gram(&mut upper, n, self.rows_of_configuration(index), 0);
        }
        DMatrix::from_fn(n, n, |i, j| upper[i.min(j) * n + i.max(j)])
    }

    /// The first columns alone.
    pub(crate) fn first_columns(&self, columns: usize) -> ConfigurationRows {
        let rows = self.values.chunks_exact(self.columns);
        ConfigurationRows { values: rows.flat_map(|row| row[..columns].iter().copied()).collect(), columns, ..*self }
    }

    /// The configurations of some indices.
    pub(crate) fn select(&self, some: &[usize]) -> ConfigurationRows {
        let values = some.iter().flat_map(|&index| self.rows_of_configuration(index).iter().copied()).collect();
        ConfigurationRows { values, ..*self }
    }
}
