//! Screws and terms fitted together, after geometry.

use super::corrections::{self, CorrectedFit};
use super::run::{CalibratedFit, Run};
use super::summary::FitSummary;
use super::{Corrections, Robust};
use crate::error::Result;
use crate::uncertainty::CrossValidation;

/// Most rounds of judging rows by the corrected model.
const JUDGEMENTS: usize = 3;

/// A session with all that was fitted to it.
pub(super) struct Found<'a> {
    pub(super) run: Run<'a>,
    pub(super) fit: CalibratedFit,
    /// None without corrections.
    pub(super) corrected: Option<CorrectedFit>,
    pub(super) summary: FitSummary,
    /// Cross-validation of geometry; `None` with too few rows.
    pub(super) cross_validation: Option<CrossValidation>,
}

impl<'a> Run<'a> {
    /// Fits screws and terms together, if terms are asked for. What joints do beyond geometry makes no outliers: where the corrected model
    /// suspects other rows, geometry is fitted again without these, and so are the terms.
    pub(super) fn correct(self, mut fit: CalibratedFit) -> Result<Found<'a>> {
        let mut corrected = self.corrected(&fit);
        for _ in 0..JUDGEMENTS {
            let Some(suspected) = self.other_suspects(&fit, corrected.as_ref()) else { break };
            fit = self.suspecting(fit, &suspected)?;
            corrected = self.corrected(&fit);
        }
        let (summary, cross_validation) = self.in_pool(|| {
            let summary = self.summary(&fit);
            let cross_validation = summary.cross_validated(&self.geometry(&fit));
            (summary, cross_validation)
        });
        Ok(Found { run: self, fit, corrected, summary, cross_validation })
    }

    /// The corrected model beside a fit; `None` without corrections.
    fn corrected(&self, fit: &CalibratedFit) -> Option<CorrectedFit> {
        let sizes = match self.corrections {
            Corrections::Off => return None,
            Corrections::Auto | Corrections::All => None,
            Corrections::Sizes(sizes) => Some(sizes),
        };
        Some(self.in_pool(|| corrections::fit(&self.geometry(fit), self.options.gravity, sizes)))
    }

    /// Whether each row is suspected by the corrected model, where these are other rows than those that geometry suspects.
    fn other_suspects(&self, fit: &CalibratedFit, corrected: Option<&CorrectedFit>) -> Option<Vec<bool>> {
        let geometry = self.geometry(fit);
        let is_open = self.options.robust == Robust::Auto && self.left_out.is_empty();
        geometry.suspects().next().filter(|_| is_open)?;
        corrected?.other_suspects(&geometry)
    }
}
