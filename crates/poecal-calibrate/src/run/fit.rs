//! The fit of the screws: its unknowns, and one minimisation.

use super::station_frames::stations_to_locate;
use crate::{CalibrationOptions, Formulation};
use poecal_fit::parameters::{Parameter, ParameterSubject, ValueTerm, screw_axes};
use poecal_fit::problem::{Layout, Prior, Problem};
use poecal_fit::start::{clock_parameters, device_parameter, range_parameters, target_parameters};
use poecal_fit::state::{Estimate, Session, sample_rows};
use poecal_model::measurement::Noise;
use poecal_numerics::solve::{LeastSquares as _, NormalEquations, Options, Summary};

/// A fit of many rows begins on a subsample with at least this number of rows, for each unknown, and times the root of the number of rows. After
/// that, one step with the first `JᵀJ` of all rows nearly suffices, for any number of rows.
const SAMPLE: usize = 512;
const SAMPLE_PER_UNKNOWN: usize = 10;
const SAMPLE_PER_ROOT: usize = 7;
/// Least ratio of all rows to the subsample for which a fit begins on one.
const MANY: usize = 3;
/// The fit of the subsample stops within a tenth of a standard deviation.
const SAMPLE_DECREMENT: f64 = 1e-2;
/// Root mean square position error, as a share of the arm's reach, above which a fit may have converged to a local minimum: real robots,
/// with elastic gears and links, have a tenth of it, local minima several times as much.
pub(crate) const SUSPICIOUS: f64 = 3e-3;

/// Free parameters of a fit: screws, terms, targets, and device frames; not the first one if the base frame is a choice.
pub fn free_parameters(
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
        unknowns.moves_frame(*station) && estimate.tree.shared_target(*station).is_none() && !absent.contains(station)
    };
    let frames = stations.filter(is_free).map(|station| device_parameter(data, station, rows));
    let is_free = |parameter: &Parameter| match parameter.model().subject() {
        ParameterSubject::Joint(joint) => unknowns.moves_axis(joint),
        ParameterSubject::Instrument(_)
        | ParameterSubject::Target(_)
        | ParameterSubject::Range(_)
        | ParameterSubject::Clock(_) => true,
    };
    let ranges = range_parameters(session, rows).filter(|it| !absent.contains(&it.station));
    let ranges = ranges.map(Parameter::RangeUnknown);
    let clocks = clock_parameters(session, rows).map(Parameter::ClockUnknown);
    let terms = unknowns.terms.iter().filter_map(|&(joint, term)| {
        let kind = *estimate.kinds().get(joint)?;
        Some(Parameter::ValueTerm(ValueTerm { joint, kind, term }))
    });
    frames
        .chain(joints.into_iter().filter(is_free))
        .chain(terms)
        .chain(target_parameters(session, rows))
        .chain(ranges)
        .chain(clocks)
        .collect()
}

/// One fit of all screws and targets from a start, the first device frame fixed, with the formulation and solver of the options; of many
/// rows first on a subsample. The prior has a weight ([`Problem::with_prior`]). The returned `JᵀJ` may be frozen
/// ([`poecal_numerics::solve::minimize`]). Cost: theory.md §6 (27), (27a).
pub fn fit_screws(
    session: Session<'_>,
    rows: &[u32],
    start: Estimate,
    noise: Noise,
    prior: Option<(&Prior, f64)>,
    options: &CalibrationOptions,
) -> (Estimate, NormalEquations, Summary) {
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
pub(crate) fn minimal_layout(
    session: Session<'_>,
    rows: &[u32],
    estimate: &Estimate,
    noise: Noise,
) -> (Layout, NormalEquations) {
    let free = free_parameters(&session, estimate, rows, screw_axes(estimate.kinds()));
    let problem = Problem::new(session, rows.to_vec(), free, noise);
    (problem.layout().clone(), problem.normal(estimate))
}

/// True if a position error is larger than elastic gears and links of a robot of this size explain.
pub(crate) fn is_suspicious(rms_m: f64, length_m: f64) -> bool {
    rms_m >= SUSPICIOUS * 3.0 * length_m
}
