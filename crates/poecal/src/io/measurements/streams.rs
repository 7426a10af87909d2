//! Streams of joint readings and of measurements: their stands.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};

use super::join_pairs::JointRows;
use super::layout::ColumnLayout;
use super::table::Row;
use crate::lie::{Pose, rotation};
use crate::measurement::{Dataset, Measurement, Observation};
use crate::start::{Span, Stand, Stream, StreamChannels, mean_rotation};

/// Changes that are none: of a joint (rad, m), of a position (m), and of an orientation (rad).
const STILL_JOINT: f64 = 5e-5;
/// Largest last digit of readings that counts as no change (rad, m).
const COARSEST_JOINT: f64 = 1e-3;
const STILL_PLACE_M: f64 = 3e-5;
const STILL_TURN: f64 = 1e-4;

/// The time of a row, seconds; NaN if it has none.
pub(super) fn time_of(row: &Row<'_>, layout: &ColumnLayout) -> f64 {
    let Some((column, seconds)) = layout.time else { return f64::NAN };
    let text = row.cells.get(column).map_or("", |cell| cell.raw).trim_start_matches('\'');
    let value = if text.contains('.') { text.parse::<f64>() } else { text.replace(',', ".").parse() };
    value.map_or(f64::NAN, |it| it * seconds)
}

/// Stands of a stream of joint readings, as the rows that they are.
pub(super) fn stands_of_joints(rows: &JointRows, times: &[f64]) -> Option<JointRows> {
    let width = rows.turns.len();
    let channel = |at: usize| rows.readings.iter().skip(at).step_by(width.max(1)).copied().collect();
    let channels: Vec<Vec<f64>> = (0..width).map(channel).collect();
    let alone = |values: &Vec<f64>| StreamChannels {
        values: vec![values.clone()],
        freedom: 1,
        floor: STILL_JOINT.max(digit(values).min(COARSEST_JOINT)),
    };
    let stream = dense(times, channels.iter().map(alone).collect())?;
    let stands = stream.stands();
    let mean = |stand: &Stand| {
        let of = |channel: &Vec<f64>| {
            let own = channel.get(stand.rows.clone()).unwrap_or_default();
            own.iter().sum::<f64>() / own.len().max(1) as f64
        };
        channels.iter().map(of).collect::<Vec<f64>>()
    };
    Some(JointRows {
        readings: stands.iter().flat_map(mean).collect(),
        ids: Vec::new(),
        lines: stands.iter().filter_map(|it| rows.lines.get(it.rows.start)).copied().collect(),
        spans: Some(stands.iter().map(|it| it.span_s).collect()),
        ..rows.clone()
    })
}

/// The last digit of readings: the smallest change that is one.
fn digit(values: &[f64]) -> f64 {
    let changes = values.windows(2).map(|it| (it[1] - it[0]).abs()).filter(|it| *it > 1e-9);
    changes.min_by(f64::total_cmp).unwrap_or_default()
}

/// A stream, if rows are one.
fn dense(times: &[f64], channels: Vec<StreamChannels>) -> Option<Stream> {
    if times.is_empty() || times.iter().any(|it| !it.is_finite()) {
        return None;
    }
    Some(Stream::new(times.to_vec(), channels)).filter(Stream::is_dense)
}

/// The sum of the small turns from one orientation to the next, rad. Its parts have the same noise at every orientation, which those of a matrix
/// do not have.
#[derive(Clone, Debug, Default)]
struct Turned {
    last: Option<Matrix3<f64>>,
    sum: Vector3<f64>,
}

impl Turned {
    /// The sum up to the next orientation.
    fn after(&mut self, next: &Matrix3<f64>) -> Vector3<f64> {
        if let Some(last) = self.last.replace(*next) {
            self.sum += rotation::log(&(next * last.transpose()));
        }
        self.sum
    }
}

/// Stands of a stream of measurements: a row each, with the mean of each target, at the line of their first row.
#[derive(Clone, Debug, Default)]
pub(super) struct MeasuredStands {
    /// The stands, as a file of measurements would have them.
    pub(super) data: Dataset,
    pub(super) spans: Vec<Span>,
    /// Of each line, what was measured on an average, in the order of the file.
    pub(super) means: BTreeMap<usize, Vec<Measurement>>,
    /// Root mean square of how single rows scatter about these, metres.
    pub(super) scatter_m: f64,
}

/// The stands of measurements with these times; `None` if they are no stream.
pub(super) fn stands_of_measured(data: &Dataset, times: &[f64]) -> Option<MeasuredStands> {
    // The target that was seen most says when nothing moves.
    let most = data.most_seen_target()?;
    let rows: Vec<usize> =
        (0..data.len()).filter(|at| data.observations.get(*at).is_some_and(|it| it.target == most)).collect();
    let own: Vec<&Observation> = rows.iter().filter_map(|at| data.observations.get(*at)).collect();
    if own.iter().any(|it| it.measurement.position().is_none()) {
        return None;
    }
    let is_posed = own.iter().all(|it| it.measurement.sees_orientation());
    let mut turned = Turned::default();
    let mut numbers = |it: &&Observation| -> Vec<f64> {
        let place = it.measurement.position().unwrap_or_default();
        let turn = it.measurement.orientation().filter(|_| is_posed).map(|it| turned.after(&it));
        place.iter().copied().chain(turn.iter().flat_map(|it| it.iter().copied())).collect()
    };
    let all: Vec<Vec<f64>> = own.iter().map(&mut numbers).collect();
    let width = all.first()?.len();
    let channel = |at: usize| -> Vec<f64> { all.iter().filter_map(|it| it.get(at)).copied().collect() };
    let group = |range: std::ops::Range<usize>, floor: f64| StreamChannels {
        values: range.map(channel).collect(),
        freedom: 3,
        floor,
    };
    let mut channels = vec![group(0..3, STILL_PLACE_M)];
    channels.extend((width > 3).then(|| group(3..width, STILL_TURN)));
    let own_times: Vec<f64> = rows.iter().filter_map(|at| times.get(*at)).copied().collect();
    let stream = dense(&own_times, channels)?;
    let mut found =
        MeasuredStands { data: Dataset::new(data.reading_names().to_vec()), ..MeasuredStands::default() };
    (found.data.targets, found.data.stations) = (data.targets.clone(), data.stations.clone());
    let (mut squares, mut count) = (0.0, 0.0);
    for stand in stream.stands() {
        let (Some(&first), Some(&last)) = (rows.get(stand.rows.start), rows.get(stand.rows.end - 1)) else {
            continue;
        };
        let seen: Vec<&Observation> =
            data.observations.get(first..=last).unwrap_or_default().iter().collect();
        // The line that has most targets stands for all.
        let mut by_line: BTreeMap<u32, Vec<&Observation>> = BTreeMap::new();
        for it in &seen {
            by_line.entry(it.source.line).or_default().push(it);
        }
        let Some((line, chosen)) = by_line.iter().max_by_key(|it| (it.1.len(), std::cmp::Reverse(*it.0)))
        else {
            continue;
        };
        let mut means = Vec::with_capacity(chosen.len());
        for of in chosen {
            let same: Vec<&Measurement> =
                seen.iter().filter(|it| it.target == of.target).map(|it| &it.measurement).collect();
            let (mean, scatter) = mean_of(&same);
            squares += scatter;
            count += same.len() as f64;
            let averaged = Observation { measurement: mean, ..**of };
            let nothing = vec![0.0; data.reading_names().len()];
            if found.data.push_observation(&nothing, averaged).is_err() {
                return None;
            }
            found.data.ids.push(found.spans.len().to_string());
            means.push(mean);
        }
        found.spans.push(stand.span_s);
        found.means.insert(*line as usize, means);
    }
    found.scatter_m = f64::sqrt(squares / f64::max(count, 1.0));
    Some(found)
}

/// The mean of measurements of one target, and the sum of the squares of the distances from it, m².
fn mean_of(all: &[&Measurement]) -> (Measurement, f64) {
    let places: Vec<Vector3<f64>> = all.iter().filter_map(|it| it.position()).collect();
    let mean = places.iter().sum::<Vector3<f64>>() / places.len().max(1) as f64;
    let squares = places.iter().map(|it| (it - mean).norm_squared()).sum();
    let turns: Vec<Matrix3<f64>> = all.iter().filter_map(|it| it.orientation()).collect();
    let measurement = if turns.len() == places.len() && !turns.is_empty() {
        Measurement::of_pose(&Pose::new(mean_rotation(turns.into_iter()), mean))
    } else {
        Measurement::point(mean)
    };
    (measurement, squares)
}
