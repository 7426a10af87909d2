//! Inputs of the analysis after a fit.

use super::calibrated_fit::CalibratedFit;
use crate::robust::RobustFit;
use crate::run::fit::minimal_layout;
use crate::run::noise::is_stated;
use crate::{CalibrationOptions, Formulation};
use poecal_fit::parameters::Parameter;
use poecal_fit::problem::{Layout, Problem};
use poecal_fit::state::{Estimate, Session};
use poecal_fit::uncertainty::{
    CrossValidation, FitView, PriorInformation, ResidualVariance, cross_validate, remainder,
};
use poecal_model::measurement::{ByQuantity, Noise};
use poecal_numerics::solve::NormalEquations;

/// Efficiency of the robust losses under normal noise.
const EFFICIENCY: f64 = 0.95;

/// Unknowns of a fit in the minimal basis, with their information from the kept rows, for any parameterisation and loss of the fit.
pub(crate) struct FitSummary {
    /// Rows that a robust fit keeps, or all fitted rows.
    pub(crate) kept: Vec<u32>,
    pub(crate) layout: Layout,
    pub(crate) normal: NormalEquations,
    pub(crate) remainder: ResidualVariance,
    free: Vec<Parameter>,
    prior: PriorInformation,
    noise: Noise,
    noise_is_stated: ByQuantity<bool>,
    /// Variance of the whitened residuals.
    variance: f64,
}

impl FitSummary {
    /// The summary of an optimum by these rows, with their information and a prior.
    pub(crate) fn new(
        (session, estimate): (&Session<'_>, &Estimate),
        kept: Vec<u32>,
        (layout, normal): (Layout, NormalEquations),
        prior: PriorInformation,
        noise: Noise,
        options: &CalibrationOptions,
    ) -> Self {
        let chosen = layout.motions_without_effect(estimate, session, &kept).directions;
        let mut summary = FitSummary {
            free: layout.parameters().map(|(parameter, _)| *parameter).collect(),
            prior: prior.with_chosen(&chosen, session.length_m),
            noise_is_stated: is_stated(session.data, options),
            remainder: ResidualVariance::default(),
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

    pub(crate) fn view<'a>(&'a self, session: Session<'a>, estimate: &'a Estimate) -> FitView<'a> {
        let FitSummary { kept, free, prior, noise, noise_is_stated, variance, .. } = self;
        let (noise, noise_is_stated, variance) = (*noise, *noise_is_stated, *variance);
        FitView { session, rows: kept, free, noise, noise_is_stated, prior, variance, estimate }
    }

    /// Cross-validation of the fit.
    pub(crate) fn cross_validated(&self, fit: &CalibratedFit<'_>) -> Option<CrossValidation> {
        cross_validate(&self.view(fit.session(), &fit.estimate), fit.run.options.seed)
    }

    /// The summary of a fit.
    pub(crate) fn from_fit(fit: &CalibratedFit<'_>) -> Self {
        let CalibratedFit { run, robust: RobustFit { fitted, robustness }, estimate, .. } = fit;
        let (session, is_robust) = (fit.session(), robustness.loss.is_some());
        let kept = if is_robust { robustness.registration_rows(&run.fit_rows) } else { run.fit_rows.clone() };
        let is_usual = run.options.formulation == Formulation::default();
        let (layout, normal) = if (is_usual || fitted.layout.is_minimal()) && !is_robust {
            (fitted.layout.clone(), fitted.normal.clone())
        } else {
            minimal_layout(session, &kept, estimate, fitted.noise)
        };
        let mut normal = normal;
        if let Some(optics) = &fit.optics {
            let free = layout.parameters().map(|(parameter, _)| *parameter).collect();
            let problem = Problem::new(session, kept.clone(), free, fitted.noise);
            optics.loosen(session.data, &problem, estimate, &mut normal);
        }
        let prior = PriorInformation::new(run.prior.as_ref(), estimate, &layout, session.length_m);
        let information = (layout, normal);
        let mut summary = FitSummary::new((&session, estimate), kept, information, prior, fitted.noise, &run.options);
        summary.variance /= if is_robust { EFFICIENCY } else { 1.0 };
        summary
    }
}
