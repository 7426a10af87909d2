//! Robust fits: iteratively reweighted least squares, and the decision for or against them (theory.md §6, *Outliers*).

mod common_errors;
mod influence;
mod loss;
mod rows;
mod scale;

pub use influence::{RowInfluence, row_influence};
pub use loss::{Loss, RobustLoss};
pub use rows::{Robustness, RowJudgement};

use super::{CalibrationOptions, estimate_noise};
use crate::run::noise::{NoiseSource, merge_stated_noise};
use crate::run::task::FitTask;
use crate::steps::fit_progress::{FinishedFit, OngoingFit, RegisteredStart};
pub(crate) use common_errors::RepeatedConfigurations;
use poecal_fit::parameters::Parameter;
use poecal_fit::start::{Registration, register_robustly};
use poecal_fit::state::Estimate;
use poecal_fit::uncertainty::{FitView, PriorInformation, leave_clusters_out};
use poecal_model::measurement::{ByQuantity, Noise};
use poecal_numerics::error::Result;
use poecal_numerics::solve;
use rows::{Bounds, is_judgeable};
pub(crate) use rows::{JudgingFit, judge_rows};
use scale::{RobustScale, RowResiduals, parts, settle};

/// Most reweightings with one loss.
const REWEIGHTINGS: usize = 60;
/// Iterations between two reweightings.
const ITERATIONS: usize = 6;
/// Largest change of settled weights.
const SETTLED: f64 = 1e-3;

/// A finished fit in the form by which rows are judged.
fn judging_fit(fitted: &FinishedFit) -> JudgingFit<'_> {
    let FinishedFit { estimate, noise, normal, .. } = fitted;
    JudgingFit { estimate, noise: *noise, normal, unknowns: normal.dim() as f64 }
}

/// A fit with its loss, and every row of the data judged by it.
#[derive(Clone)]
pub(crate) struct RobustFit {
    pub(crate) fitted: FinishedFit,
    pub(crate) robustness: Robustness,
}

/// Fits as the options state: by least squares, by a robust loss, or by Tukey's if least squares show outliers.
pub(crate) fn fit(task: &FitTask<'_>, registration: &Registration<'_>, start: &RegisteredStart) -> Result<RobustFit> {
    let configurations = &RepeatedConfigurations::new(task.session.data, task.rows);
    let attempt = |loss, other| attempt(task, configurations, registration, start, loss, other);
    let ordinary = |found| finish_least_squares(task, configurations, found, start);
    match task.options.robust {
        RobustLoss::Off => ordinary(task.first_fit(start)),
        RobustLoss::Loss(loss) => attempt(loss, None),
        RobustLoss::Auto => {
            let found = task.first_fit(start);
            if !shows_outliers(task, configurations, &found, start) {
                return ordinary(found);
            }
            let tried = attempt(Loss::Tukey, None)?;
            if !tried.is_evident(task) {
                return ordinary(found);
            }
            let plain = ordinary(found)?;
            let tried = if tried.is_suspicious(task) {
                // Apparent outliers may be the effect of a local minimum: further starts come first.
                if !plain.is_evident(task) {
                    return Ok(plain);
                }
                attempt(Loss::Tukey, Some(&plain.fitted.estimate))?
            } else {
                tried
            };
            // A row of high leverage may be the only one that determines some direction: cross-validation by the other rows decides.
            Ok(if tried.is_evident(task) && tried.predicts_better(task, &plain) { tried } else { plain })
        }
    }
}

/// Fits by least squares without some rows; these rows, and no others, are then suspected.
pub(crate) fn fit_without(task: &FitTask<'_>, start: &RegisteredStart, left_out: &[u32]) -> Result<RobustFit> {
    let is_left_out = |row: &u32| left_out.binary_search(row).is_ok();
    let kept: Vec<u32> = task.rows.iter().copied().filter(|row| !is_left_out(row)).collect();
    let of_kept = FitTask { rows: &kept, ..*task };
    let fitted = of_kept.complete_first_fit(of_kept.first_fit(start), start)?;
    let count = u32::try_from(task.session.data.len()).unwrap_or(u32::MAX);
    let weights: Vec<f64> = (0..count).map(|row| f64::from(u8::from(!is_left_out(&row)))).collect();
    let weighted = FitTask { weights: Some(&weights), ..*task };
    let configurations = RepeatedConfigurations::new(task.session.data, task.rows);
    let robustness = judge_rows(&weighted, &configurations, judging_fit(&fitted), &weights, Some(Loss::Tukey));
    let suspected: Vec<bool> = (0..count).map(|row| is_left_out(&row)).collect();
    Ok(RobustFit { fitted, robustness: robustness.with_suspects(&suspected) })
}

impl RobustFit {
    /// Weights of all rows; suspected ones have weight 0.
    pub(crate) fn weights(&self) -> Vec<f64> {
        let counted = |row: &RowJudgement| if row.suspected { 0.0 } else { row.weight };
        self.robustness.rows.iter().map(counted).collect()
    }

    /// True if a fitted row is suspected.
    fn is_evident(&self, task: &FitTask<'_>) -> bool {
        task.rows.iter().any(|&row| self.robustness.suspects_row(row))
    }

    /// True if it predicts held-out clusters of rows better than another fit, by a bounded loss.
    fn predicts_better(&self, task: &FitTask<'_>, other: &RobustFit) -> bool {
        let scale = self.robustness.scale;
        let noise = ByQuantity::from_fn(|quantity| scale[quantity] * self.fitted.noise[quantity]);
        match (self.cross_validated_loss(task, noise), other.cross_validated_loss(task, noise)) {
            (Some(own), Some(others)) => own < others,
            _ => true,
        }
    }

    /// Mean bounded loss of the rows of each cluster of configurations by the fit of the others, in units of this noise.
    fn cross_validated_loss(&self, task: &FitTask<'_>, noise: Noise) -> Option<f64> {
        let FinishedFit { estimate, layout, noise: own, .. } = &self.fitted;
        let prior = task.prior.map(|(prior, _)| prior);
        let prior = PriorInformation::new(prior, estimate, layout, task.session.length_m);
        let free: Vec<Parameter> = layout.parameters().map(|(parameter, _)| *parameter).collect();
        let weights: Vec<f64> = self.robustness.rows.iter().map(|row| row.weight).collect();
        let view = FitView {
            session: task.session,
            rows: task.rows,
            free: &free,
            noise: *own,
            noise_is_stated: ByQuantity::default(),
            prior: &prior,
            variance: 1.0,
            estimate,
        };
        let bound = Bounds::new(task.rows.len(), 1.0);
        leave_clusters_out(&view, &weights, |row, error| {
            let observation = task.session.observation(row);
            let own = task.session.equalize_noise(observation, *error);
            let squares = ByQuantity::from_fn(|quantity| own.square(quantity));
            let whitened = task.session.whiten_squares(observation, squares, noise);
            let square: f64 = whitened.iter().map(|(_, square)| square).sum();
            let ratio = square / bound.bound(error.dim()).powi(2);
            1.0 - (1.0 - ratio.min(1.0)).powi(3)
        })
    }

    /// True if the robust scale of position errors is larger than elastic gears and links explain.
    fn is_suspicious(&self, task: &FitTask<'_>) -> bool {
        let parts = parts(&task.session, task.rows, &self.fitted.estimate, self.fitted.noise);
        let scale = RobustScale::from_rows(parts.iter(), self.fitted.normal.dim() as f64);
        task.is_suspicious(3f64.sqrt() * scale.of_lengths(self.fitted.noise))
    }
}

/// Completes a fit by least squares.
fn finish_least_squares(
    task: &FitTask<'_>,
    configurations: &RepeatedConfigurations,
    found: OngoingFit,
    start: &RegisteredStart,
) -> Result<RobustFit> {
    let fitted = task.complete_first_fit(found, start)?;
    let weights = vec![1.0; task.session.data.len()];
    let robustness = judge_rows(task, configurations, judging_fit(&fitted), &weights, None);
    Ok(RobustFit { fitted, robustness })
}

/// True if any residual exceeds the 1/1000 quantile at the robust scale: a cheap screening, after which a robust fit decides.
fn shows_outliers(
    task: &FitTask<'_>,
    configurations: &RepeatedConfigurations,
    found: &OngoingFit,
    start: &RegisteredStart,
) -> bool {
    let noise = start.noise;
    let unknowns = configurations.repeats * found.normal.dim() as f64;
    let mut parts = parts(&task.session, task.rows, &found.estimate, noise);
    if !is_judgeable(parts.iter(), unknowns) {
        return false;
    }
    let (_, scale) = settle(&mut parts, unknowns, noise, noise_options(task, start.source));
    let bounds = Bounds::new(task.rows.len(), 1.0);
    let shares = configurations.shares(&task.session, &found.estimate);
    task.rows.iter().zip(&parts).any(|(&row, part)| {
        let (length, components) = scale.length(part);
        shares[row as usize] * length > bounds.bound(components)
    })
}

/// The options if the noise is to be estimated.
fn noise_options<'a>(task: &FitTask<'a>, source: NoiseSource) -> Option<&'a CalibrationOptions> {
    (source == NoiseSource::Estimated).then_some(task.options)
}

/// A robust fit: from a robust registration by Huber's loss, which adds no local minima, then by `loss`. `other` is a further start, tried if the
/// robust scale is suspicious.
fn attempt(
    task: &FitTask<'_>,
    configurations: &RepeatedConfigurations,
    registration: &Registration<'_>,
    RegisteredStart { registered, noise, source }: &RegisteredStart,
    loss: Loss,
    other: Option<&Estimate>,
) -> Result<RobustFit> {
    let source = *source;
    let mut best = ReweightedFit::new(task, configurations, register_robustly(registration, registered), *noise);
    best.run(task, Loss::Huber, source);
    if let Some(other) = other.filter(|_| task.is_suspicious(3f64.sqrt() * best.position_m())) {
        let mut second = ReweightedFit::new(task, configurations, other.clone(), *noise);
        second.run(task, Loss::Huber, source);
        if second.position_m() < best.position_m() {
            best = second;
        }
    }
    if loss != Loss::Huber {
        best.run(task, loss, source);
    }
    best.end(task, loss, source)
}

/// A fit by reweighting.
struct ReweightedFit<'c> {
    configurations: &'c RepeatedConfigurations,
    estimate: Estimate,
    noise: Noise,
    scale: RobustScale,
    weights: Vec<f64>,
    iterations: usize,
    trace: Vec<f64>,
}

impl<'c> ReweightedFit<'c> {
    fn new(task: &FitTask<'_>, configurations: &'c RepeatedConfigurations, mut start: Estimate, noise: Noise) -> Self {
        start.recentre(&task.session, task.rows);
        let weights = vec![1.0; task.session.data.len()];
        ReweightedFit {
            configurations,
            estimate: start,
            noise,
            scale: RobustScale(Noise::new(1.0, 1.0)),
            weights,
            iterations: 0,
            trace: Vec::new(),
        }
    }

    /// Robust standard deviation of a position component.
    fn position_m(&self) -> f64 {
        self.scale.of_lengths(self.noise)
    }

    /// Number of unknowns, times the mean number of repeats: repeated rows add no information.
    fn unknowns(&self, task: &FitTask<'_>) -> f64 {
        self.configurations.repeats * task.problem(&self.estimate, self.noise).layout().dim() as f64
    }

    /// The task with the prior weighted by the robust scale.
    fn with_prior_weight<'t>(&self, task: &FitTask<'t>, source: NoiseSource) -> FitTask<'t> {
        let variance = if source == NoiseSource::Estimated { 1.0 } else { self.scale.0.of_lengths().powi(2) };
        let weight = variance / task.prior.map_or(1.0, |(prior, _)| prior.looseness(&self.estimate));
        task.with_prior_weight(task.prior_weight(weight))
    }

    /// Reweights until the weights have settled.
    fn run(&mut self, task: &FitTask<'_>, loss: Loss, source: NoiseSource) {
        let quick = CalibrationOptions {
            solver: solve::Options { iterations: ITERATIONS, ..task.options.solver },
            ..task.options.clone()
        };
        for _ in 0..REWEIGHTINGS {
            let mut parts = parts(&task.session, task.rows, &self.estimate, self.noise);
            let unknowns = self.unknowns(task);
            (self.noise, self.scale) = settle(&mut parts, unknowns, self.noise, noise_options(task, source));
            if self.reweight(task, &parts, loss) < SETTLED {
                break;
            }
            let weighted =
                FitTask { weights: Some(&self.weights), options: &quick, ..self.with_prior_weight(task, source) };
            let (estimate, _, summary) = weighted.fit(self.estimate.clone(), self.noise);
            self.iterations += summary.iterations;
            self.trace.extend(summary.trace);
            self.estimate = estimate;
        }
    }

    /// Updates the weights of the fitted rows; returns the largest change.
    fn reweight(&mut self, task: &FitTask<'_>, parts: &[RowResiduals], loss: Loss) -> f64 {
        let mut change: f64 = 0.0;
        let shares = self.configurations.shares(&task.session, &self.estimate);
        for (&row, part) in task.rows.iter().zip(parts) {
            let (length, components) = self.scale.length(part);
            let weight = loss.weight(shares[row as usize] * length, components);
            let old = std::mem::replace(&mut self.weights[row as usize], weight);
            change = change.max((weight - old).abs());
        }
        change
    }

    /// Completes the fit: noise from the rows that are not suspected, weights by it, and a fit with these to the optimum.
    fn end(mut self, task: &FitTask<'_>, loss: Loss, source: NoiseSource) -> Result<RobustFit> {
        let bounds = Bounds::suspicion_bounds(task.rows.len());
        let mut source = source;
        let mut found: Option<OngoingFit> = None;
        for _ in 0..ITERATIONS {
            let mut parts = parts(&task.session, task.rows, &self.estimate, self.noise);
            let unknowns = self.unknowns(task);
            let shares = self.configurations.shares(&task.session, &self.estimate);
            let kept: Vec<u32> = task
                .rows
                .iter()
                .zip(&parts)
                .filter(|(row, part)| {
                    let (length, components) = self.scale.length(part);
                    shares[**row as usize] * length <= bounds.bound(components)
                })
                .map(|(&row, _)| row)
                .collect();
            if source == NoiseSource::Estimated {
                let before = self.noise;
                let of_kept = FitTask { rows: &kept, ..*task };
                let unknowns = found.as_ref().map_or(unknowns, |found| of_kept.effective_unknowns(found));
                let by_rotations = found.as_ref().and_then(|found| of_kept.determined_by_rotations(found, before));
                let session = &task.session;
                match estimate_noise(session, &kept, &self.estimate, unknowns, by_rotations, before) {
                    Some(noise) => self.noise = merge_stated_noise(task.options, noise),
                    None => source = NoiseSource::Exact,
                }
                parts = scale::parts(&task.session, task.rows, &self.estimate, self.noise);
            }
            let kept_parts = parts.iter().zip(task.rows).filter(|(_, row)| kept.binary_search(row).is_ok());
            self.scale =
                RobustScale::from_rows(kept_parts.map(|(part, _)| part), unknowns).at_least_rounding(self.noise);
            let change = self.reweight(task, &parts, loss);
            if change < SETTLED && found.is_some() {
                break;
            }
            let weighted = FitTask { weights: Some(&self.weights), ..self.with_prior_weight(task, source) };
            let renewed = weighted.fit(self.estimate, self.noise);
            self.estimate = renewed.0.clone();
            match &mut found {
                Some(found) => found.update(renewed),
                None => found = Some(OngoingFit::new(renewed)),
            }
        }
        let weighted = FitTask { weights: Some(&self.weights), ..self.with_prior_weight(task, source) };
        let mut found = match found {
            Some(found) => found,
            None => OngoingFit::new(weighted.fit(self.estimate, self.noise)),
        };
        found.report.iterations += self.iterations;
        found.report.trace.splice(0..0, self.trace);
        let fitted = weighted.finish(found, self.noise, source)?;
        let robustness = judge_rows(&weighted, self.configurations, judging_fit(&fitted), &self.weights, Some(loss));
        Ok(RobustFit { fitted, robustness })
    }
}
