//! Motion in streams, for charts of the joining: positions at times of equal distance, and the speeds between them.

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::TimeInterval;
use poecal_model::measurement::Dataset;
use poecal_model::robot::Robot;
use poecal_numerics::distributions::median;

/// Largest number of times without a row that are listed.
const MOST_GAPS: usize = 1000;
/// Largest number of speeds of a stream, and shortest time from one to the next, seconds.
const MOST: f64 = 600.0;
const SHORTEST_S: f64 = 0.1;
/// Number of steps from row to row from which on a time without a row is a gap.
const GAP_STEPS: f64 = 2.5;

/// Motion in a stream, by its own clock.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MotionEntry {
    /// Rows.
    pub rows: usize,
    /// Time of the first row, seconds; all other times are after it.
    pub begin_s: f64,
    /// Time of the last row, seconds.
    pub end_s: f64,
    /// Seconds from one speed to the next; zero without speeds.
    pub step_s: f64,
    /// Speed of the nominal robot's tip, or of the target that was seen most, over each step, mm/s; null if no row is near.
    pub speeds_mm_s: Vec<Option<f64>>,
    /// Begin and end of each static interval, seconds; both are equal for a single point.
    pub stands_s: Vec<[f64; 2]>,
    /// Begin and end of the times without a row, such as lost frames, seconds; the longest 1,000.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gaps_s: Vec<[f64; 2]>,
}

/// Numbers of a stream at times of equal distance.
#[derive(Clone, Debug, Default)]
pub struct ResampledStream {
    /// Numbers at a time, one time after the other; `None` if no row is near.
    values: Vec<Option<Vec<f64>>>,
    step_s: f64,
    /// Rows, begin and end of the stream, and times without a row.
    rows: usize,
    span: TimeInterval,
    gaps: Vec<TimeInterval>,
}

impl ResampledStream {
    /// Samples of rows with these times, `width` numbers each.
    #[must_use]
    pub fn new(times: &[f64], rows: &[f64], width: usize) -> Option<Self> {
        let (&begin, &end) = times.first().zip(times.last())?;
        let steps: Vec<f64> = times.windows(2).map(|it| it[1] - it[0]).collect();
        let step = median(steps.iter().copied()).filter(|it| *it > 0.0)?;
        let is_gap = |at: usize| steps.get(at).is_some_and(|it| *it > GAP_STEPS * step);
        let mut gaps: Vec<TimeInterval> =
            (0..steps.len()).filter(|at| is_gap(*at)).map(|at| (times[at], times[at + 1])).collect();
        if gaps.len() > MOST_GAPS {
            gaps.sort_by(|a, b| (b.1 - b.0).total_cmp(&(a.1 - a.0)));
            gaps.truncate(MOST_GAPS);
            gaps.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        let step_s = ((end - begin) / MOST).max(SHORTEST_S);
        let mut after = 1;
        let at = |time: f64| {
            while after + 1 < times.len() && times.get(after).is_some_and(|it| *it < time) {
                after += 1;
            }
            // A gap that is short compared with the steps of the chart does not count.
            let (from, to) = (*times.get(after - 1)?, *times.get(after)?);
            if is_gap(after - 1) && to - from > step_s {
                return None;
            }
            let share = if to > from { ((time - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
            let (one, other) = (rows.get((after - 1) * width..)?, rows.get(after * width..)?);
            let mixed = one.iter().zip(other).take(width).map(|(a, b)| a + share * (b - a));
            Some(mixed.collect())
        };
        let count = ((end - begin) / step_s).floor() as usize;
        let values = (0..=count).map(|k| begin + k as f64 * step_s).map(at).collect();
        Some(ResampledStream { values, step_s, rows: times.len(), span: (begin, end), gaps })
    }

    /// The same samples with other numbers.
    #[must_use]
    pub fn map(&self, of: impl Fn(&[f64]) -> Vec<f64>) -> Self {
        let values = self.values.iter().map(|it| it.as_deref().map(&of)).collect();
        ResampledStream { values, ..self.clone() }
    }

    /// Motion, by the position of each row of numbers, metres.
    fn motion(&self, place: impl Fn(&[f64]) -> Vector3<f64>, stands: &[TimeInterval]) -> MotionEntry {
        let places: Vec<Option<Vector3<f64>>> = self.values.iter().map(|it| it.as_deref().map(&place)).collect();
        let speed = |it: &[Option<Vector3<f64>>]| {
            let (from, to) = ((*it.first()?)?, (*it.get(1)?)?);
            Some(round_to_steps(1e3 * (to - from).norm() / self.step_s, 10.0))
        };
        MotionEntry {
            step_s: round_to_steps(self.step_s, 1e6),
            speeds_mm_s: places.windows(2).map(speed).collect(),
            gaps_s: after(&self.gaps, self.span.0),
            rows: self.rows,
            ..motion_of_stands(self.span, stands)
        }
    }

    /// Motion of the nominal robot's tip.
    #[must_use]
    pub fn of_robot(&self, robot: &Robot, stands: &[TimeInterval]) -> MotionEntry {
        let tip = |readings: &[f64]| robot.forward_kinematics(&robot.joint_values(readings)).translation;
        self.motion(tip, stands)
    }
}

/// Motion of single points.
#[must_use]
pub fn motion_of_points(points: &[TimeInterval]) -> Option<MotionEntry> {
    let (first, last) = points.first().zip(points.last())?;
    Some(MotionEntry { rows: points.len(), ..motion_of_stands((first.0, last.1), points) })
}

/// Motion of the target that was seen most, by the times of all rows.
#[must_use]
pub fn motion_of_target(data: &Dataset, times: &[f64], stands: &[TimeInterval]) -> Option<MotionEntry> {
    let most = data.most_seen_target()?;
    let own = data.observations.iter().zip(times).filter(|(it, _)| it.target == most);
    let seen: Vec<(f64, Vector3<f64>)> =
        own.filter_map(|(it, time)| Some((*time, it.measurement.position()?))).collect();
    let own_times: Vec<f64> = seen.iter().map(|it| it.0).collect();
    let places: Vec<f64> = seen.iter().flat_map(|it| it.1.iter().copied().collect::<Vec<_>>()).collect();
    let sampled = ResampledStream::new(&own_times, &places, 3)?;
    Some(sampled.motion(|it| Vector3::from_iterator(it.iter().copied()), stands))
}

fn motion_of_stands((begin, end): TimeInterval, stands: &[TimeInterval]) -> MotionEntry {
    MotionEntry {
        begin_s: begin,
        end_s: round_to_steps(end - begin, 1e6),
        stands_s: after(stands, begin),
        ..MotionEntry::default()
    }
}

/// Spans after a time.
fn after(spans: &[TimeInterval], begin: f64) -> Vec<[f64; 2]> {
    spans.iter().map(|it| [round_to_steps(it.0 - begin, 1e6), round_to_steps(it.1 - begin, 1e6)]).collect()
}

/// A value rounded to a number of steps in a unit.
fn round_to_steps(value: f64, steps: f64) -> f64 {
    (value * steps).round() / steps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_are_those_between_places_and_none_without_rows() {
        // The motion is 1 m/s for 1 s, a static interval of 1 s, and a second without rows; times of a clock far from zero.
        let times: Vec<f64> = (0..400)
            .map(|k| 1.7e9 + 0.01 * f64::from(k))
            .filter(|it| !(1.7e9 + 2.2..1.7e9 + 3.2).contains(it))
            .collect();
        let places: Vec<f64> = times.iter().flat_map(|it| [(it - 1.7e9).min(1.0), 0.0, 0.0]).collect();
        let sampled = ResampledStream::new(&times, &places, 3).unwrap();
        let motion = sampled.motion(|it| Vector3::new(it[0], it[1], it[2]), &[(1.7e9 + 1.0, 1.7e9 + 2.0)]);
        println!("{} speeds, gaps {:?}", motion.speeds_mm_s.len(), motion.gaps_s);
        assert_eq!(motion.stands_s, [[1.0, 2.0]]);
        assert_eq!(motion.gaps_s.len(), 1);
        // A clock of 1.7e9 s has steps of 0.24 µs.
        assert!((motion.gaps_s[0][0] - 2.19).abs() < 1e-5 && (motion.gaps_s[0][1] - 3.2).abs() < 0.011);
        assert!(motion.speeds_mm_s[..9].iter().all(|it| it.is_some_and(|it| (it - 1000.0).abs() < 0.2)));
        assert!(motion.speeds_mm_s[11..21].iter().all(|it| *it == Some(0.0)));
        assert!(motion.speeds_mm_s[22..32].iter().all(Option::is_none));
        assert!(ResampledStream::new(&[], &[], 3).is_none() && ResampledStream::new(&[1.0], &[0.0; 3], 3).is_none());
    }
}
