//! Unobservable directions of the unknowns: covariances are stated where predictions move least along them (theory.md §9 (39e)).

use nalgebra::{DMatrix, RowDVector};

use super::motions::motions;
use super::view::FitView;
use crate::problem::Layout;
use crate::state::{Linkage, Sight, sample_rows};
use poecal_numerics::linalg;

/// Largest number of rows whose predictions choose.
const ROWS: usize = 240;

/// Effect of a direction of length 1 on the positions, mean square, below which it is only that of links that bend and stay behind.
const NO_EFFECT: f64 = 2e-4;

/// Unobservable directions, and the motion of the unknowns along them.
pub(super) struct Gauge {
    /// A column for each direction.
    directions: DMatrix<f64>,
    /// Parts of the directions in a step of all unknowns: those with the smallest motion of the predicted positions.
    parts: DMatrix<f64>,
    /// Share of each direction that is growth, if no measurement has a length.
    growth: Option<RowDVector<f64>>,
}

impl Gauge {
    /// Gauge of a fit; `None` if its rows determine all that they predict.
    pub(super) fn from_view(view: &FitView<'_>, layout: &Layout) -> Option<Self> {
        let FitView { session, estimate, .. } = *view;
        let mut unseen = layout.base_motions(estimate, &session, view.rows);
        let grows = session.lacks_length(view.rows);
        if grows {
            unseen.push(layout.growth(estimate, session.data, view.rows));
        }
        if unseen.is_empty() {
            return None;
        }
        let unseen = DMatrix::from_fn(layout.dim(), unseen.len(), |i, k| unseen[k][i]);
        let sample = sample_rows(view.rows, ROWS);
        let rows: Vec<_> =
            view.with_sights(&sample).iter().map(|(row, sight)| (*row, Sight::from(sight.target))).collect();
        let all = motions(layout, &Linkage::new(estimate), session.packed, &rows, 1);
        // Combinations of the directions with effects of their own.
        let along = &all * &unseen;
        let (values, vectors) = linalg::symmetric_eigen(along.tr_mul(&along).as_slice(), unseen.ncols());
        let seen: Vec<usize> = (0..values.len()).filter(|&k| values[k] > NO_EFFECT * all.nrows() as f64).collect();
        if seen.is_empty() {
            return None;
        }
        let scaled = |k: usize| vectors.column(k) / values[k].sqrt();
        let combined = DMatrix::from_columns(&seen.iter().map(|&k| scaled(k)).collect::<Vec<_>>());
        let last = combined.nrows().checked_sub(1)?;
        let along = &along * &combined;
        Some(Gauge {
            growth: grows.then(|| combined.row(last).into_owned()),
            directions: unseen * combined,
            parts: along.tr_mul(&all),
        })
    }

    /// A covariance (row-major) with unobservable directions chosen so that predicted positions in the rows' configurations move least.
    pub(super) fn fix_gauge(&self, covariance: &[f64]) -> Vec<f64> {
        let n = self.directions.nrows();
        let all = DMatrix::from_row_slice(n, n, covariance);
        let left = &all - &self.directions * (&self.parts * &all);
        let both = &left - (&left * self.parts.transpose()) * self.directions.transpose();
        (&both + both.transpose()).scale(0.5).as_slice().to_vec()
    }

    /// Relative standard deviation of the size of the robot and the cell, if no row determines it.
    pub(super) fn size_sigma(&self, covariance: &[f64]) -> Option<f64> {
        let n = self.directions.nrows();
        let own = self.growth.as_ref()? * &self.parts;
        let all = DMatrix::from_row_slice(n, n, covariance);
        Some((&own * all).dot(&own).max(0.0).sqrt())
    }
}
