//! The fit of screws and terms together.

use super::choice::{CorrectionChoice, SizesReason, TriedSizes, choose, weight_of_prior};
use super::context::{CorrectionContext, RowSample};
use super::correction_fit::CorrectedFit;
use super::gravity::of_no_use;
use super::linear::draw_deviation;
use super::predictive_covariance::uncertainty;
use super::unknowns::{estimate, moving_joints, priors, unknowns};
use crate::estimate_noise;
use crate::run::CalibrationRun;
use crate::run::accuracy::model_accuracy;
use crate::run::noise::{NoiseSource, merge_stated_noise};
use crate::run::station_frames::locate_stations;
use crate::run::task::FitTask;
use crate::steps::calibrated_fit::CalibratedFit;
use crate::steps::fit_progress::OngoingFit;
use poecal_fit::state::{Estimate, PackedValues, RowError, Session};
use poecal_model::measurement::{ByQuantity, Noise};
use poecal_model::robot::{CorrectionModel, GravityDirection, JointTerm, Sizes};

/// Most rounds of re-estimating the noise.
const ROUNDS: usize = 4;
/// Change of the noise below which it stays, as a share.
const SETTLED: f64 = 0.02;
/// Factor of the first trust region.
const UNDAMPED: f64 = 1e3;
/// The fit stops within a tenth of a standard deviation: the priors determine directions no better.
const DECREMENT: f64 = 1e-2;

/// Fits screws and terms together (theory.md §6, *Corrections*), with these sizes or with those that cross-validation chooses. Returns geometry alone
/// if the fit of terms fails.
pub(crate) fn fit_corrected(geometry: &CalibratedFit<'_>, sizes: Option<Sizes>) -> CorrectedFit {
    let context = CorrectionContext::new(geometry);
    let moves = moving_joints(&context.session, &context.rows);
    let is_found = geometry.run.options.gravity == GravityDirection::Found;
    let (gravity, doubt) = match geometry.run.options.gravity {
        GravityDirection::Known(direction) => (direction, None),
        GravityDirection::Found => context.gravity(&moves, sizes.unwrap_or(Sizes::COMMON)),
    };
    let all = CorrectionModel::new(&context.nominal, gravity, &moves, context.extent(sizes));
    let all = sizes.map_or_else(|| all.clone(), |sizes| all.with_sizes(&sizes));
    let choice = context.choose_sizes(&all, sizes);
    // Terms that may be present keep their part of the uncertainty.
    let possible = if sizes.is_some() { choice.sizes } else { choice.sizes.max(&Sizes::COMMON) };
    let model = all.with_sizes(&possible);
    let found = context.with_terms(&model, &possible, &choice).unwrap_or_else(|reason| {
        let none = context.choose_sizes(&model, Some(Sizes::NONE));
        context.without_terms(&model, &possible, SizeChoice { reason, tried: choice.tried, ..none })
    });
    let is_of_no_use = is_found && found.sizes == Sizes::NONE;
    CorrectedFit { doubt: doubt.or_else(|| is_of_no_use.then(of_no_use)), ..found }
}

/// Sizes, and the optimum with them in the linear approximation of the rows.
#[derive(Clone)]
struct SizeChoice {
    sizes: Sizes,
    reason: SizesReason,
    tried: Vec<TriedSizes>,
    estimate: Estimate,
    noise: Noise,
    /// Variance of the residuals whitened by stated noise, at least 1; 1 if the noise is estimated.
    variance: f64,
    /// Mean squared error of left-out parts, relative to the expectation by their fits (theory.md (43a)).
    growth: f64,
}

impl CorrectionContext<'_> {
    /// Chooses the prior sizes of the terms, unless they are stated.
    fn choose_sizes(&self, model: &CorrectionModel, sizes: Option<Sizes>) -> SizeChoice {
        let (mut noise, source) = (self.geometry.noise(), self.geometry.robust.fitted.noise_source);
        let Some(RowSample { mut linear, parts, configurations }) = self.sample_rows(model, sizes) else {
            let (sizes, reason) =
                sizes.map_or((Sizes::NONE, SizesReason::Undetermined), |sizes| (sizes, SizesReason::Given));
            let estimate = self.start(model);
            return SizeChoice { sizes, reason, tried: Vec::new(), estimate, noise, variance: 1.0, growth: 1.0 };
        };
        let mut variance = 1.0;
        let usual = sizes.unwrap_or(Sizes::COMMON);
        if source == NoiseSource::Estimated {
            for (quantity, factor) in linear.whiten(&usual) {
                noise[quantity] *= factor;
            }
        } else if source != NoiseSource::Exact {
            variance = linear.weigh_priors(&usual);
        }
        let whole = linear.normal_information();
        let parts = linear.parts(&parts, &whole);
        let choice = match sizes {
            Some(sizes) => CorrectionChoice { sizes, reason: SizesReason::Given, tried: Vec::new() },
            None => choose(&linear, &parts, configurations),
        };
        let estimate = linear.solution(&choice.sizes, &whole).unwrap_or_else(|| self.start(model));
        let growth = if parts.is_empty() { 1.0 } else { linear.growth(&parts, &whole, &choice.sizes) };
        let CorrectionChoice { sizes, reason, tried } = choice;
        SizeChoice { sizes, reason, tried, estimate, noise, variance, growth }
    }

    /// The fit with the chosen sizes; the reason if it is worse than geometry alone.
    fn with_terms(
        &self,
        model: &CorrectionModel,
        possible: &Sizes,
        choice: &SizeChoice,
    ) -> Result<CorrectedFit, SizesReason> {
        let SizeChoice { sizes, reason, ref estimate, noise, variance, .. } = *choice;
        if sizes == Sizes::NONE {
            return Ok(self.without_terms(model, possible, choice.clone()));
        }
        let (of_geometry, options) = (self.session, &self.geometry.run.options);
        let packed = PackedValues::from_dataset(&model.robot, of_geometry.data);
        let unknowns = unknowns(model, of_geometry.unknowns, &sizes);
        let session = self.session(model, &packed, &unknowns);
        let coefficient = |it: JointTerm| estimate.coefficient(it.joint, it.term);
        let terms = self.start(model).terms.into_iter();
        let terms = terms.map(|it| JointTerm { coefficient: coefficient(it), ..it }).collect();
        let start = Estimate { terms, ..estimate.clone() };
        // The start is the optimum of the linear approximation: no damping.
        let mut near = options.clone();
        near.solver.trust *= UNDAMPED;
        near.solver.decrement = near.solver.decrement.max(DECREMENT);
        let prior = options.prior_with_terms(&session).with_terms(priors(model, &sizes));
        let weight = weight_of_prior(of_geometry.data.configurations(&self.rows).len()) * variance;
        let task = FitTask { options: &near, ..self.task(session, (&prior, weight)) };
        let (found, noise) = refit_with_noise(&task, start, noise, self.geometry);
        let predicted = FitPrediction::new(self, &session, &found, noise);
        // If rows are far from linear, the fit of terms may fail.
        if !self.is_no_worse(&predicted.training) {
            return Err(SizesReason::LedNowhere);
        }
        if reason != SizesReason::Given && self.is_worse_held_out(&predicted.held_out) {
            return Err(SizesReason::WorseHeldOut);
        }
        let found = self.complete_fit(model, possible, choice.clone(), (packed, predicted, noise));
        if found.uncertainty.is_none() { Err(SizesReason::LedNowhere) } else { Ok(found) }
    }

    /// Geometry alone, with the uncertainty due to terms that may be present.
    fn without_terms(&self, model: &CorrectionModel, possible: &Sizes, choice: SizeChoice) -> CorrectedFit {
        let (of_geometry, noise) = (self.session, self.geometry.noise());
        let packed = PackedValues::from_dataset(&model.robot, of_geometry.data);
        let unknowns = unknowns(model, of_geometry.unknowns, &Sizes::NONE);
        let session = self.session(model, &packed, &unknowns);
        let predicted = FitPrediction::new(self, &session, &self.start(model), noise);
        self.complete_fit(model, possible, choice, (packed, predicted, noise))
    }

    /// Geometry as an estimate of a model.
    fn start(&self, model: &CorrectionModel) -> Estimate {
        estimate(model, &self.geometry.estimate, self.session.data)
    }

    /// A fit with its uncertainty by all terms that are possible.
    fn complete_fit(
        &self,
        model: &CorrectionModel,
        possible: &Sizes,
        choice: SizeChoice,
        (packed, predicted, noise): (PackedValues, FitPrediction, Noise),
    ) -> CorrectedFit {
        let SizeChoice { sizes, reason, tried, variance, growth, .. } = choice;
        let (of_geometry, CalibrationRun { options, fit_rows, held_out_rows, .. }) = (self.session, &self.geometry.run);
        let FitPrediction { estimate, training, held_out } = predicted;
        let every = unknowns(model, of_geometry.unknowns, possible);
        let session = self.session(model, &packed, &every);
        let weight = weight_of_prior(of_geometry.data.configurations(&self.rows).len());
        let prior = options.prior_with_terms(&session).with_terms(priors(model, possible));
        let whole = self.task(session, (&prior, weight));
        CorrectedFit {
            uncertainty: uncertainty(
                &whole,
                (&estimate, noise),
                (&prior, [weight, variance]),
                (growth, self.geometry.optics.as_ref()),
            ),
            unknowns: unknowns(model, of_geometry.unknowns, &sizes),
            training: model_accuracy(of_geometry.data, fit_rows, &training),
            held_out: (!held_out_rows.is_empty()).then(|| model_accuracy(of_geometry.data, held_out_rows, &held_out)),
            prior_weight: weight * variance,
            model: model.clone(),
            possible: *possible,
            doubt: None,
            sizes,
            reason,
            tried,
            packed,
            estimate,
            noise,
        }
    }
}

/// Predictions of a fit: its model with the frames of all stations, and its errors.
struct FitPrediction {
    estimate: Estimate,
    training: Vec<RowError>,
    held_out: Vec<RowError>,
}

impl FitPrediction {
    fn new(context: &CorrectionContext<'_>, session: &Session<'_>, found: &Estimate, noise: Noise) -> Self {
        let CalibrationRun { fit_rows, held_out_rows, .. } = &context.geometry.run;
        let estimate = locate_stations(session, &context.rows, found, noise).into_owned();
        let [training, held_out] = [fit_rows, held_out_rows].map(|rows| session.errors(rows, &estimate));
        FitPrediction { estimate, training, held_out }
    }
}

/// Measured numbers of each quantity.
fn numbers(task: &FitTask<'_>) -> ByQuantity<f64> {
    let mut counts: ByQuantity<f64> = ByQuantity::default();
    for &row in task.rows {
        let channels = task.session.observation(row).measurement.channels();
        channels.iter().for_each(|channel| counts[channel.quantity] += 1.0);
    }
    counts
}

/// The optimum with the noise re-estimated.
fn refit_with_noise(task: &FitTask<'_>, start: Estimate, noise: Noise, of: &CalibratedFit<'_>) -> (Estimate, Noise) {
    let (mut estimate, mut noise) = (start, noise);
    let counts = numbers(task);
    let all: f64 = counts.iter().map(|(_, count)| *count).sum();
    for _ in 0..ROUNDS {
        let found = OngoingFit::new(task.fit(estimate, noise));
        let known = task.effective_unknowns(&found);
        estimate = found.estimate;
        if of.robust.fitted.noise_source != NoiseSource::Estimated {
            break;
        }
        let Some(better) = estimate_noise(&task.session, task.rows, &estimate, known, None, noise) else {
            break;
        };
        let better = ByQuantity::from_fn(|quantity| {
            let freedom = counts[quantity] * (1.0 - known / all).max(0.0);
            draw_deviation(of.noise()[quantity], better[quantity].powi(2) * freedom, freedom)
        });
        let better = merge_stated_noise(task.options, better);
        let change = better.iter().map(|(quantity, sigma)| (sigma / noise[quantity]).ln().abs());
        let is_settled = change.fold(0.0, f64::max) < SETTLED;
        noise = better;
        if is_settled {
            break;
        }
    }
    (estimate, noise)
}
