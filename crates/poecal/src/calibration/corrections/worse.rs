//! Whether terms are worse than geometry alone, after their fit.

use super::geometry::Geometry;
use crate::calibration::located::located;
use crate::estimate::{Estimate, RowError, Session};

/// Ratio of errors above which a fit is worse on held-out rows.
const WORSE: f64 = 1.02;
/// Fewest held-out configurations that say so.
const FEWEST_HELD_OUT: usize = 4;

impl Geometry<'_> {
    /// Whether a fit with terms explains the fitted rows no worse than geometry alone.
    pub(super) fn is_no_worse(&self, session: &Session<'_>, estimate: &Estimate) -> bool {
        let counts =
            |row: &&u32| self.weights.is_none_or(|it| it.get(**row as usize).is_none_or(|it| *it > 0.5));
        let rows: Vec<u32> = self.rows.iter().filter(counts).copied().collect();
        let squares = |session: &Session<'_>, estimate: &Estimate| -> f64 {
            let errors = session.errors(&rows, estimate);
            errors.iter().map(|error| error.lead().norm_squared()).sum()
        };
        squares(session, estimate) <= squares(&self.session, &self.calibration.models.calibrated)
    }

    /// Whether a fit with terms is worse than geometry alone on the rows that were held out: by more than [`WORSE`], and by more than the
    /// standard error of the mean over their configurations.
    pub(super) fn is_worse_held_out(&self, session: &Session<'_>, estimate: &Estimate) -> bool {
        let rows = &self.calibration.held_out_rows;
        // Devices of which no row was fitted have no frame yet.
        let noise = self.calibration.noise;
        let fitted = &self.rows;
        let errors = |session: &Session<'_>, estimate: &Estimate| {
            session.errors(rows, &located(session, fitted, estimate, noise))
        };
        let with = errors(session, estimate);
        let without = errors(&self.session, &self.calibration.models.calibrated);
        let squares = |errors: &[RowError], of: &[u32]| -> f64 {
            let at = of.iter().filter_map(|row| rows.binary_search(row).ok()?.into());
            let each = at.filter_map(|at: usize| errors.get(at)).map(|error| error.lead().norm_squared());
            each.sum::<f64>() / of.len().max(1) as f64
        };
        let each: Vec<(f64, f64)> = self
            .session
            .data
            .configurations(rows)
            .iter()
            .map(|of| (squares(&with, of), squares(&without, of)))
            .collect();
        let count = each.len() as f64;
        if each.len() < FEWEST_HELD_OUT {
            return false;
        }
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| each.iter().map(of).sum::<f64>() / count;
        let (after, before) = (mean(&|it| it.0), mean(&|it| it.1));
        let spread = mean(&|it| (it.0 - it.1 - after + before).powi(2)).sqrt();
        after > (WORSE * WORSE) * before && after - before > spread / (count - 1.0).sqrt()
    }
}
