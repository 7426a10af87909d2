//! Assignment of joint readings to measurements if two files have them: the error of the registered nominal robot is least for right pairs.
//!
//! The robot decides whether pairs are right. The same rows are registered in other orders, and lists of unequal length are aligned. Static intervals
//! of recordings are detected (`static_intervals.rs`), and those of two clocks are paired by their lag (`lags.rs`).

mod agreement;
mod interval_means;
mod jitter;
mod joint_stream;
mod lags;
mod motion;
mod resampling;
mod speeds;
mod static_intervals;
mod stream_intervals;
mod uneven_lists;
mod words;

pub use agreement::{Agreement, RowOrder};
pub use joint_stream::{JointStream, smooth_times};
pub use lags::{LaggedPairs, TimeInterval};
pub use motion::{LagFailure, LaggedMeasurements, MotionMeasurements, MotionRecording, MovingRow};
pub use resampling::{MotionEntry, ResampledStream, motion_of_points, motion_of_target};
pub use static_intervals::{RowStream, StaticInterval, StreamChannels, StreamFailure};
pub use stream_intervals::{MeasuredStands, stands_of_measured, stands_of_readings};
pub use uneven_lists::AlignedPairs;
pub use words::{mm, number_lines, numbered_as};

use std::collections::BTreeSet;

use super::registration::Registration;
use super::stations::register_roughly;
use crate::state::{Estimate, PackedValues, RowError, Session, nominal_estimate};
use poecal_model::measurement::{Dataset, Noise};
use poecal_model::robot::Robot;
use poecal_numerics::distributions::median;

/// Noise of a registration, which covers the errors of the nominal robot: m and rad.
const NOISE: Noise = Noise::new(2e-3, 5e-3);
/// Largest number of pairs of a registration that only compares.
const SOME: usize = 150;
/// Multiple of the usual error beyond which a pair does not count in a registration.
const ODD: f64 = 4.0;
/// Least factor by which the error of the right alternative is smaller than that of any other.
pub const EVIDENT: f64 = 2.0;
/// Fewest pairs for a comparison: five points determine device and target, and leave no error.
pub const FEWEST_PAIRS: usize = 7;

/// A row of joint readings, and a measured configuration; both from 0.
pub type RowPair = (usize, usize);

/// Joint readings and measurements, without an assignment of one to the other.
#[derive(Clone, Debug)]
pub struct UnpairedRows<'a> {
    robot: &'a Robot,
    /// Joint readings, one row after the other.
    joints: &'a [f64],
    /// Measurements; their own readings have no meaning.
    data: &'a Dataset,
    /// Rows of each measured configuration.
    shots: Vec<Vec<u32>>,
}

impl<'a> UnpairedRows<'a> {
    /// Joint readings and measurements of a robot. Consecutive rows of a file belong to one configuration as long as none of their targets
    /// occurs again.
    #[must_use]
    pub fn new(robot: &'a Robot, joints: &'a [f64], data: &'a Dataset) -> Self {
        UnpairedRows { robot, joints, data, shots: Self::shots_of(data) }
    }

    /// Rows of each configuration of measurements, as [`UnpairedRows::new`] finds them.
    #[must_use]
    pub fn shots_of(data: &Dataset) -> Vec<Vec<u32>> {
        let mut shots: Vec<Vec<u32>> = Vec::new();
        let mut seen: BTreeSet<(usize, usize)> = BTreeSet::new();
        let mut line = None;
        for (row, observation) in (0_u32..).zip(&data.observations) {
            let target = (observation.station, observation.target);
            let is_same_line = line == Some(observation.source);
            let name = |row: u32| data.ids.get(row as usize);
            let is_other = shots.last().and_then(|it| it.first()).is_some_and(|&first| name(first) != name(row));
            if shots.is_empty() || !is_same_line && (is_other || !seen.insert(target)) {
                shots.push(Vec::new());
                seen = BTreeSet::from([target]);
            }
            line = Some(observation.source);
            if let Some(last) = shots.last_mut() {
                last.push(row);
            }
        }
        shots
    }

    /// Rows of each measured configuration.
    #[must_use]
    pub fn shots(&self) -> &[Vec<u32>] {
        &self.shots
    }

    /// Number of rows of joint readings.
    #[must_use]
    pub fn joint_rows(&self) -> usize {
        self.joints.len() / self.width()
    }

    fn width(&self) -> usize {
        self.data.reading_names().len().max(1)
    }

    /// Readings of a row.
    #[must_use]
    pub fn readings(&self, row: usize) -> &'a [f64] {
        let width = self.width();
        self.joints.get(row * width..(row + 1) * width).unwrap_or_default()
    }

    /// Measurements of pairs, with their readings.
    #[must_use]
    pub fn session_of(&self, pairs: &[RowPair]) -> Dataset {
        self.pair_rows(pairs).0
    }

    /// The same measurements with the pair of each row.
    fn pair_rows(&self, pairs: &[RowPair]) -> (Dataset, Vec<usize>) {
        let mut data = Dataset::new(self.data.reading_names().to_vec()).with_factors(self.robot.factors.len());
        (data.targets, data.stations) = (self.data.targets.clone(), self.data.stations.clone());
        let mut of = Vec::new();
        for (at, (joint, shot)) in pairs.iter().enumerate() {
            for &row in self.shots.get(*shot).into_iter().flatten() {
                let Some(observation) = self.data.observations.get(row as usize) else { continue };
                let plain = poecal_model::measurement::Observation { noise_shape: None, ..*observation };
                if data.push_observation(self.readings(*joint), plain).is_ok() {
                    of.push(at);
                }
            }
        }
        (data, of)
    }

    /// Registers pairs twice, the second time without those that fit badly, and returns the estimate with the median error, metres.
    fn register_pairs(&self, pairs: &[RowPair]) -> Option<(Estimate, f64)> {
        let (data, _) = self.pair_rows(pairs);
        if data.is_empty() {
            return None;
        }
        let packed = PackedValues::from_dataset(self.robot, &data);
        let session = Session::new(self.robot, &data, &packed, true);
        let mut rows = data.all_rows();
        let mut best = None;
        for _ in 0..2 {
            let problem = Registration { session, rows: &rows, noise: NOISE, targets_free: true, prior: None };
            let estimate = register_roughly(&problem, &nominal_estimate(self.robot, &data));
            let missed: Vec<f64> = session.errors(&data.all_rows(), &estimate).iter().map(size).collect();
            let usual = median(missed.iter().copied()).filter(|it| it.is_finite())?;
            rows = data.all_rows().into_iter().zip(&missed).filter(|it| *it.1 <= ODD * usual).map(|it| it.0).collect();
            best = Some((estimate, usual));
        }
        best
    }

    /// Median error of pairs, metres; of a subsample if there are many.
    fn median_error(&self, pairs: &[RowPair]) -> Option<f64> {
        let step = pairs.len().div_ceil(SOME).max(1);
        let some: Vec<RowPair> = pairs.iter().step_by(step).copied().collect();
        self.register_pairs(&some).map(|it| it.1)
    }

    /// Errors of pairs by an estimate, each the root mean square of its rows, metres.
    fn errors_of(&self, pairs: &[RowPair], estimate: &Estimate) -> Vec<f64> {
        let (data, of) = self.pair_rows(pairs);
        let packed = PackedValues::from_dataset(self.robot, &data);
        let session = Session::new(self.robot, &data, &packed, true);
        let mut sums = vec![(0.0, 0.0); pairs.len()];
        for (error, at) in session.errors(&data.all_rows(), estimate).iter().zip(of) {
            if let Some(sum) = sums.get_mut(at) {
                *sum = (sum.0 + size(error).powi(2), sum.1 + 1.0);
            }
        }
        sums.into_iter().map(|(sum, count)| if count > 0.0 { f64::sqrt(sum / count) } else { f64::INFINITY }).collect()
    }
}

/// Size of a row's error: of its position or distance, metres; for others, of the first measured quantity.
fn size(error: &RowError) -> f64 {
    error.leading_quantity().and_then(|quantity| error.length(quantity)).unwrap_or_default()
}
