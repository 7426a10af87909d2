//! Measurements of a robot in motion, and joint readings by another clock: the lag and the drift at which they fit.

use nalgebra::Vector3;

use super::jitter::jitter;
use super::joint_stream::JointStream;
use super::speeds::{self, MotionTrack};
use super::{EVIDENT, NOISE, size};
use crate::parameters::{ClockUnknown, Parameter, screw_axes};
use crate::problem::{Prior, Problem};
use crate::start::registration::{Registration, register_again};
use crate::start::stations::register_roughly;
use crate::start::target_parameters;
use crate::state::{ClockTerm, Estimate, PackedValues, RowError, Session, Unknowns, nominal_estimate, sample_rows};
use poecal_model::measurement::{Clock, Dataset, MovingRows, Observation, Quantity};
use poecal_model::robot::{Robot, Tolerance};
use poecal_numerics::distributions::median;
use poecal_numerics::error::{ErrorKind, Result, first_few};
use poecal_numerics::solve::{Options, minimize};

/// Shortest time between two rows that are fitted, seconds: closer rows add hardly any information.
const STEP_S: f64 = 0.1;
/// Largest error of stamps of rows at equal steps, seconds.
const STAMP_S: f64 = 2e-3;
/// Largest number of rows of a fit.
const MOST: usize = 3000;
/// Number of rows that compare lags.
const SOME: usize = 150;
/// Number of lags that are refined, and the shortest distance of two, seconds.
const CANDIDATES: usize = 10;
const APART_S: f64 = 0.15;
/// Change of the lag below which it has converged, seconds, and largest number of rounds until then.
const FOUND_S: f64 = 1e-5;
const ROUNDS: usize = 8;
/// Largest number of rounds of a lag that is compared with others.
const ROUNDS_OF_EACH: usize = 4;
/// Shortest overlap of two streams, seconds, and its share of the shorter one.
const OVERLAP_S: f64 = 5.0;
const OVERLAP: f64 = 0.25;
/// Fewest rows.
const FEWEST: usize = 30;
/// Length of a recording, seconds, from which on it is compared with itself at fixed wrong lags; those of a shorter one are proportionally
/// less.
const LONG_S: f64 = 30.0;

/// Measurements in motion with a lag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaggedMeasurements {
    /// Time of the measurements less that of the joint readings, seconds.
    pub lag_s: f64,
    /// Median error of the nominal robot, metres.
    pub missed_m: f64,
}

/// Measurements in motion with the readings that belong to them.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionMeasurements {
    /// Clock of the instrument.
    pub clock: Clock,
    /// Rows of the measurements that have readings, with these, their rates and their times from the middle.
    pub rows: Vec<MovingRow>,
    /// Median error of the nominal robot, metres.
    pub missed_m: f64,
    /// Median error of the robot whose axes are fitted too, metres.
    pub fitted_m: f64,
    /// Standard deviation of single stamps by the errors along the motion, seconds; 0 if there is none.
    pub jitter_s: f64,
}

/// A row that was measured in motion.
#[derive(Clone, Debug, PartialEq)]
pub struct MovingRow {
    /// Row of the measurements.
    pub row: u32,
    /// Readings at that time (rad, m).
    pub readings: Vec<f64>,
    /// Rates of these (rad/s, m/s).
    pub rates: Vec<f64>,
    /// Time from the middle of all, by the clock of the instrument, seconds.
    pub time_s: f64,
}

/// Result of a search without a unique lag.
#[derive(Clone, Debug, PartialEq)]
pub enum LagFailure {
    /// The streams hardly overlap, or nothing moves.
    NoMotion,
    /// Several lags fit equally well, the best first.
    Alike(Vec<LaggedMeasurements>),
    /// No lag fits better than by chance.
    None(LaggedMeasurements),
}

/// Measurements in time beside joint readings in time.
#[derive(Clone, Debug)]
pub struct MotionRecording<'a> {
    robot: &'a Robot,
    joints: &'a JointStream,
    data: &'a Dataset,
    /// Times of the measurements, seconds.
    times: &'a [f64],
}

/// Clock of a search, with the middle of the measurements.
#[derive(Clone, Copy)]
struct ClockGuess {
    lag_s: f64,
    drift: f64,
    middle_s: f64,
}

impl ClockGuess {
    /// Time of the joint readings at a time of the instrument.
    fn joint_time(&self, time_s: f64) -> f64 {
        time_s - self.lag_s - self.drift * (time_s - self.middle_s)
    }
}

impl<'a> MotionRecording<'a> {
    /// Search for measurements that have a time each.
    ///
    /// # Errors
    /// [`ErrorKind::Measurement`] for rows without a position, or without times, and for several instruments.
    pub fn new(robot: &'a Robot, joints: &'a JointStream, data: &'a Dataset, times: &'a [f64]) -> Result<Self> {
        if data.observations.iter().any(|it| it.measurement.position().is_none()) {
            return ErrorKind::Measurement
                .refuse("found measurements without a place, expected points or poses of a robot in motion");
        }
        if data.station_count() > 1 {
            let names: Vec<&str> = data.stations.iter().flatten().map(String::as_str).collect();
            return ErrorKind::Measurement.refuse(format!(
                "found the instruments {} in one recording, expected one, whose clock is an unknown of the fit: write the rows of each into a file of its own",
                first_few(&names)
            ));
        }
        if times.len() != data.len() || times.iter().any(|it| !it.is_finite()) {
            return ErrorKind::Measurement
                .refuse("found measurements without a time, expected a column `time` in both files");
        }
        Ok(MotionRecording { robot, joints, data, times })
    }

    /// Lag and drift at which the measurements fit, near a stated lag (with its largest error, seconds) if there is one.
    ///
    /// # Errors
    /// [`LagFailure`].
    pub fn find_lag(&self, stated: Option<(f64, f64)>) -> std::result::Result<MotionMeasurements, LagFailure> {
        let lags = self.by_speed(stated);
        let middle_s = self.middle();
        let mut refined: Vec<LaggedMeasurements> = Vec::new();
        for lag in lags {
            let Some(found) = self.refine_lag(ClockGuess { lag_s: lag, drift: 0.0, middle_s }) else {
                continue;
            };
            if stated.is_none_or(|(at, off)| (found.lag_s - at).abs() <= off)
                && !refined.iter().any(|it| (it.lag_s - found.lag_s).abs() < APART_S)
            {
                refined.push(found);
            }
        }
        refined.sort_by(|a, b| a.missed_m.total_cmp(&b.missed_m));
        let Some(&best) = refined.first() else { return Err(LagFailure::NoMotion) };
        if self.is_chance(best, middle_s) {
            return Err(LagFailure::None(best));
        }
        refined.retain(|it| it.missed_m < EVIDENT * best.missed_m);
        if refined.len() > 1 {
            return Err(LagFailure::Alike(refined));
        }
        self.with_geometry(ClockGuess { lag_s: best.lag_s, drift: 0.0, middle_s }, best.missed_m)
            .ok_or(LagFailure::None(best))
    }

    /// First of the times, seconds.
    fn first_time_s(&self) -> f64 {
        self.times.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Middle of the times, seconds.
    fn middle(&self) -> f64 {
        0.5 * (self.first_time_s() + self.times.iter().copied().fold(f64::NEG_INFINITY, f64::max))
    }

    /// Rows as if they were measured at rest at a lag, some of all.
    #[must_use]
    pub fn at_rest(&self, lag_s: f64) -> Option<Dataset> {
        let (mut data, _) = self.session(&ClockGuess { lag_s, drift: 0.0, middle_s: self.middle() }, SOME)?;
        data.observations.iter_mut().for_each(|it| it.moving = None);
        data.moving = MovingRows::default();
        Some(data)
    }

    /// True if lags that are certainly wrong fit nearly as well, or cannot be compared.
    fn is_chance(&self, best: LaggedMeasurements, middle_s: f64) -> bool {
        let span = |first: Option<&f64>, last: Option<&f64>| first.zip(last).map_or(0.0, |it| it.1 - it.0);
        let own = self.joints.times();
        let shorter = span(own.first(), own.last()).min(2.0 * (middle_s - self.first_time_s()));
        // For a short recording the wrong lags are smaller, so that a part overlaps.
        let scale = (shorter / LONG_S).min(1.0);
        let others = [-7.3, 5.9, -2.1, 3.4, -13.7, 11.2].map(|by| best.lag_s + scale * by);
        let missed = others
            .iter()
            .filter_map(|&lag_s| Some(self.register_at(&ClockGuess { lag_s, drift: 0.0, middle_s }, SOME)?.1));
        median(missed).is_none_or(|usual| best.missed_m * EVIDENT > usual)
    }

    /// Rows that are fitted, at most `most`, at this clock, with the readings at their times.
    fn session(&self, guess: &ClockGuess, most: usize) -> Option<(Dataset, Vec<u32>)> {
        let width = self.data.reading_names().len();
        let mut data = Dataset::new(self.data.reading_names().to_vec()).with_factors(self.robot.factors.len());
        (data.targets, data.stations) = (self.data.targets.clone(), self.data.stations.clone());
        let ClockGuess { lag_s, drift, middle_s } = *guess;
        let stations = 0..data.station_count();
        data.moving.clocks = stations.map(|station| Clock { station, lag_s, drift, middle_s }).collect();
        let (mut readings, mut rates) = (vec![0.0; width], vec![0.0; width]);
        let mut own = Vec::new();
        for row in sample_rows(&self.spread(), most) {
            let (observation, time) = (self.data.observations.get(row as usize)?, *self.times.get(row as usize)?);
            if !self.joints.interpolate(guess.joint_time(time), &mut readings, &mut rates) {
                continue;
            }
            let plain = Observation { noise_shape: None, ..*observation };
            data.push_observation(&readings, plain).ok()?;
            data.state_motion(data.len() - 1, &rates, time - middle_s);
            own.push(row);
        }
        (data.len() >= FEWEST.min(most)).then_some((data, own))
    }

    /// Rows with a least distance in time, each time with all its targets.
    fn spread(&self) -> Vec<u32> {
        let mut rows: Vec<u32> = Vec::new();
        let mut last = f64::NEG_INFINITY;
        for (row, &time) in (0..).zip(self.times) {
            if time == last || time - last >= STEP_S - STAMP_S {
                last = time;
                rows.push(row);
            }
        }
        rows
    }

    /// Registration of the nominal robot at a clock, with the median error, metres.
    fn register_at(&self, guess: &ClockGuess, most: usize) -> Option<(Estimate, f64)> {
        let (data, _) = self.session(guess, most)?;
        let packed = PackedValues::from_dataset(self.robot, &data);
        let held = unknowns(&data, true);
        let session = Session::new(self.robot, &data, &packed, true).with_unknowns(&held);
        let problem = registration(session);
        let rows = data.all_rows();
        let estimate = register_roughly(&Registration { rows: &rows, ..problem }, &nominal_estimate(self.robot, &data));
        let missed = median(session.errors(&rows, &estimate).iter().map(size))?;
        Some((estimate, missed))
    }

    /// Lag near a guess at which the nominal robot fits best.
    fn refine_lag(&self, guess: ClockGuess) -> Option<LaggedMeasurements> {
        let (mut guess, mut missed_m) = (guess, f64::INFINITY);
        let begun = guess.lag_s;
        for _ in 0..ROUNDS_OF_EACH {
            let (data, _) = self.session(&guess, SOME)?;
            let packed = PackedValues::from_dataset(self.robot, &data);
            let (held, free) = (unknowns(&data, true), unknowns(&data, false));
            let all = data.all_rows();
            let session = Session::new(self.robot, &data, &packed, true).with_unknowns(&held);
            let rough = register_roughly(
                &Registration { rows: &all, ..registration(session) },
                &nominal_estimate(self.robot, &data),
            );
            let errors = session.errors(&all, &rough);
            missed_m = median(errors.iter().map(size))?;
            let rows = rows_near(&all, &errors, missed_m);
            let session = session.with_unknowns(&free);
            let found = register_again(&Registration { rows: &rows, ..registration(session) }, &rough);
            let step = found.clock(0).lag_s.clamp(-0.1, 0.1);
            guess.lag_s += step;
            if (guess.lag_s - begun).abs() > 0.5 {
                return None;
            }
            if step.abs() < 1e-4 {
                break;
            }
        }
        Some(LaggedMeasurements { lag_s: guess.lag_s, missed_m })
    }

    /// Lag and drift together with the axes of the robot, all unknown.
    fn with_geometry(&self, guess: ClockGuess, missed_m: f64) -> Option<MotionMeasurements> {
        let mut guess = guess;
        let (mut jitter_s, mut fitted_m) = (0.0, f64::INFINITY);
        for _ in 0..ROUNDS {
            let (data, _) = self.session(&guess, MOST)?;
            let packed = PackedValues::from_dataset(self.robot, &data);
            let (held, free) = (unknowns(&data, true), Unknowns::USUAL);
            let all = data.all_rows();
            let session = Session::new(self.robot, &data, &packed, true).with_unknowns(&held);
            let mut estimate = register_roughly(
                &Registration { rows: &all, ..registration(session) },
                &nominal_estimate(self.robot, &data),
            );
            let session = session.with_unknowns(&free);
            let prior = Prior::from_session(&session, Tolerance::default());
            let mut rows = all.clone();
            for _ in 0..2 {
                let errors = session.errors(&all, &estimate);
                let missed = median(errors.iter().map(size))?;
                rows = rows_near(&all, &errors, missed);
                let weight = (missed / NOISE[Quantity::Position]).powi(2);
                estimate.recentre(&session, &rows);
                let clocks = (0..data.station_count())
                    .flat_map(|station| ClockTerm::ALL.map(|term| ClockUnknown { station, term }));
                let free = screw_axes(estimate.kinds())
                    .into_iter()
                    .chain(target_parameters(&session, &rows))
                    .chain(clocks.map(Parameter::ClockUnknown));
                let problem =
                    Problem::new(session, rows.clone(), free.collect(), NOISE).with_prior(Some((&prior, weight)));
                estimate = minimize(&problem, estimate, &Options::default()).0;
            }
            let (lag, drift) = (estimate.clock(0).lag_s, estimate.clock(0).drift);
            jitter_s = jitter(&session, &rows, &estimate);
            fitted_m = median(session.errors(&rows, &estimate).iter().map(size))?;
            (guess.lag_s, guess.drift) = (guess.lag_s + lag.clamp(-0.1, 0.1), guess.drift + drift.clamp(-1e-3, 1e-3));
            if lag.abs() < FOUND_S && drift.abs() < 1e-7 {
                break;
            }
        }
        let (data, rows) = self.session(&guess, MOST)?;
        let ClockGuess { lag_s, drift, middle_s } = guess;
        let rows = rows.into_iter().zip(&data.observations).enumerate().filter_map(|(at, (row, observation))| {
            let (rates, time_s) = data.motion(observation)?;
            Some(MovingRow { row, readings: data.readings(at).to_vec(), rates: rates.to_vec(), time_s })
        });
        let clock = Clock { station: 0, lag_s, drift, middle_s };
        Some(MotionMeasurements { clock, rows: rows.collect(), missed_m, fitted_m, jitter_s })
    }
}

impl MotionRecording<'_> {
    /// Lags at which the speeds of the nominal robot and of the measured target are correlated.
    fn by_speed(&self, stated: Option<(f64, f64)>) -> Vec<f64> {
        let mut own = Vec::new();
        let step = self.joints.times().len().div_ceil(TRACK).max(1);
        for at in (0..self.joints.times().len()).step_by(step) {
            let values = self.robot.joint_values(self.joints.row(at));
            own.push(self.robot.forward_kinematics(&values).translation);
        }
        let times = self.joints.times().iter().step_by(step).copied().collect();
        let joints = MotionTrack::new(times, own);
        // The target that was seen most is used.
        let most = self.data.most_seen_target().unwrap_or_default();
        let mut seen: Vec<(f64, Vector3<f64>)> = (self.data.observations.iter().zip(self.times))
            .filter(|(it, _)| it.target == most)
            .filter_map(|(it, time)| Some((*time, it.measurement.position()?)))
            .collect();
        seen.sort_by(|a, b| a.0.total_cmp(&b.0));
        seen.dedup_by(|next, known| next.0 <= known.0);
        let (times, places) = seen.into_iter().unzip();
        let measured = MotionTrack::new(times, places);
        let overlap_s = OVERLAP_S.max(OVERLAP * joints.span_s().min(measured.span_s()));
        speeds::lags((&joints, &measured), overlap_s, (CANDIDATES, APART_S), stated)
    }
}

/// Largest number of rows of joint readings whose tip is computed.
const TRACK: usize = 40_000;

/// Held clock terms if a robot is only registered: drifts, and the lag too if `is_held`.
fn unknowns(data: &Dataset, is_held: bool) -> Unknowns {
    let terms = if is_held { &ClockTerm::ALL[..] } else { &[ClockTerm::Drift][..] };
    let clocks = (0..data.station_count()).flat_map(|station| terms.iter().map(move |&term| (station, term)));
    Unknowns { held_clocks: clocks.collect(), ..Unknowns::USUAL }
}

/// The registration of all targets.
fn registration(session: Session<'_>) -> Registration<'_> {
    Registration { session, rows: &[], noise: NOISE, targets_free: true, prior: None }
}

/// Rows whose errors are at most a multiple of the usual one.
fn rows_near(rows: &[u32], errors: &[RowError], usual: f64) -> Vec<u32> {
    rows.iter().zip(errors).filter(|(_, error)| size(error) <= FAR * usual).map(|(row, _)| *row).collect()
}

/// Multiple of the usual error beyond which a row does not count: few stamps are late.
const FAR: f64 = 8.0;
