//! Static intervals of streams of joint readings and of measurements.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};

use super::super::averaging::mean_rotation;
use super::interval_means::{IntervalScatter, flag_near_middle, kept_values};
use super::lags::TimeInterval;
use super::static_intervals::{RowStream, StaticInterval, StreamChannels, StreamFailure};
use super::words::number_lines;
use poecal_arm::lie::{Pose, rotation};
use poecal_model::measurement::{Dataset, Measurement, Observation};

/// Changes that count as no motion: of a joint (rad, m), of a position (m), and of an orientation (rad).
const STILL_JOINT: f64 = 5e-5;
/// Largest last digit of readings that counts as no change (rad, m).
const COARSEST_JOINT: f64 = 1e-3;
const STILL_PLACE_M: f64 = 3e-5;
const STILL_TURN: f64 = 1e-4;

/// Static intervals of a stream of joint readings, of `width` numbers a row, each with the means of its rows.
///
/// # Errors
/// Reason why there are none; `None` if rows do not follow each other as in a recording.
pub fn stands_of_readings(
    times: &[f64],
    readings: &[f64],
    width: usize,
) -> Result<Vec<(StaticInterval, Vec<f64>)>, Option<StreamFailure>> {
    let channel = |at: usize| readings.iter().skip(at).step_by(width.max(1)).copied().collect();
    let channels: Vec<Vec<f64>> = (0..width).map(channel).collect();
    let alone = |values: &Vec<f64>| StreamChannels {
        values: vec![values.clone()],
        freedom: 1,
        floor: STILL_JOINT.max(digit(values).min(COARSEST_JOINT)),
    };
    let floors: Vec<f64> = channels.iter().map(|it| alone(it).floor).collect();
    let rows = readings.len() / width.max(1);
    let stream = dense_stream(times, rows, channels.iter().map(alone).collect())?;
    let mean = |stand: StaticInterval| {
        let of = |(channel, floor): (&Vec<f64>, &f64)| {
            let own = kept_values(channel.get(stand.rows.clone()).unwrap_or_default(), *floor);
            own.iter().sum::<f64>() / own.len().max(1) as f64
        };
        let means = channels.iter().zip(&floors).map(of).collect();
        (stand, means)
    };
    Ok(stream.stands().into_iter().map(mean).collect())
}

/// Last digit of readings: the smallest change above rounding.
fn digit(values: &[f64]) -> f64 {
    let changes = values.windows(2).map(|it| (it[1] - it[0]).abs()).filter(|it| *it > 1e-9);
    changes.min_by(f64::total_cmp).unwrap_or_default()
}

/// A stream, if the rows are dense enough.
fn dense_stream(times: &[f64], rows: usize, channels: Vec<StreamChannels>) -> Result<RowStream, Option<StreamFailure>> {
    let own = if times.len() == rows { times.to_vec() } else { vec![f64::NAN; rows] };
    let stream = RowStream::new(own, channels);
    if !stream.is_smooth() {
        return Err(None);
    }
    match stream.no_stream() {
        Some(why) => Err(Some(why)),
        None => Ok(stream),
    }
}

/// Sum of the small rotations from one orientation to the next, rad. Its components have the same noise at every orientation, unlike those of a
/// matrix.
#[derive(Clone, Debug, Default)]
struct TurnSum {
    last: Option<Matrix3<f64>>,
    sum: Vector3<f64>,
}

impl TurnSum {
    /// Sum up to the next orientation.
    fn after(&mut self, next: &Matrix3<f64>) -> Vector3<f64> {
        if let Some(last) = self.last.replace(*next) {
            self.sum += rotation::log(&(next * last.transpose()));
        }
        self.sum
    }
}

/// Static intervals of a stream of measurements: a row each, with the mean of each target, at the line of their first row.
#[derive(Clone, Debug, Default)]
pub struct MeasuredStands {
    /// Static intervals, as a file of measurements would have them.
    pub data: Dataset,
    /// Begin and end of each, seconds.
    pub spans: Vec<TimeInterval>,
    /// Mean measurements of each line, in the order of the file.
    pub means: BTreeMap<usize, Vec<Measurement>>,
    /// Root mean square scatter of single rows about these means, metres.
    pub scatter_m: f64,
    /// Warnings, a sentence each.
    pub warnings: Vec<String>,
}

/// Static intervals of measurements with these times.
///
/// # Errors
/// Reason why there are none, by numbers of rows of the data; `None` if rows do not follow each other as in a recording.
pub fn stands_of_measured(data: &Dataset, times: &[f64]) -> Result<MeasuredStands, Option<StreamFailure>> {
    // The target that was seen most determines the static intervals.
    let most = data.most_seen_target().ok_or(None)?;
    let rows: Vec<usize> =
        (0..data.len()).filter(|at| data.observations.get(*at).is_some_and(|it| it.target == most)).collect();
    let own: Vec<&Observation> = rows.iter().filter_map(|at| data.observations.get(*at)).collect();
    if own.iter().any(|it| it.measurement.position().is_none()) {
        return Err(None);
    }
    let stream = stream_of_places(&own, (&rows, times)).map_err(|why| why.map(|it| it.of_rows(&rows)))?;
    let mut found = MeasuredStands { data: Dataset::new(data.reading_names().to_vec()), ..MeasuredStands::default() };
    (found.data.targets, found.data.stations) = (data.targets.clone(), data.stations.clone());
    let (mut spreads, mut starts) = (Vec::new(), Vec::new());
    for stand in stream.stands() {
        let (Some(&first), Some(&last)) = (rows.get(stand.rows.start), rows.get(stand.rows.end - 1)) else {
            continue;
        };
        let seen: Vec<&Observation> = data.observations.get(first..=last).unwrap_or_default().iter().collect();
        // The line with the most targets represents all.
        let mut by_line: BTreeMap<u32, Vec<&Observation>> = BTreeMap::new();
        for it in &seen {
            by_line.entry(it.source.line).or_default().push(it);
        }
        let Some((line, chosen)) = by_line.iter().max_by_key(|it| (it.1.len(), std::cmp::Reverse(*it.0))) else {
            continue;
        };
        let mut means = Vec::with_capacity(chosen.len());
        let mut spread = IntervalScatter::default();
        for of in chosen {
            let same: Vec<&Measurement> =
                seen.iter().filter(|it| it.target == of.target).map(|it| &it.measurement).collect();
            let mean = mean_of(&same, &mut spread);
            let averaged = Observation { measurement: mean, ..**of };
            let nothing = vec![0.0; data.reading_names().len()];
            if found.data.push_observation(&nothing, averaged).is_err() {
                return Err(None);
            }
            found.data.ids.push(found.spans.len().to_string());
            means.push(mean);
        }
        found.spans.push(stand.span_s);
        found.means.insert(*line as usize, means);
        starts.push(format!("{line} ({:.2} s)", stand.span_s.0));
        spreads.push(spread);
    }
    found.scatter_m = IntervalScatter::of_all(&spreads);
    found.warnings = IntervalScatter::warnings(&spreads, |some| {
        number_lines(&some.iter().filter_map(|at| starts.get(*at)).cloned().collect::<Vec<_>>())
    });
    Ok(found)
}

/// Stream of a target's positions and, if all rows have one, its orientation.
fn stream_of_places(
    own: &[&Observation],
    (rows, times): (&[usize], &[f64]),
) -> Result<RowStream, Option<StreamFailure>> {
    let is_posed = own.iter().all(|it| it.measurement.sees_orientation());
    let mut turned = TurnSum::default();
    let mut numbers = |it: &&Observation| -> Vec<f64> {
        let place = it.measurement.position().unwrap_or_default();
        let turn = it.measurement.orientation().filter(|_| is_posed).map(|it| turned.after(&it));
        place.iter().copied().chain(turn.iter().flat_map(|it| it.iter().copied())).collect()
    };
    let all: Vec<Vec<f64>> = own.iter().map(&mut numbers).collect();
    let width = all.first().map_or(0, Vec::len);
    let channel = |at: usize| -> Vec<f64> { all.iter().filter_map(|it| it.get(at)).copied().collect() };
    let group = |range: std::ops::Range<usize>, floor: f64| StreamChannels {
        values: range.map(channel).collect(),
        freedom: 3,
        floor,
    };
    let mut channels = vec![group(0..3, STILL_PLACE_M)];
    channels.extend((width > 3).then(|| group(3..width, STILL_TURN)));
    let own_times: Vec<f64> = rows.iter().filter_map(|at| times.get(*at)).copied().collect();
    dense_stream(&own_times, own.len(), channels)
}

/// Mean of measurements of one target, without those that are far from the others.
fn mean_of(all: &[&Measurement], spread: &mut IntervalScatter) -> Measurement {
    let all: Vec<(Vector3<f64>, Option<Matrix3<f64>>)> =
        all.iter().filter_map(|it| Some((it.position()?, it.orientation()))).collect();
    let places: Vec<Vector3<f64>> = all.iter().map(|it| it.0).collect();
    let is_kept = flag_near_middle(&places, STILL_PLACE_M);
    let own = || all.iter().zip(&is_kept).filter(|it| *it.1).map(|it| it.0);
    let mean = own().map(|it| it.0).sum::<Vector3<f64>>() / own().count().max(1) as f64;
    spread.add(&places, &is_kept, &mean);
    let turns: Vec<Matrix3<f64>> = own().filter_map(|it| it.1).collect();
    if turns.len() == own().count() && !turns.is_empty() {
        Measurement::of_pose(&Pose::new(mean_rotation(turns.into_iter()), mean))
    } else {
        Measurement::point(mean)
    }
}
