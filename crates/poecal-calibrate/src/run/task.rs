//! A fit in steps: from registration to the optimum, with noise and prior weight re-estimated.

use super::fit::{SUSPICIOUS, fit_screws, free_parameters, is_suspicious};
use super::noise::merge_stated_noise;
use super::prior_bias::{EXACT, FINE, RELEASED, SOONER, left_by_pull};
use crate::steps::fit_progress::{FinishedFit, OngoingFit, RegisteredStart};
use crate::{CalibrationOptions, Formulation, Minimum, NoiseSource, estimate_noise};
use poecal_fit::analysis::effective_unknowns;
use poecal_fit::parameters::Parameter;
use poecal_fit::problem::{Prior, Problem};
use poecal_fit::state::{Estimate, Session};
use poecal_model::measurement::{Noise, Quantity};
use poecal_numerics::distributions::is_within_band;
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_numerics::solve::{LeastSquares as _, NormalEquations, Options, Summary};
use poecal_numerics::unit::Unit;

/// Most rounds of re-estimating noise and the weight of the prior. Two or three suffice, except for data without noise.
const RENEWALS: usize = 12;

/// Predicted reduction of a full step.
fn predicted_reduction(normal: &NormalEquations) -> f64 {
    normal.full_step().map_or(0.0, |step| normal.predicted_reduction(&step))
}

/// A fit: session, rows, weights, prior, options.
#[derive(Clone, Copy)]
pub(crate) struct FitTask<'a> {
    pub(crate) session: Session<'a>,
    pub(crate) rows: &'a [u32],
    /// Weights of all rows of the data; `None` if all are 1.
    pub(crate) weights: Option<&'a [f64]>,
    /// Prior, and its weight: the variance of the whitened residuals.
    pub(crate) prior: Option<(&'a Prior, f64)>,
    pub(crate) options: &'a CalibrationOptions,
}

impl FitTask<'_> {
    /// The task with another weight of the prior.
    pub(crate) fn with_prior_weight(&self, weight: f64) -> Self {
        FitTask { prior: self.prior.map(|(prior, _)| (prior, weight)), ..*self }
    }

    /// A weight of the prior, at least 1 if no measured quantity has a length: noise would shrink the robot.
    pub(crate) fn prior_weight(&self, weight: f64) -> f64 {
        if self.session.lacks_length(self.rows) { weight.max(1.0) } else { weight }
    }

    /// The prior's weight in the first fit. An estimated noise then consists mostly of errors of the screws, so the prior is weighted as beside the
    /// usual error of gears and links.
    fn with_first_prior_weight(&self, start: &RegisteredStart) -> Self {
        let usual = 0.1 * SUSPICIOUS * 3.0 * self.session.length_m / start.noise.of_lengths();
        let is_open = start.source == NoiseSource::Estimated;
        self.with_prior_weight(self.prior_weight(if is_open { (usual * usual).min(1.0) } else { 1.0 }))
    }

    /// The first fit from a registration.
    pub(crate) fn first_fit(&self, start: &RegisteredStart) -> OngoingFit {
        let mut registered = start.registered.clone();
        registered.recentre(&self.session, self.rows);
        OngoingFit::new(self.with_first_prior_weight(start).fit(registered, start.noise))
    }

    /// Effective number of unknowns determined by the measurements rather than the prior: theory.md §6 (34).
    pub(crate) fn effective_unknowns(&self, found: &OngoingFit) -> f64 {
        let by_prior = self.prior_information(found).map(|believed| effective_unknowns(&found.normal, &believed));
        found.normal.dim() as f64 - by_prior.unwrap_or(0.0)
    }

    /// The prior's part of a fit's normal information.
    fn prior_information(&self, found: &OngoingFit) -> Option<NormalEquations> {
        let (prior, weight) = self.prior?;
        let problem = self.problem(&found.estimate, Noise::new(1.0, 1.0));
        let mut believed = NormalEquations::new(found.normal.dim());
        prior.add(&found.estimate, problem.layout(), weight, &mut believed);
        Some(believed)
    }

    /// True if the residuals are evidently bias of the prior and no instrument noise; never if the prior alone determines the size of the robot.
    fn is_pull(&self, found: &OngoingFit, noise: Noise) -> bool {
        let Session { length_m, .. } = self.session;
        let believed = if self.session.lacks_length(self.rows) { None } else { self.prior_information(found) };
        let of_rows = FitTask { prior: None, ..*self };
        let seen = || of_rows.problem(&found.estimate, noise).normal(&found.estimate);
        let left = believed.and_then(|believed| left_by_pull(&found.normal, &believed, seen));
        let is_measured = |it: &Quantity| it.unit() == Unit::Metre && self.session.data.has(*it);
        let lengths = Quantity::ALL.into_iter().filter(is_measured).map(|it| noise[it]);
        let noise_m = lengths.fold(0.0, f64::max);
        left.is_some_and(|left| (left * self.mean_square(found)).sqrt() * noise_m < FINE * length_m)
    }

    /// True if residuals are so near rounding that the remaining bias of the prior does not matter.
    fn is_exact(&self, found: &OngoingFit, noise: Noise, source: NoiseSource) -> bool {
        let rounding = || self.problem(&found.estimate, noise).rounding();
        source == NoiseSource::Exact && self.mean_square(found) < EXACT * rounding()
    }

    /// Mean squared whitened residual, without the prior's part of the cost.
    fn mean_square(&self, found: &OngoingFit) -> f64 {
        let believed = self.prior.map_or(0.0, |(prior, weight)| weight * prior.cost(&found.estimate));
        2.0 * (found.normal.cost - believed).max(0.0) / found.normal.residuals.max(1) as f64
    }

    /// Completes a first fit: further starts if needed, then rounds with noise and prior weight re-estimated (noise only if its source is the
    /// residuals).
    pub(crate) fn complete_first_fit(&self, mut found: OngoingFit, start: &RegisteredStart) -> Result<FinishedFit> {
        let RegisteredStart { mut noise, mut source, .. } = *start;
        let mut task = self.with_first_prior_weight(start);
        if let Some((better, tried)) = task.restart(&start.registered, &found.estimate, noise) {
            found.report.restarts = tried;
            if let Some(better) = better {
                found.update(task.fit(better, noise));
            }
        }
        for _ in 0..RENEWALS {
            let (unknowns, before) = (task.effective_unknowns(&found), noise);
            let is_pull = source == NoiseSource::Estimated && task.is_pull(&found, noise);
            if source == NoiseSource::Estimated {
                let by_rotations = task.determined_by_rotations(&found, noise);
                let (session, rows) = (&self.session, self.rows);
                match estimate_noise(session, rows, &found.estimate, unknowns, by_rotations, noise) {
                    Some(estimated) => noise = merge_stated_noise(self.options, estimated),
                    None => source = NoiseSource::Exact,
                }
            }
            if task.is_exact(&found, noise, source) {
                break;
            }
            let released = if is_pull { RELEASED } else { 1.0 };
            let weight = released * task.renewed_weight(&found, unknowns, source);
            let weighed = task.prior.is_none_or(|(_, counted)| (weight / counted).ln().abs() < 0.5);
            let fits = source != NoiseSource::Estimated
                || noise == before
                || self.change(noise, before) < 0.02 && task.mean_square(&found).ln().abs() < 0.5;
            task = task.with_prior_weight(weight);
            if fits && (weighed || !(weight.is_finite() && weight > 0.0)) {
                break;
            }
            let estimate = found.estimate.clone();
            found.update(if is_pull { task.released_fit(estimate, noise) } else { task.fit(estimate, noise) });
        }
        task.finish(found, noise, source)
    }

    /// The prior's weight in the next fit.
    fn renewed_weight(&self, found: &OngoingFit, unknowns: f64, source: NoiseSource) -> f64 {
        let mut weight = 1.0;
        if source != NoiseSource::Estimated {
            // Stated noise scales the prior as long as it explains the residuals.
            let freedom = (found.normal.residuals as f64 - unknowns).max(1.0);
            let variance = self.mean_square(found) * found.normal.residuals as f64 / freedom;
            let explains = source != NoiseSource::Exact && is_within_band(variance, freedom).is_eq();
            weight = if explains { 1.0 } else { variance };
        }
        // The axes' deviations estimate the quality of the nominal model.
        weight /= self.prior.map_or(1.0, |(prior, _)| prior.looseness(&found.estimate));
        if source == NoiseSource::Exact { weight } else { self.prior_weight(weight) }
    }

    /// Change of the ratios of noises: ratio of the largest to the smallest change among them, as a logarithm.
    fn change(&self, noise: Noise, before: Noise) -> f64 {
        let is_used = |quantity: Quantity| self.session.data.has(quantity) || quantity.is_of_pose();
        let used = || noise.iter().filter(|(quantity, _)| is_used(*quantity));
        let logs = || used().map(|(quantity, sigma)| (sigma / before[quantity]).ln());
        logs().fold(f64::NEG_INFINITY, f64::max) - logs().fold(f64::INFINITY, f64::min)
    }

    /// Effective number of unknowns determined by the rotation residuals, `tr(N⁻¹ N_R)`: theory.md §6 (34). Only for few rows, with which it matters.
    pub(crate) fn determined_by_rotations(&self, found: &OngoingFit, noise: Noise) -> Option<f64> {
        const FEW: usize = 300;
        // With positions practically unmeasured, the information of rotations remains.
        const UNMEASURED_M: f64 = 1e9;
        let turns = |row: &u32| self.session.observation(*row).measurement.sees_orientation();
        if self.rows.len() > FEW || !self.rows.iter().any(turns) {
            return None;
        }
        let rotations = noise.without_lengths(UNMEASURED_M);
        let seen = FitTask { prior: None, ..*self };
        let part = seen.problem(&found.estimate, rotations).normal(&found.estimate);
        Some(effective_unknowns(&found.normal, &part))
    }

    /// The result of a fit at its optimum, with its information in the minimal basis where possible.
    pub(crate) fn finish(&self, found: OngoingFit, noise: Noise, source: NoiseSource) -> Result<FinishedFit> {
        let mut found = found;
        let mut normal = self.problem(&found.estimate, noise).normal(&found.estimate);
        // The last change of the noise moved the optimum.
        let is_exact = self.is_exact(&found, noise, source);
        if !is_exact && predicted_reduction(&normal) > self.options.solver.decrement * normal.mean_square() {
            let start = found.estimate.clone();
            found.update(self.minimize(&self.problem(&start, noise), start, &self.options.solver));
            normal = self.problem(&found.estimate, noise).normal(&found.estimate);
        }
        let OngoingFit { mut estimate, mut report, .. } = found;
        if !normal.cost.is_finite() {
            return Err(Error::new(
                ErrorKind::Solver,
                "found residuals that are not finite numbers, expected a fit: check the measurements' units and joint columns",
            ));
        }
        if self.prior.is_some() {
            normal = FitTask { prior: None, ..*self }.problem(&estimate, noise).normal(&estimate);
        } else if self.problem(&estimate, noise).layout().is_minimal() {
            (estimate, normal) = self.settle_null_directions(estimate, normal, noise, &mut report);
        }
        let layout = self.problem(&estimate, noise).layout().clone();
        let offsets = |(parameter, _): (&Parameter, _)| matches!(parameter, Parameter::ValueTerm(_));
        // Requested terms belong to the robot.
        let is_of_formulation = self.options.formulation != Formulation::default();
        report.joint_offsets = (is_of_formulation && layout.parameters().any(offsets)).then(|| estimate.offsets());
        Ok(FinishedFit { estimate, normal, layout, noise, noise_source: source, report })
    }

    /// One fit. With weights it begins near the optimum, and on all rows.
    pub(crate) fn fit(&self, start: Estimate, noise: Noise) -> (Estimate, NormalEquations, Summary) {
        if self.weights.is_some() {
            return self.minimize(&self.problem(&start, noise), start, &self.options.solver);
        }
        fit_screws(self.session, self.rows, start, noise, self.prior, self.options)
    }

    /// One fit with a released prior.
    fn released_fit(&self, start: Estimate, noise: Noise) -> (Estimate, NormalEquations, Summary) {
        let mut options = self.options.clone();
        options.solver.decrement *= SOONER;
        FitTask { options: &options, ..*self }.fit(start, noise)
    }

    /// Minimises with the formulation of the options.
    pub(crate) fn minimize(&self, problem: &Problem<'_>, start: Estimate, options: &Options) -> Minimum {
        (self.options.formulation.minimize)(problem, start, options)
    }

    /// The free parameters.
    pub(crate) fn free_parameters(&self, estimate: &Estimate) -> Vec<Parameter> {
        let joints = (self.options.formulation.joint_parameters)(estimate.kinds());
        free_parameters(&self.session, estimate, self.rows, joints)
    }

    /// The problem of these rows and weights.
    pub(crate) fn problem(&self, estimate: &Estimate, noise: Noise) -> Problem<'_> {
        let free = self.free_parameters(estimate);
        let problem = Problem::new(self.session, self.rows.to_vec(), free, noise).with_prior(self.prior);
        match self.weights {
            Some(weights) => problem.with_weights(weights),
            None => problem,
        }
    }

    /// [`is_suspicious`] for this robot.
    pub(crate) fn is_suspicious(&self, rms_m: f64) -> bool {
        is_suspicious(rms_m, self.session.length_m)
    }
}
