//! Comparison of terms with geometry alone, after their fit.

use super::context::CorrectionContext;
use poecal_fit::state::RowError;

/// Ratio of errors above which a fit is worse on held-out rows.
const WORSE: f64 = 1.02;
/// Fewest held-out configurations that decide it.
const FEWEST_HELD_OUT: usize = 4;

impl CorrectionContext<'_> {
    /// True if a fit with terms explains the fitted rows no worse than geometry alone, by its errors on these.
    pub(crate) fn is_no_worse(&self, training: &[RowError]) -> bool {
        let rows = &self.geometry.run.fit_rows;
        let without = self.session.errors(rows, &self.geometry.estimate);
        let squares = |errors: &[RowError]| -> f64 {
            let counted = rows.iter().zip(errors).filter(|(row, _)| self.weight(**row) > 0.5);
            counted.map(|(_, error)| error.lead().norm_squared()).sum()
        };
        squares(training) <= squares(&without)
    }

    /// True if a fit with terms is worse than geometry alone on the held-out rows, by its errors on these: by more than [`WORSE`], and by more than
    /// the standard error of the mean over their configurations.
    pub(crate) fn is_worse_held_out(&self, with: &[RowError]) -> bool {
        let rows = &self.geometry.run.held_out_rows;
        let configurations = self.session.data.configurations(rows);
        if configurations.len() < FEWEST_HELD_OUT {
            return false;
        }
        let without = self.session.errors(rows, &self.geometry.estimate);
        let squares = |errors: &[RowError], of: &[u32]| -> f64 {
            let at = of.iter().filter_map(|row| rows.binary_search(row).ok());
            let each = at.filter_map(|at: usize| errors.get(at)).map(|error| error.lead().norm_squared());
            each.sum::<f64>() / of.len().max(1) as f64
        };
        let each: Vec<(f64, f64)> =
            configurations.iter().map(|of| (squares(with, of), squares(&without, of))).collect();
        let count = each.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| each.iter().map(of).sum::<f64>() / count;
        let (after, before) = (mean(&|it| it.0), mean(&|it| it.1));
        let spread = mean(&|it| (it.0 - it.1 - after + before).powi(2)).sqrt();
        after > (WORSE * WORSE) * before && after - before > spread / (count - 1.0).sqrt()
    }
}
