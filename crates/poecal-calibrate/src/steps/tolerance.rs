//! Tolerances of the prior, chosen by cross-validation.

use super::summary::FitSummary;
use crate::run::Run;
use poecal_model::robot::Tolerance;
use poecal_numerics::error::Result;

/// What the usual tolerance may lose, of the mean logarithm of the errors of rows that are left out, and is taken still.
const USUAL: f64 = 0.01;

/// Tolerances that are tried: the usual one, of more and more precise robots, and of ones that are hardly like their drawing.
fn tried() -> [Tolerance; 5] {
    let of = |angle_deg: f64, length_m| Tolerance { angle_rad: angle_deg.to_radians(), length_m };
    [Tolerance::default(), of(0.2, 2e-3), of(0.05, 5e-4), of(1.0, 1e-2), of(3.0, 1e-2)]
}

impl Run<'_> {
    /// The same with the tolerance whose fit predicts rows best which are left out (random folds, ends of the joints' ranges, files, ids), if
    /// that is asked for.
    ///
    /// # Errors
    /// Those of the fits.
    pub(crate) fn with_best_tolerance(self) -> Result<Self> {
        if !self.options.chooses_tolerance {
            return Ok(self);
        }
        let mut best = (f64::INFINITY, Tolerance::default());
        for tolerance in tried() {
            let run = self.with_tolerance(tolerance);
            let start = run.register();
            let fit = run.fit(start)?;
            let validated = fit.run.in_pool(|| FitSummary::from_fit(&fit).cross_validated(&fit));
            // Too few rows for cross-validation choose nothing.
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
