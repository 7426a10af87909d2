//! Screws and terms fitted together, after geometry.

use super::calibrated_fit::CalibratedFit;
use super::summary::FitSummary;
use crate::corrections::{CorrectedFit, fit_corrected};
use crate::{Corrections, RobustLoss};
use poecal_fit::uncertainty::CrossValidation;
use poecal_numerics::error::Result;

/// Most rounds of judging rows by the corrected model.
const JUDGEMENTS: usize = 3;

/// A session with all its fits.
pub(crate) struct FittedSession<'a> {
    pub(crate) fit: CalibratedFit<'a>,
    /// Corrected model; `None` without corrections.
    pub(crate) corrected: Option<CorrectedFit>,
    pub(crate) summary: FitSummary,
    /// Cross-validation of geometry; `None` with too few rows.
    pub(crate) cross_validation: Option<CrossValidation>,
}

impl<'a> CalibratedFit<'a> {
    /// Fits screws and terms together, if terms are requested. Joint effects beyond geometry are no outliers: if the corrected model suspects other
    /// rows, geometry is refitted without these, and so are the terms.
    pub(crate) fn correct(self) -> Result<FittedSession<'a>> {
        let mut fit = self;
        let mut corrected = fit.fit_corrected();
        for _ in 0..JUDGEMENTS {
            let Some(suspected) = fit.other_suspects(corrected.as_ref()) else { break };
            fit = fit.refit_with_suspects(&suspected)?;
            corrected = fit.fit_corrected();
        }
        let (summary, cross_validation) = fit.run.in_pool(|| {
            let summary = FitSummary::from_fit(&fit);
            let cross_validation = summary.cross_validated(&fit);
            (summary, cross_validation)
        });
        Ok(FittedSession { fit, corrected, summary, cross_validation })
    }

    /// The corrected model; `None` without corrections.
    fn fit_corrected(&self) -> Option<CorrectedFit> {
        let sizes = match self.run.corrections {
            Corrections::Off => return None,
            Corrections::Auto | Corrections::All => None,
            Corrections::Sizes(sizes) => Some(sizes),
        };
        Some(self.run.in_pool(|| fit_corrected(self, sizes)))
    }

    /// Marks each row suspected by the corrected model; `None` if these are the rows that geometry suspects.
    fn other_suspects(&self, corrected: Option<&CorrectedFit>) -> Option<Vec<bool>> {
        let is_open = self.run.options.robust == RobustLoss::Auto && self.run.left_out.is_empty();
        self.robust.robustness.suspects().next().filter(|_| is_open)?;
        corrected?.other_suspects(self)
    }
}
