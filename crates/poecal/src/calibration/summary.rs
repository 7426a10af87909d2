//! Inputs of the analysis after a fit.

use super::corrections::Geometry;
use super::fit::minimal;
use super::noise::is_stated;
use super::robust::registrable;
use super::run::{CalibratedFit, Run};
use super::{CalibrationOptions, Formulation};
use crate::estimate::{Estimate, Session};
use crate::measurement::{ByQuantity, Noise};
use crate::parameters::Parameter;
use crate::problem::Layout;
use crate::solve::Normal;
use crate::uncertainty::{CrossValidation, PriorInformation, Remainder, View, cross_validate, remainder};

/// Efficiency of the robust losses under normal noise.
const EFFICIENCY: f64 = 0.95;

/// Unknowns of a fit in the minimal basis, with their information from the kept rows, whatever the parameterisation and loss of the fit.
pub(super) struct FitSummary {
    /// Rows that a robust fit keeps, or all that were fitted.
    pub(super) kept: Vec<u32>,
    pub(super) layout: Layout,
    pub(super) normal: Normal,
    pub(super) remainder: Remainder,
    free: Vec<Parameter>,
    prior: PriorInformation,
    noise: Noise,
    noise_is_stated: ByQuantity<bool>,
    /// Variance of the whitened residuals.
    variance: f64,
}

/// A summary with the session and the model that it is of.
pub(super) struct Finished<'a> {
    pub(super) view: View<'a>,
    pub(super) layout: &'a Layout,
    pub(super) normal: &'a Normal,
    pub(super) remainder: &'a Remainder,
    pub(super) seed: u64,
}

impl FitSummary {
    /// The summary of an optimum by these rows, with their information and a prior.
    pub(super) fn new(
        (session, estimate): (&Session<'_>, &Estimate),
        kept: Vec<u32>,
        (layout, normal): (Layout, Normal),
        prior: PriorInformation,
        noise: Noise,
        options: &CalibrationOptions,
    ) -> Self {
        let chosen = layout.motions_without_effect(estimate, session, &kept).directions;
        let mut summary = FitSummary {
            free: layout.parameters().map(|(parameter, _)| *parameter).collect(),
            prior: prior.with_chosen(&chosen, session.length_m),
            noise_is_stated: is_stated(session.data, options),
            remainder: Remainder::default(),
            variance: 1.0,
            kept,
            layout,
            normal,
            noise,
        };
        let view = summary.view(*session, estimate);
        summary.remainder = remainder(&view, &summary.normal, &summary.layout);
        summary.variance = summary.remainder.variance;
        summary
    }

    pub(super) fn view<'a>(&'a self, session: Session<'a>, estimate: &'a Estimate) -> View<'a> {
        let FitSummary { kept, free, prior, noise, noise_is_stated, variance, .. } = self;
        let (noise, noise_is_stated, variance) = (*noise, *noise_is_stated, *variance);
        View { session, rows: kept, free, noise, noise_is_stated, prior, variance, estimate }
    }

    pub(super) fn of<'a>(&'a self, geometry: &Geometry<'a>) -> Finished<'a> {
        let view = self.view(geometry.session, geometry.estimate);
        let FitSummary { layout, normal, remainder, .. } = self;
        Finished { view, layout, normal, remainder, seed: geometry.options.seed }
    }

    /// Cross-validation of the fit.
    pub(super) fn cross_validated(&self, geometry: &Geometry<'_>) -> Option<CrossValidation> {
        cross_validate(&self.view(geometry.session, geometry.estimate), geometry.options.seed)
    }
}

impl Run<'_> {
    /// What the rows of a fit say of its unknowns.
    pub(super) fn summary(&self, of: &CalibratedFit) -> FitSummary {
        let (session, is_robust) = (self.session(&of.noise_ratios), of.robust.loss.is_some());
        let (fitted, calibrated) = (&of.robust.fitted, &of.calibrated);
        let kept = if is_robust {
            registrable(&of.robust.judged.rows, &self.fit_rows)
        } else {
            self.fit_rows.clone()
        };
        let is_usual = self.options.formulation == Formulation::default();
        let (layout, normal) = if (is_usual || fitted.layout.is_minimal()) && !is_robust {
            (fitted.layout.clone(), fitted.normal.clone())
        } else {
            minimal(session, &kept, calibrated, fitted.noise)
        };
        let prior = PriorInformation::new(self.prior.as_ref(), calibrated, &layout, session.length_m);
        let of = ((&session, calibrated), (layout, normal));
        let mut summary = FitSummary::new(of.0, kept, of.1, prior, fitted.noise, &self.options);
        summary.variance /= if is_robust { EFFICIENCY } else { 1.0 };
        summary
    }
}
