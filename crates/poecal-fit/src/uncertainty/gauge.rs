//! Directions of the unknowns that no row sees: covariances are stated where predictions move least along them (theory.md §9 (39e)).

use nalgebra::DMatrix;

use super::motions::motions;
use super::view::View;
use crate::problem::Layout;
use crate::state::{Linkage, sample_rows};
use poecal_numerics::linalg;

/// Most rows whose predictions choose.
const ROWS: usize = 240;

/// What no row sees, and what the unknowns do along it.
pub(super) struct Gauge {
    /// A column for each direction; the last one is the growth of everything where nothing has a length.
    directions: DMatrix<f64>,
    /// Parts of the directions in a step of all unknowns: those that leave the predicted places nearest.
    parts: DMatrix<f64>,
    grows: bool,
}

impl Gauge {
    /// That of some rows; `None` where they see everything.
    pub(super) fn of(view: &View<'_>, layout: &Layout) -> Option<Self> {
        let View { session, estimate, .. } = *view;
        let mut directions = layout.motions_without_effect(estimate, &session, view.rows).of_base();
        let grows = session.lacks_length(view.rows);
        if grows {
            directions.push(layout.growth(estimate, session.data, view.rows));
        }
        if directions.is_empty() {
            return None;
        }
        let directions = DMatrix::from_fn(layout.dim(), directions.len(), |i, k| directions[k][i]);
        let sample: Vec<u32> = sample_rows(view.rows, ROWS);
        let rows: Vec<_> = view
            .with_sights(&sample)
            .into_iter()
            .map(|(row, sight)| super::in_first((row, sight.target)))
            .collect();
        let all = motions(layout, &Linkage::new(estimate), session.packed, &rows, 1);
        let along = &all * &directions;
        let parts = linalg::solved(along.tr_mul(&along), &(along.transpose() * all))?;
        Some(Gauge { directions, parts, grows })
    }

    /// A covariance (row-major) with what no row sees chosen so that predicted places in the rows' configurations move least.
    pub(super) fn fixed(&self, covariance: &[f64]) -> Vec<f64> {
        let n = self.directions.nrows();
        let all = DMatrix::from_row_slice(n, n, covariance);
        let left = &all - &self.directions * (&self.parts * &all);
        let both = &left - (&left * self.parts.transpose()) * self.directions.transpose();
        (&both + both.transpose()).scale(0.5).as_slice().to_vec()
    }

    /// Standard deviation of the size of everything, as a share, where no row sees it.
    pub(super) fn sigma_of_size(&self, covariance: &[f64]) -> Option<f64> {
        let n = self.directions.nrows();
        let own = self.parts.row(self.parts.nrows() - 1);
        let all = DMatrix::from_row_slice(n, n, covariance);
        self.grows.then(|| (own * &all).dot(&own).max(0.0).sqrt())
    }
}
