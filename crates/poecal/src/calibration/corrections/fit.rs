//! The fit of screws and terms together.

use super::choice::{Choice, SizesReason, TriedSizes, choose, weight_of_prior};
use super::effects::effects;
use super::found::Correction;
use super::geometry::{Geometry, Sampled};
use super::gravity::of_no_use;
use super::linear::between;
use super::promise::uncertainty;
use super::unknowns::{estimate, moving, priors, unknowns, weights};
use crate::analysis::coverage;
use crate::calibration::accuracy::model_accuracy;
use crate::calibration::expected::{Expectations, expectations_beside};
use crate::calibration::fit::Task;
use crate::calibration::found::OngoingFit;
use crate::calibration::located::{located, promised_rows};
use crate::calibration::noise::{NoiseSource, stated};
use crate::calibration::placed::{place_tip, stations};
use crate::calibration::{Calibration, CalibrationOptions, PredictedUncertainty, delivered, estimate_noise};
use crate::estimate::{Estimate, Packed, Session, sample_rows};
use crate::gauge;
use crate::measurement::{ByQuantity, Dataset, Noise, Quantity};
use crate::robot::{CorrectionModel, GravityDirection, JointTerm, Robot, Sizes};

/// Most rounds of re-estimating the noise.
const ROUNDS: usize = 4;
/// Change of the noise below which it stays, as a share.
const SETTLED: f64 = 0.02;
/// Most held-out rows whose bounds are checked.
const JUDGED: usize = 4000;
/// Factor of the first trust region.
const UNDAMPED: f64 = 1e3;
/// The fit stops within a tenth of a standard deviation: what the priors hold is not known better.
const DECREMENT: f64 = 1e-2;

/// Fits screws and terms together, from a finished calibration (theory.md §6, *Corrections*): with these sizes, or with those that
/// cross-validation chooses.
#[must_use]
pub fn correct(
    calibration: &Calibration,
    data: &Dataset,
    gravity: GravityDirection,
    sizes: Option<Sizes>,
    options: &CalibrationOptions,
) -> Correction {
    let own = calibration.packed(data);
    let session = calibration.session(data, &own).with_noise_ratios(&calibration.noise_ratios);
    let weights = weights(calibration, options);
    // Rows without weight say nothing of the noise either.
    let counts = |row: &u32| {
        weights.as_deref().is_none_or(|it| it.get(*row as usize).is_none_or(|weight| *weight > 0.0))
    };
    let rows: Vec<u32> = calibration.fit_rows.iter().copied().filter(counts).collect();
    // Terms that geometry has are of no group.
    let mut nominal = calibration.nominal.clone();
    for &(joint, term) in &session.unknowns.terms {
        if !nominal.terms.iter().any(|it| (it.joint, it.term) == (joint, term)) {
            nominal.terms.push(JointTerm { joint, term, coefficient: 0.0 });
        }
    }
    let moves = moving(&session, &rows);
    let weights = weights.as_deref();
    let geometry = Geometry { calibration, nominal, session, options, rows, weights };
    let is_found = gravity == GravityDirection::Found;
    let (gravity, doubt) = match gravity {
        GravityDirection::Known(direction) => (direction, None),
        GravityDirection::Found => geometry.gravity(&moves, sizes.unwrap_or(Sizes::COMMON)),
    };
    let all = CorrectionModel::new(&geometry.nominal, gravity, &moves, geometry.extent(sizes));
    let all = sizes.map_or_else(|| all.clone(), |sizes| all.with_sizes(&sizes));
    let begun = geometry.begin(&all, sizes);
    // Terms that may be there keep their part of the uncertainty.
    let possible = if sizes.is_some() { begun.sizes } else { begun.sizes.max(&Sizes::COMMON) };
    let found = geometry.end(all.with_sizes(&possible), &possible, begun);
    let is_of_no_use = is_found && !found.has_terms();
    Correction { doubt: doubt.or_else(|| is_of_no_use.then(of_no_use)), ..found }
}

/// Sizes, and the optimum with them as far as rows are linear.
struct Begun {
    sizes: Sizes,
    reason: SizesReason,
    tried: Vec<TriedSizes>,
    estimate: Estimate,
    noise: Noise,
    /// Variance of the residuals whitened by stated noise, at least 1; 1 where the noise is estimated.
    variance: f64,
    /// Mean squared error of parts that were left out, over what their fits let expect (theory.md (43a)).
    growth: f64,
}

impl Geometry<'_> {
    /// Chooses sizes, unless they are given.
    fn begin(&self, model: &CorrectionModel, sizes: Option<Sizes>) -> Begun {
        let Geometry { calibration, .. } = *self;
        let noise = calibration.noise;
        let start = || estimate(model, &calibration.models.calibrated, self.session.data);
        let Some(Sampled { mut linear, parts, configurations }) = self.sampled(model, sizes) else {
            let (sizes, reason) =
                sizes.map_or((Sizes::NONE, SizesReason::Undetermined), |sizes| (sizes, SizesReason::Given));
            let estimate = start();
            return Begun { sizes, reason, tried: Vec::new(), estimate, noise, variance: 1.0, growth: 1.0 };
        };
        let mut noise = noise;
        let mut variance = 1.0;
        let usual = sizes.unwrap_or(Sizes::COMMON);
        if calibration.noise_source == NoiseSource::Estimated {
            for (quantity, factor) in linear.whiten(&usual) {
                noise[quantity] *= factor;
            }
        } else if calibration.noise_source != NoiseSource::Exact {
            variance = linear.weigh_priors(&usual);
        }
        let whole = linear.whole();
        let parts = linear.parts(&parts, &whole);
        let choice = match sizes {
            Some(sizes) => Choice { sizes, reason: SizesReason::Given, tried: Vec::new() },
            None => choose(&linear, &parts, configurations),
        };
        let estimate = linear.solution(&choice.sizes, &whole).unwrap_or_else(start);
        let growth = if parts.is_empty() { 1.0 } else { linear.growth(&parts, &whole, &choice.sizes) };
        let Choice { sizes, reason, tried } = choice;
        Begun { sizes, reason, tried, estimate, noise, variance, growth }
    }

    /// The fit of a model with the sizes of a beginning, and what it promises with all terms that are possible.
    fn end(&self, model: CorrectionModel, possible: &Sizes, begun: Begun) -> Correction {
        let Geometry { calibration, options, .. } = *self;
        let Begun { sizes, reason, tried, estimate: begun, noise, variance, growth } = begun;
        let of_geometry = self.session;
        let data = of_geometry.data;
        let start = estimate(&model, &calibration.models.calibrated, data);
        let packed = Packed::of(&model.robot, data);
        let fitted_unknowns = unknowns(&model, of_geometry.unknowns, &sizes);
        let session = self.session(&model, &packed, &fitted_unknowns);
        let rows = &self.rows;
        let weight = weight_of_prior(data.configurations(rows).len());
        let (estimate, noise) = if sizes == Sizes::NONE {
            (start, calibration.noise)
        } else {
            let coefficient = |it: JointTerm| begun.coefficient(it.joint, it.term);
            let terms = start.terms.into_iter().map(|it| JointTerm { coefficient: coefficient(it), ..it });
            let terms = terms.collect();
            let begun = Estimate { terms, ..begun };
            // The start is the optimum as far as rows are linear: no damping.
            let mut near = options.clone();
            near.solver.trust *= UNDAMPED;
            near.solver.decrement = near.solver.decrement.max(DECREMENT);
            let prior = self.prior(&session).with_terms(priors(&model, &sizes));
            let task = Task { options: &near, ..self.task(session, (&prior, weight * variance)) };
            let (found, noise) = fitted(&task, begun, (noise, calibration));
            let base_motion = |found: &Estimate| {
                let targets = delivered(&model.robot, data).base_from_target;
                gauge::base_motion(found, &model.robot, &targets, session.length_m)
            };
            (if session.base_free() { found.rebased(&base_motion(&found)) } else { found }, noise)
        };
        // Where rows are far from linear, terms may lead nowhere.
        if sizes != Sizes::NONE && !self.is_no_worse(&session, &estimate) {
            return self.end_without(model, possible, tried, SizesReason::LedNowhere);
        }
        if sizes != Sizes::NONE && reason != SizesReason::Given && self.is_worse_held_out(&session, &estimate)
        {
            return self.end_without(model, possible, tried, SizesReason::WorseHeldOut);
        }
        let every = unknowns(&model, of_geometry.unknowns, possible);
        let prior = self.prior(&session).with_terms(priors(&model, possible));
        let whole = self.task(Session { unknowns: &every, ..session }, (&prior, weight));
        let mut uncertainty = uncertainty(&whole, (&estimate, noise), (&prior, [weight, variance]), growth);
        if sizes != Sizes::NONE && uncertainty.is_none() {
            return self.end_without(model, possible, tried, SizesReason::LedNowhere);
        }
        let coverage = coverage(&session, rows);
        let left_out_m = self.left_out_m(&sizes, &tried);
        let expected = uncertainty.as_mut().map_or_else(Expectations::default, |uncertainty| {
            expectations_beside(&session, rows, &coverage, (uncertainty, left_out_m), options.seed)
        });
        let found = uncertainty.as_ref().filter(|_| sizes != Sizes::NONE).map(|uncertainty| {
            let deviations: Vec<f64> = model.deviations(possible).collect();
            let before = (&of_geometry, &calibration.models.calibrated);
            effects(&model, (&session, &estimate), before, rows, (uncertainty, &deviations), noise)
        });
        let estimate = located(&session, rows, &estimate, noise).into_owned();
        let training = session.errors(&calibration.fit_rows, &estimate);
        let judged = &calibration.held_out_rows;
        let held_out = session.errors(judged, &estimate);
        let targets: Vec<usize> = (0..data.targets.len()).collect();
        let promised = promised_rows(data, rows, judged);
        let kept = uncertainty.as_ref().filter(|_| !promised.is_empty()).map(|uncertainty| {
            let predicted = PredictedUncertainty { uncertainty, targets: &targets, coverage: &coverage };
            let some = sample_rows(&promised, JUDGED);
            predicted.check(&session, &estimate, &some, &session.errors(&some, &estimate))
        });
        let (robot, targets) = place_tip(&model.robot, data, &data.frames(rows), &estimate, options.move_tip);
        Correction {
            sizes,
            reason,
            tried,
            robot: Robot { terms: estimate.terms.clone(), ..robot },
            targets,
            stations: stations(&session, &estimate, noise),
            training: model_accuracy(&training),
            held_out: (!judged.is_empty()).then(|| model_accuracy(&held_out)),
            uncertainty,
            effects: found.unwrap_or_default(),
            expected,
            left_out_m,
            kept,
            noise,
            frame: calibration.frame,
            doubt: None,
            prior_weight: weight * variance,
            unknowns: fitted_unknowns,
            model,
            estimate,
            packed,
        }
    }

    /// Error of positions in cross-validation (metres, RMS): that of geometry alone times the share that terms leave on rows that are left out.
    fn left_out_m(&self, sizes: &Sizes, tried: &[TriedSizes]) -> Option<f64> {
        let of = |sizes: &Sizes| tried.iter().find(|it| it.sizes == *sizes).map(|it| it.left_out);
        let geometry_m =
            self.calibration.trust.cross_validation.as_ref()?.random.rms.get(Quantity::Position)?;
        let left = (0.5 * (of(sizes)? - of(&Sizes::NONE)?)).exp();
        Some(geometry_m * left).filter(|it| it.is_finite())
    }

    /// Geometry alone where terms lead nowhere.
    fn end_without(
        &self,
        model: CorrectionModel,
        possible: &Sizes,
        tried: Vec<TriedSizes>,
        reason: SizesReason,
    ) -> Correction {
        let none = self.begin(&model, Some(Sizes::NONE));
        self.end(model, possible, Begun { reason, tried, ..none })
    }
}

/// Measured numbers of each quantity.
fn numbers(task: &Task<'_>) -> ByQuantity<f64> {
    let mut counts: ByQuantity<f64> = ByQuantity::default();
    for &row in task.rows {
        let channels = task.session.observation(row).measurement.channels();
        channels.iter().for_each(|channel| counts[channel.quantity] += 1.0);
    }
    counts
}

/// The optimum with the noise estimated anew.
fn fitted(task: &Task<'_>, start: Estimate, (noise, of): (Noise, &Calibration)) -> (Estimate, Noise) {
    let (mut estimate, mut noise) = (start, noise);
    let counts = numbers(task);
    let all: f64 = counts.iter().map(|(_, count)| *count).sum();
    for _ in 0..ROUNDS {
        let found = OngoingFit::new(task.fit(estimate, noise));
        let known = task.effective_unknowns(&found);
        estimate = found.estimate;
        if of.noise_source != NoiseSource::Estimated {
            break;
        }
        let Some(better) = estimate_noise(&task.session, task.rows, &estimate, known, None, noise) else {
            break;
        };
        let better = ByQuantity::from_fn(|quantity| {
            let freedom = counts[quantity] * (1.0 - known / all).max(0.0);
            between(of.noise[quantity], better[quantity].powi(2) * freedom, freedom)
        });
        let better = stated(task.options, better);
        let change = better.iter().map(|(quantity, sigma)| (sigma / noise[quantity]).ln().abs());
        let is_settled = change.fold(0.0, f64::max) < SETTLED;
        noise = better;
        if is_settled {
            break;
        }
    }
    (estimate, noise)
}
