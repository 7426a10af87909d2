//! The fit of the screws: from registration to the optimum, with noise and prior weight re-estimated, and further starts if needed.

use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::found::{Fitted, OngoingFit, SolverReport};
use super::located::stations_to_locate;
use super::noise::stated;
use super::{CalibrationOptions, Formulation, Minimum, NoiseSource, delivered, estimate_noise};
use crate::analysis::effective_unknowns;
use crate::distributions::is_within_band;
use crate::error::{Error, ErrorKind, Result};
use crate::estimate::{Estimate, Session, rms_m, sample_rows};
use crate::gauge;
use crate::measurement::{Noise, Quantity};
use crate::parameters::{Parameter, Subject, ValueTerm, screw_axes};
use crate::problem::{Layout, Prior, Problem};
use crate::simulate::random;
use crate::solve::{LeastSquares, Normal, Options, Summary};
use crate::start::{device_parameter, range_parameters, target_parameters};

/// A fit of many rows begins on a subsample: at least so many rows, for each unknown, and times the root of the number of rows. After that,
/// one step with the first `JᵀJ` of all rows is about enough, however many they are.
const SAMPLE: usize = 512;
const SAMPLE_PER_UNKNOWN: usize = 10;
const SAMPLE_PER_ROOT: usize = 7;
/// Ratio of all rows to those of the subsample above which a fit begins on one.
const MANY: usize = 3;
/// The fit of the subsample stops within a tenth of a standard deviation.
const SAMPLE_DECREMENT: f64 = 1e-2;
/// Rows on which further starts are compared.
const RESTART_SAMPLE: usize = 200;
/// Root mean square position error, as a share of the arm's reach, above which a fit may have converged to a local minimum: real robots,
/// with elastic gears and links, have a tenth of it, local minima several times as much.
const SUSPICIOUS: f64 = 3e-3;

/// Most rounds of re-estimating noise and the weight of the prior. Two or three are enough, but for data without noise: there each reduces
/// the remaining pull of the prior.
const RENEWALS: usize = 12;

/// Free parameters of a fit: screws, terms, targets, and device frames; not the first one if the base frame is a choice.
pub(super) fn free_parameters(
    session: &Session<'_>,
    estimate: &Estimate,
    rows: &[u32],
    joints: Vec<Parameter>,
) -> Vec<Parameter> {
    let Session { data, unknowns, .. } = session;
    let held = session.held_station(rows);
    let stations = (0..=estimate.further_devices.len()).filter(|&station| Some(station) != held);
    let absent = stations_to_locate(data, rows);
    let is_free = |station: &usize| {
        unknowns.moves_frame(*station)
            && estimate.tree.shared(*station).is_none()
            && !absent.contains(station)
    };
    let frames = stations.filter(is_free).map(|station| device_parameter(data, station, rows));
    let is_free = |parameter: &Parameter| match parameter.model().subject() {
        Subject::Joint(joint) => unknowns.moves_axis(joint),
        Subject::Instrument(_) | Subject::Target(_) | Subject::Range(_) => true,
    };
    let ranges = range_parameters(session, rows).filter(|it| !absent.contains(&it.station));
    let ranges = ranges.map(Parameter::RangeUnknown);
    let terms = unknowns.terms.iter().filter_map(|&(joint, term)| {
        let kind = *estimate.kinds().get(joint)?;
        Some(Parameter::ValueTerm(ValueTerm { joint, kind, term }))
    });
    frames
        .chain(joints.into_iter().filter(is_free))
        .chain(terms)
        .chain(target_parameters(session, rows))
        .chain(ranges)
        .collect()
}

/// One fit of all screws and targets from a start, the first device frame fixed, with the formulation and solver of the options; of many
/// rows first on a subsample. The prior has a weight ([`Problem::with_prior`]). The returned `JᵀJ` may be frozen
/// ([`crate::solve::minimize`]). Cost: theory.md §6 (27), (27a).
pub fn fit_screws(
    session: Session<'_>,
    rows: &[u32],
    start: Estimate,
    noise: Noise,
    prior: Option<(&Prior, f64)>,
    options: &CalibrationOptions,
) -> (Estimate, Normal, Summary) {
    let Formulation { joint_parameters, minimize, .. } = options.formulation;
    let free = free_parameters(&session, &start, rows, joint_parameters(start.kinds()));
    let problem = |rows: Vec<u32>| Problem::new(session, rows, free.clone(), noise).with_prior(prior);
    let mut start = start;
    let (mut solver, mut before) = (options.solver, None);
    let unknowns: usize = free.iter().map(|parameter| parameter.model().columns().len()).sum();
    let enough = SAMPLE.max(SAMPLE_PER_UNKNOWN * unknowns).max(SAMPLE_PER_ROOT * rows.len().isqrt());
    if rows.len() > MANY * enough {
        let sample = sample_rows(rows, enough);
        let decrement = SAMPLE_DECREMENT.max(options.solver.decrement);
        let near = Options { decrement, ..options.solver };
        let (estimate, _, summary) = minimize(&problem(sample), start, &near);
        start = estimate;
        before = Some(summary);
        // The optimum of a subsample is close to that of all rows: almost no damping.
        solver.trust *= 1e3;
    }
    let (estimate, normal, mut summary) = minimize(&problem(rows.to_vec()), start, &solver);
    if let Some(before) = before {
        summary.iterations += before.iterations;
        summary.trace.splice(0..0, before.trace);
    }
    (estimate, normal, summary)
}

/// Layout and normal information of an estimate in the minimal basis.
pub(super) fn minimal(
    session: Session<'_>,
    rows: &[u32],
    estimate: &Estimate,
    noise: Noise,
) -> (Layout, Normal) {
    let free = free_parameters(&session, estimate, rows, screw_axes(estimate.kinds()));
    let problem = Problem::new(session, rows.to_vec(), free, noise);
    (problem.layout().clone(), problem.normal(estimate))
}

/// Predicted reduction of a full step.
fn predicted_reduction(normal: &Normal) -> f64 {
    normal.full_step().map_or(0.0, |step| normal.predicted_reduction(&step))
}

/// Whether a position error is larger than elastic gears and links of a robot of this size explain.
pub(super) fn is_suspicious(rms_m: f64, length_m: f64) -> bool {
    rms_m >= SUSPICIOUS * 3.0 * length_m
}

/// A fit: session, rows, weights, prior, options.
#[derive(Clone, Copy)]
pub(super) struct Task<'a> {
    pub(super) session: Session<'a>,
    pub(super) rows: &'a [u32],
    /// Weights of all rows of the data; `None` if all are 1.
    pub(super) weights: Option<&'a [f64]>,
    /// Prior, and its weight: the variance of the whitened residuals.
    pub(super) prior: Option<(&'a Prior, f64)>,
    pub(super) options: &'a CalibrationOptions,
}

impl Task<'_> {
    /// The same with another weight of the prior.
    pub(super) fn with_prior_weight(&self, weight: f64) -> Self {
        Task { prior: self.prior.map(|(prior, _)| (prior, weight)), ..*self }
    }

    /// A weight of the prior, at least 1 where nothing has a length: noise would have the robot shrink.
    pub(super) fn counted(&self, weight: f64) -> f64 {
        if self.session.lacks_length(self.rows) { weight.max(1.0) } else { weight }
    }

    /// The prior's weight in the first fit. An estimated noise is then mostly error of the screws, so the prior counts as beside the usual
    /// error of gears and links.
    pub(super) fn with_first_prior_weight(&self, noise: Noise, source: NoiseSource) -> Self {
        let usual = 0.1 * SUSPICIOUS * 3.0 * self.session.length_m / noise.of_lengths();
        let is_open = source == NoiseSource::Estimated;
        self.with_prior_weight(self.counted(if is_open { (usual * usual).min(1.0) } else { 1.0 }))
    }

    /// The first fit from a registration.
    pub(super) fn first_fit(&self, registered: &Estimate, noise: Noise) -> OngoingFit {
        let mut start = registered.clone();
        start.recentre(&self.session, self.rows);
        OngoingFit::new(self.fit(start, noise))
    }

    /// Effective number of unknowns determined by the measurements rather than the prior: theory.md §6 (34).
    pub(super) fn effective_unknowns(&self, found: &OngoingFit) -> f64 {
        let unknowns = found.normal.dim();
        let Some((prior, weight)) = self.prior else { return unknowns as f64 };
        let layout = self.problem(&found.estimate, Noise::new(1.0, 1.0));
        let mut believed = Normal::new(unknowns);
        prior.add(&found.estimate, layout.layout(), weight, &mut believed);
        unknowns as f64 - effective_unknowns(&found.normal, &believed)
    }

    /// Mean squared whitened residual, without the prior's part of the cost.
    fn mean_square(&self, found: &OngoingFit) -> f64 {
        let believed = self.prior.map_or(0.0, |(prior, weight)| weight * prior.cost(&found.estimate));
        2.0 * (found.normal.cost - believed).max(0.0) / found.normal.residuals.max(1) as f64
    }

    /// Completes a first fit: further starts if needed, then rounds with noise and prior weight re-estimated (noise only if its source is
    /// the residuals).
    pub(super) fn complete(
        &self,
        mut found: OngoingFit,
        registered: &Estimate,
        noise: Noise,
        source: NoiseSource,
    ) -> Result<Fitted> {
        if let Some((better, tried)) = self.restart(registered, &found.estimate, noise) {
            found.report.restarts = tried;
            if let Some(better) = better {
                found.update(self.fit(better, noise));
            }
        }
        let (mut task, mut noise, mut source) = (*self, noise, source);
        for _ in 0..RENEWALS {
            let unknowns = task.effective_unknowns(&found);
            let before = noise;
            let mut weight = 1.0;
            if source == NoiseSource::Estimated {
                let by_rotations = task.determined_by_rotations(&found, noise);
                let (session, rows) = (&self.session, self.rows);
                match estimate_noise(session, rows, &found.estimate, unknowns, by_rotations, noise) {
                    Some(estimated) => noise = stated(self.options, estimated),
                    None => source = NoiseSource::Exact,
                }
            }
            let mean_square = task.mean_square(&found);
            if source != NoiseSource::Estimated {
                // Stated noise scales the prior as long as it explains the residuals.
                let freedom = (found.normal.residuals as f64 - unknowns).max(1.0);
                let variance = mean_square * found.normal.residuals as f64 / freedom;
                let explains = source != NoiseSource::Exact && is_within_band(variance, freedom).is_eq();
                weight = if explains { 1.0 } else { variance };
            }
            // The axes' deviations estimate how good the nominal model is.
            weight /= task.prior.map_or(1.0, |(prior, _)| prior.looseness(&found.estimate));
            if source != NoiseSource::Exact {
                weight = self.counted(weight);
            }
            // Change of the ratios of noises: of the largest to the smallest change of any of them.
            let is_used = |quantity: Quantity| self.session.data.has(quantity) || quantity.is_of_pose();
            let used = || noise.iter().filter(|(quantity, _)| is_used(*quantity));
            let logs = || used().map(|(quantity, sigma)| (sigma / before[quantity]).ln());
            let change = logs().fold(f64::NEG_INFINITY, f64::max) - logs().fold(f64::INFINITY, f64::min);
            let weighed = task.prior.is_none_or(|(_, counted)| (weight / counted).ln().abs() < 0.5);
            let fits = source != NoiseSource::Estimated
                || noise == before
                || change.abs() < 0.02 && mean_square.ln().abs() < 0.5;
            task = task.with_prior_weight(weight);
            if fits && (weighed || !(weight.is_finite() && weight > 0.0)) {
                break;
            }
            let estimate = found.estimate.clone();
            found.update(task.fit(estimate, noise));
        }
        task.finish(found, noise, source)
    }

    /// Effective number of unknowns determined by the rotation residuals, `tr(N⁻¹ N_R)`: theory.md §6 (34). Only for few rows, where it
    /// matters.
    pub(super) fn determined_by_rotations(&self, found: &OngoingFit, noise: Noise) -> Option<f64> {
        const FEW: usize = 300;
        // With positions practically unmeasured, the information of rotations remains.
        const UNMEASURED_M: f64 = 1e9;
        let turns = |row: &u32| self.session.observation(*row).measurement.sees_orientation();
        if self.rows.len() > FEW || !self.rows.iter().any(turns) {
            return None;
        }
        let rotations = noise.without_lengths(UNMEASURED_M);
        let seen = Task { prior: None, ..*self };
        let part = seen.problem(&found.estimate, rotations).normal(&found.estimate);
        Some(effective_unknowns(&found.normal, &part))
    }

    /// The result of a fit at its optimum, with its information in the minimal basis where possible.
    pub(super) fn finish(&self, found: OngoingFit, noise: Noise, source: NoiseSource) -> Result<Fitted> {
        let mut found = found;
        let mut normal = self.problem(&found.estimate, noise).normal(&found.estimate);
        // The last change of the noise moved the optimum.
        if predicted_reduction(&normal) > self.options.solver.decrement * normal.mean_square() {
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
            normal = Task { prior: None, ..*self }.problem(&estimate, noise).normal(&estimate);
        } else if self.problem(&estimate, noise).layout().is_minimal() {
            (estimate, normal) = self.settle_null_directions(estimate, normal, noise, &mut report);
        }
        let layout = self.problem(&estimate, noise).layout().clone();
        let offsets = |(parameter, _): (&Parameter, _)| matches!(parameter, Parameter::ValueTerm(_));
        // Terms that were asked for are the robot's.
        let is_of_formulation = self.options.formulation != Formulation::default();
        report.joint_offsets =
            (is_of_formulation && layout.parameters().any(offsets)).then(|| estimate.offsets());
        Ok(Fitted { estimate, normal, layout, noise, noise_source: source, report })
    }

    /// One fit. With weights it begins near the optimum, and on all rows.
    pub(super) fn fit(&self, start: Estimate, noise: Noise) -> (Estimate, Normal, Summary) {
        if self.weights.is_some() {
            return self.minimize(&self.problem(&start, noise), start, &self.options.solver);
        }
        fit_screws(self.session, self.rows, start, noise, self.prior, self.options)
    }

    /// Minimises with the formulation of the options.
    fn minimize(&self, problem: &Problem<'_>, start: Estimate, options: &Options) -> Minimum {
        (self.options.formulation.minimize)(problem, start, options)
    }

    /// The free parameters.
    pub(super) fn free(&self, estimate: &Estimate) -> Vec<Parameter> {
        let joints = (self.options.formulation.joint_parameters)(estimate.kinds());
        free_parameters(&self.session, estimate, self.rows, joints)
    }

    /// The problem of these rows and weights.
    pub(super) fn problem(&self, estimate: &Estimate, noise: Noise) -> Problem<'_> {
        let free = self.free(estimate);
        let problem = Problem::new(self.session, self.rows.to_vec(), free, noise).with_prior(self.prior);
        match self.weights {
            Some(weights) => problem.with_weights(weights),
            None => problem,
        }
    }

    /// [`is_suspicious`] for this robot.
    pub(super) fn is_suspicious(&self, rms_m: f64) -> bool {
        is_suspicious(rms_m, self.session.length_m)
    }

    /// Further starts if the error suggests a local minimum: random screws around the registered ones, on a subsample. Returns a clearly
    /// better start, if one was found, and the number of starts.
    fn restart(
        &self,
        registered: &Estimate,
        fitted: &Estimate,
        noise: Noise,
    ) -> Option<(Option<Estimate>, usize)> {
        let sample = sample_rows(self.rows, RESTART_SAMPLE);
        let problem = |estimate: &Estimate| {
            Problem::new(self.session, sample.clone(), self.free(estimate), noise).with_prior(self.prior)
        };
        if self.options.restarts == 0 || !self.is_suspicious(self.position_rms(fitted)) {
            return None;
        }
        let after = problem(fitted).normal(fitted).cost;
        let options = Options { iterations: 40, decrement: 1e-3, ..self.options.solver };
        let mut generator = ChaCha8Rng::seed_from_u64(self.options.seed ^ 0x5eed);
        let mut best: (f64, Option<Estimate>) = (0.8 * after, None);
        let mut tried = 0;
        while tried < self.options.restarts {
            tried += 1;
            let scale = [0.05, 0.1, 0.2, 0.4][tried % 4];
            let start = self.scattered(registered, scale, &mut generator);
            let (found, normal, _) = self.minimize(&problem(&start), start, &options);
            if normal.cost < best.0 {
                best.0 = 0.999 * normal.cost;
                if !self.is_suspicious(self.position_rms(&found)) {
                    best.1 = Some(found);
                    break;
                }
                best.1 = Some(found);
            }
        }
        Some((best.1, tried))
    }

    /// Root mean square distance from prediction to measurement, metres.
    fn position_rms(&self, estimate: &Estimate) -> f64 {
        rms_m(&self.session.errors(self.rows, estimate))
    }

    /// The estimate with every axis tilted by about `scale` radians and shifted by as much of the arm's length.
    fn scattered(&self, estimate: &Estimate, scale: f64, generator: &mut ChaCha8Rng) -> Estimate {
        let layout = self.problem(estimate, Noise::new(1.0, 1.0)).layout().clone();
        let step: Vec<f64> =
            (0..layout.dim()).map(|_| scale * self.session.length_m * random::normal(generator)).collect();
        layout.retract(estimate, &step)
    }

    /// Moves along exactly null directions to the screws nearest to nominal; the fit is renewed after each move. An unknown device
    /// frame lets the base follow, which changes no prediction.
    fn settle_null_directions(
        &self,
        estimate: Estimate,
        normal: Normal,
        noise: Noise,
        report: &mut SolverReport,
    ) -> (Estimate, Normal) {
        let (mut estimate, mut normal) = (estimate, normal);
        let Session { robot, data, length_m, .. } = self.session;
        let base_free = self.session.base_free();
        let targets = delivered(robot, data).base_from_target;
        for _ in 0..8 {
            if base_free {
                let motion = gauge::base_motion(&estimate, robot, &targets, length_m);
                estimate = estimate.rebased(&motion);
            }
            let problem = self.problem(&estimate, noise);
            let layout = problem.layout();
            let Some(step) = gauge::null_step(&estimate, robot, layout, &normal.gram, length_m, base_free)
            else {
                break;
            };
            let length = step.iter().map(|s| s * s).sum::<f64>().sqrt();
            let (moved, _, summary) =
                self.minimize(&problem, problem.retract(&estimate, &step), &self.options.solver);
            let moved_normal = problem.normal(&moved);
            if length < 1e-10 || moved_normal.cost > normal.cost * (1.0 + 1e-6) + 1e-12 {
                break;
            }
            (estimate, normal) = (moved, moved_normal);
            report.iterations += summary.iterations;
            report.termination = summary.termination;
        }
        (estimate, normal)
    }
}
