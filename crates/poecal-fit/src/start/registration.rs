//! Registration: device frame and targets are fitted, with fixed screws.

use crate::parameters::{ClockUnknown, DeviceFrame, Parameter, RangeUnknown, TargetFrame, TargetPlace};
use crate::problem::{Prior, Problem};
use crate::state::{ClockTerm, Estimate, RangeTerm, Session};
use poecal_arm::lie::Freedom;
use poecal_model::measurement::{Dataset, Noise};
use poecal_numerics::solve::{Options, minimize};

/// A registration problem: rows, noise and unknowns.
#[derive(Clone, Copy, Debug)]
pub struct Registration<'a> {
    /// Robot and measurements.
    pub session: Session<'a>,
    /// Rows to use.
    pub rows: &'a [u32],
    /// Noise of rows that state none.
    pub noise: Noise,
    /// True if the targets are unknown (otherwise they stay as in the start).
    pub targets_free: bool,
    /// Prior of the targets (theory.md §6 (27c)), and its weight: the variance of the whitened residuals.
    pub prior: Option<(&'a Prior, f64)>,
}

/// Registers again from a registration that was made with other noise.
#[must_use]
pub fn register_again(problem: &Registration<'_>, start: &Estimate) -> Estimate {
    polish(problem, start.clone(), problem.rows.to_vec(), 50).0
}

impl<'a> Registration<'a> {
    /// The same problem with the weight of the prior by the residuals of an estimate.
    #[must_use]
    pub fn weighed_by(self, estimate: &Estimate) -> Self {
        let Registration { session, rows, noise, .. } = self;
        let (mut squares, mut numbers) = (0.0, 0.0);
        for (row, error) in rows.iter().zip(session.errors(rows, estimate)) {
            let sigma = session.noise_of(session.observation(*row), noise);
            for (channel, value) in error.numbers() {
                squares += (value / sigma[channel.quantity]).powi(2);
                numbers += 1.0;
            }
        }
        let weight = if numbers > 0.0 && squares.is_finite() { squares / numbers } else { 1.0 };
        Registration { prior: self.prior.map(|(prior, _)| (prior, weight)), ..self }
    }

    pub(crate) fn least_squares(&self, rows: Vec<u32>, free: Vec<Parameter>) -> Problem<'a> {
        Problem::new(self.session, rows, free, self.noise).with_prior(self.prior)
    }
}

/// Least squares from a start to the optimum, theory.md §6 (27); returns the cost with it.
pub(crate) fn polish(
    problem: &Registration<'_>,
    start: Estimate,
    rows: Vec<u32>,
    iterations: usize,
) -> (Estimate, f64) {
    let free = free_parameters(problem, &rows);
    let least_squares = problem.least_squares(rows, free);
    let options = Options { iterations, trust: 10.0, ..Options::default() };
    let (estimate, normal, _) = minimize(&least_squares, start, &options);
    (estimate, normal.cost)
}

/// Unknowns of a registration by these rows.
pub fn free_parameters(problem: &Registration<'_>, rows: &[u32]) -> Vec<Parameter> {
    let mut free = Vec::new();
    if problem.session.device_free {
        let data = problem.session.data;
        let unknowns = problem.session.unknowns;
        let is_seen = |station: usize| data.station_count() == 1 || !data.seen_from(station, rows).is_empty();
        let is_free = |station: &usize| unknowns.moves_frame(*station) && is_seen(*station);
        let stations = (0..data.station_count()).filter(is_free);
        let stations = stations.map(|station| device_parameter(data, station, rows));
        free.extend(stations);
        free.extend(range_parameters(&problem.session, rows).map(Parameter::RangeUnknown));
        free.extend(clock_parameters(&problem.session, rows).map(Parameter::ClockUnknown));
    }
    if problem.targets_free {
        free.extend(target_parameters(&problem.session, problem.rows));
    }
    free
}

/// Free parameter of a station's frame: stepped about the middle of its rows; its position alone if no row determines its axes.
pub fn device_parameter(data: &Dataset, station: usize, rows: &[u32]) -> Parameter {
    let own = data.seen_from(station, rows);
    let freedom = data.device_freedom(station, &own);
    Parameter::DeviceFrame(if freedom == Freedom::FRAME {
        DeviceFrame::new(station, data.mean_position(&own))
    } else {
        DeviceFrame::from_freedom(station, freedom)
    })
}

/// Unknown zeros and scales of distances in these rows: those that the rows state as unknown, and those that the session names.
pub fn range_parameters(session: &Session<'_>, rows: &[u32]) -> impl Iterator<Item = RangeUnknown> {
    let (data, unknowns) = (session.data, session.unknowns);
    let is_seen = move |station: usize| data.zero_is_unknown(station, rows);
    let named = |station: usize, term: RangeTerm| unknowns.ranges.contains(&(station, term));
    (0..data.station_count()).flat_map(move |station| {
        let zero = is_seen(station) || named(station, RangeTerm::Zero);
        let terms = [(zero, RangeTerm::Zero), (named(station, RangeTerm::Scale), RangeTerm::Scale)];
        let terms = terms.into_iter().filter(|(is_unknown, _)| *is_unknown);
        terms.map(move |(_, term)| RangeUnknown { station, term })
    })
}

/// Unknown lags and drifts of clocks in these rows: of instruments that measured some of them in motion, except those that are held.
pub fn clock_parameters(session: &Session<'_>, rows: &[u32]) -> impl Iterator<Item = ClockUnknown> {
    let (data, unknowns) = (session.data, session.unknowns);
    let is_seen = |station: usize| {
        let mut own = rows.iter().filter_map(|&row| data.observations.get(row as usize));
        data.moving.clock(station).is_some() && own.any(|it| it.station == station && it.moving.is_some())
    };
    let stations: Vec<usize> = (0..data.station_count()).filter(|&station| is_seen(station)).collect();
    stations.into_iter().flat_map(move |station| {
        let terms = ClockTerm::ALL.into_iter().filter(move |&term| !unknowns.held_clocks.contains(&(station, term)));
        terms.map(move |term| ClockUnknown { station, term })
    })
}

/// Free parameters of the targets: frames if these rows measured orientation, positions otherwise.
pub fn target_parameters(session: &Session<'_>, rows: &[u32]) -> impl Iterator<Item = Parameter> {
    let unknowns = session.unknowns;
    let data = session.data;
    let mut freedoms = data.target_freedoms(rows);
    // If all planes are unknown, the height of a face is one with theirs (theory.md §4 (15c)).
    let is_known = |&row: &u32| {
        let seen = session.observation(row);
        seen.measurement.face_normal().is_some() && (!session.device_free || !unknowns.moves_frame(seen.station))
    };
    let has_height = |freedom: &Freedom| freedom.without_height() != *freedom;
    if freedoms.iter().any(has_height) && !rows.iter().any(is_known) {
        freedoms.iter_mut().for_each(|freedom| *freedom = freedom.without_height());
    }
    let targets = freedoms.into_iter().enumerate();
    let targets = targets.filter(|&(target, _)| unknowns.moves_target(target));
    targets.map(|(target, freedom)| target_parameter(target, freedom))
}

/// Parameter of a target with these observable motions.
fn target_parameter(target: usize, freedom: Freedom) -> Parameter {
    if freedom == Freedom::PLACE {
        Parameter::TargetPlace(TargetPlace { target })
    } else {
        Parameter::TargetFrame(TargetFrame { target, freedom })
    }
}
