//! Tolerances of the prior, chosen by cross-validation.

use super::summary::FitSummary;
use crate::run::CalibrationRun;
use poecal_model::robot::Tolerance;
use poecal_numerics::error::Result;

/// Largest loss with which the usual tolerance is still preferred, in the mean logarithm of the errors of left-out rows.
const USUAL: f64 = 0.01;

/// Tried tolerances: the usual one, those of more and more precise robots, and those of robots that hardly match their nominal model.
fn tolerances_to_try() -> [Tolerance; 5] {
    let of = |angle_deg: f64, length_m| Tolerance { angle_rad: angle_deg.to_radians(), length_m };
    [Tolerance::default(), of(0.2, 2e-3), of(0.05, 5e-4), of(1.0, 1e-2), of(3.0, 1e-2)]
}

impl CalibrationRun<'_> {
    /// The run with the tolerance whose fit predicts left-out rows best (random folds, ends of the joints' ranges, files, ids), if that is requested.
    ///
    /// # Errors
    /// Those of the fits.
    pub(crate) fn with_best_tolerance(self) -> Result<Self> {
        if !self.options.chooses_tolerance {
            return Ok(self);
        }
        let mut best = (f64::INFINITY, Tolerance::default());
        for tolerance in tolerances_to_try() {
            let run = self.with_tolerance(tolerance);
            let start = run.register();
            let fit = run.fit(start)?;
            let validated = fit.run.in_pool(|| FitSummary::from_fit(&fit).cross_validated(&fit));
            // With too few rows for cross-validation, the default tolerance is used.
            let Some(validated) = validated else { return Ok(self.with_tolerance(Tolerance::default())) };
            let errors = std::iter::once(&validated.random).chain(&validated.blocked).map(|it| it.rms.lead());
            let count = 1.0 + validated.blocked.len() as f64;
            let mean = errors.map(|it| it.max(f64::MIN_POSITIVE).ln()).sum::<f64>() / count;
            let bonus = if tolerance == Tolerance::default() { USUAL } else { 0.0 };
            if mean - bonus < best.0 {
                best = (mean - bonus, tolerance);
            }
        }
        Ok(self.with_tolerance(best.1))
    }
}
