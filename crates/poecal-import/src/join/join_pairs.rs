//! Pairs of joint readings of one file and measurements of another, and the messages on them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::join_entry::{JoinEntry, MOST_ALONE, MOST_PAIRS, RowEntry};
use super::join_plan::ReadingsByLine;
use super::join_words::{number_lines, numbered_as};
use super::missing_intervals::MissingIntervals;
use crate::table::picture_names::PicturePartners;
use crate::{Join, Lag};
use poecal_fit::start::{JointStream, ResampledStream, RowPair, TimeInterval, UnpairedRows};
use poecal_model::measurement::Dataset;
use poecal_model::robot::{Controller, Robot};
use poecal_numerics::error::{Error, ErrorKind, Result};

/// Smallest number of badly fitting pairs that indicates lost and repeated rows.
const FEW_WRONG: usize = 2;
/// Share of the pairs up to which badly fitting ones are listed one by one.
pub(crate) const SOME_WRONG: f64 = 0.25;

/// Joint readings of a file.
#[derive(Clone, Debug)]
pub(crate) struct JointRows {
    pub(crate) path: PathBuf,
    pub(crate) readings: Vec<f64>,
    pub(crate) ids: Vec<String>,
    pub(crate) lines: Vec<usize>,
    /// True if they are in a sheet of a workbook.
    pub(crate) is_sheet: bool,
    /// True if no column of an angle states its unit.
    pub(crate) is_without_unit: bool,
    /// True for each reading of a row that is an angle.
    pub(crate) turns: Vec<bool>,
    /// The time of each row, seconds; NaN if it has none.
    pub(crate) times: Vec<f64>,
    /// Beginning and end of each row, seconds, if the rows are static intervals of a stream.
    pub(crate) spans: Option<Vec<TimeInterval>>,
    /// The stream of which they are static intervals.
    pub(crate) stream: Option<JointStream>,
    /// Reason why they are no stream.
    pub(crate) no_stands: MissingIntervals,
    /// Readings of that stream at equidistant times.
    pub(crate) sampled: Option<ResampledStream>,
    pub(crate) controller: Option<Controller>,
}

impl JointRows {
    /// The lines of rows; for static intervals, their first lines with the times.
    pub(crate) fn lines_of(&self, rows: &[usize]) -> String {
        let line = |row: &usize| {
            let line = self.lines.get(*row)?;
            Some(match self.spans.as_ref().and_then(|it| it.get(*row)) {
                Some((begin, _)) => format!("{line} ({begin:.2} s)"),
                None => line.to_string(),
            })
        };
        let lines: Vec<String> = rows.iter().filter_map(line).collect();
        match (&self.spans, lines.len()) {
            (None, _) if self.is_sheet => numbered_as("row", &lines),
            (None, _) => number_lines(&lines),
            (Some(_), 1) => format!("the stand that begins at {}", number_lines(&lines)),
            (Some(_), _) => format!("the stands that begin at {}", number_lines(&lines)),
        }
    }

    /// The rows with the angles in degrees.
    pub(crate) fn in_degrees(&self) -> Self {
        let of = |(value, turns): (&f64, &bool)| if *turns { value.to_radians() } else { *value };
        JointRows {
            readings: self.readings.iter().zip(self.turns.iter().cycle()).map(of).collect(),
            stream: self
                .stream
                .as_ref()
                .map(|it| it.map(|at, value| of((&value, self.turns.get(at).unwrap_or(&false))))),
            sampled: self.sampled.as_ref().map(|it| it.map(|row| row.iter().zip(&self.turns).map(of).collect())),
            ..self.clone()
        }
    }
}

/// A file of joint readings and one of measurements.
pub(crate) struct Pairing<'a> {
    pub(crate) joints: &'a JointRows,
    pub(crate) path: &'a Path,
    pub(crate) data: &'a Dataset,
    pub(crate) rows: UnpairedRows<'a>,
    pub(crate) robot: &'a Robot,
    /// Beginning and end of each measured configuration, seconds, if known.
    pub(crate) spans: Option<&'a [TimeInterval]>,
    /// The stated lag and its largest error, seconds.
    pub(crate) lag: Option<Lag>,
    /// Reason why the measurements are no stream; absent if they are static intervals of one.
    pub(crate) no_stands: Option<&'a MissingIntervals>,
    /// The stream of measurements whose static intervals these are, with its times, seconds.
    pub(crate) stream: Option<(&'a Dataset, &'a [f64])>,
}

/// Readings by line, and the messages on them.
pub(crate) struct JoinedReadings {
    /// Record of the join.
    pub(crate) entry: JoinEntry,
    pub(crate) readings: ReadingsByLine,
    /// Rows of joint readings without a measurement.
    pub(crate) unmeasured: Vec<usize>,
    pub(crate) notes: Vec<String>,
    pub(crate) warnings: Vec<String>,
}

impl<'a> Pairing<'a> {
    /// A pairing of lists, without clocks.
    pub(crate) fn of_lists(joints: &'a JointRows, path: &'a Path, data: &'a Dataset, robot: &'a Robot) -> Self {
        let rows = UnpairedRows::new(robot, &joints.readings, data);
        Pairing { joints, path, data, rows, robot, spans: None, lag: None, no_stands: None, stream: None }
    }

    /// The readings of each line, by names, order or time.
    pub(crate) fn find_readings(&self, join: Option<Join>) -> Result<JoinedReadings> {
        let by_names = if matches!(join, Some(Join::Rows | Join::Time)) { None } else { self.by_names() };
        let clocks = self.joints.spans.as_deref().zip(self.spans);
        match (join, by_names) {
            (Some(Join::Time), _) | (None, None) if let Some((joints, shots)) = clocks => {
                let lags = self.rows.find_lags(joints, shots, self.lag.map(|it| (it.lag_s, it.off_s)));
                let found = self.by_lag(&lags, (joints.len(), shots.len()));
                // Without static intervals at the same times, their order may suffice.
                let is_open = join.is_none() && self.lag.is_none() && lags.is_empty();
                found.or_else(|error| if is_open { self.by_rows(false).map_err(|_| error) } else { Err(error) })
            }
            (Some(Join::Time), _) => self.refuse(
                "found no times of a stream in which the robot stands, expected a column `time` in both files, and stands of 0.3 s or longer".to_owned(),
            ),
            (Some(Join::Name), None) => self.refuse(
                "found no name that is in both, expected a column `id` in each, with the same names, or names that end in the same number"
                    .to_owned(),
            ),
            (_, Some(pairs)) => match self.judge_order(&pairs, Join::Name, join.is_some()) {
                // The numbers may count only the points.
                Err(error) if join.is_none() => match self.by_rows(false) {
                    Ok(mut joined) => {
                        joined.warnings.push(format!(
                            "{}, {}: the order of the rows was taken, and not the names, which are in both: {}",
                            self.joints.path.display(),
                            self.path.display(),
                            error.message()
                        ));
                        Ok(joined)
                    }
                    Err(_) => Err(error),
                },
                judged => judged,
            },
            (_, None) => self.by_rows(join.is_some()),
        }
    }

    fn by_rows(&self, is_stated: bool) -> Result<JoinedReadings> {
        let (joints, shots) = (self.rows.joint_rows(), self.rows.shots().len());
        if joints != shots {
            return self.by_alignment();
        }
        let pairs: Vec<RowPair> = (0..joints).map(|row| (row, row)).collect();
        // Equal numbers of rows may hide that one row was lost and another one taken twice.
        let wrong = self.rows.find_wrong_pairs(&pairs).0.len();
        if wrong >= FEW_WRONG
            && let Some(found) = self.rows.align_lists().filter(|it| it.unread.is_empty() && !it.repeated.is_empty())
            && self.rows.find_wrong_pairs(&found.pairs).0.len() < wrong
        {
            return self.join_aligned(Some(found));
        }
        self.judge_order(&pairs, Join::Rows, is_stated)
    }

    /// The error of files that cannot be joined.
    pub(crate) fn refuse<T>(&self, message: String) -> Result<T> {
        let words = format!("{message} ({} has the joint readings)", self.joints.path.display());
        Err(Error::new(ErrorKind::Measurement, words).in_file(self.path))
    }

    /// Pairs of the same names, or of names that end in the same number.
    fn by_names(&self) -> Option<Vec<RowPair>> {
        let name_of = |shot: &Vec<u32>| self.data.ids.get(*shot.first()? as usize);
        let seen: Vec<Option<&String>> = self.rows.shots().iter().map(name_of).collect();
        let own: BTreeSet<&String> = seen.iter().flatten().copied().filter(|it| !it.is_empty()).collect();
        let others: BTreeSet<&String> = self.joints.ids.iter().filter(|it| !it.is_empty()).collect();
        // A name that occurs twice identifies no row.
        if others.len() != self.joints.ids.iter().filter(|it| !it.is_empty()).count() {
            return None;
        }
        let partners = PicturePartners::new(&own, others);
        let row_of = |name: &String| {
            let other = partners.partner(name)?;
            self.joints.ids.iter().position(|it| it == other)
        };
        let pairs: Vec<RowPair> =
            (seen.iter().enumerate()).filter_map(|(shot, name)| Some((row_of(name.as_ref()?)?, shot))).collect();
        (2 * pairs.len() >= seen.len() && !pairs.is_empty()).then_some(pairs)
    }

    /// The record of the pairs.
    pub(crate) fn entry(&self, join: Join, pairs: &[RowPair], missed_m: Option<f64>) -> JoinEntry {
        let paired: BTreeSet<usize> = pairs.iter().map(|it| it.1).collect();
        let of_joints = |rows: Vec<usize>| {
            let entry = |at: usize| Some(RowEntry { number: at + 1, line: *self.joints.lines.get(at)? });
            rows.into_iter().filter_map(entry).take(MOST_ALONE).collect::<Vec<_>>()
        };
        let of_shots = (0..self.rows.shots().len()).filter(|it| !paired.contains(it));
        let entry_of = |at: usize| Some(RowEntry { number: at + 1, line: self.shot_line(at)? });
        let robot_motion = self.joints.sampled.as_ref().filter(|_| join == Join::Time);
        JoinEntry {
            joints: self.joints.path.display().to_string(),
            measurements: self.path.display().to_string(),
            join,
            joint_rows: self.rows.joint_rows(),
            measured_rows: self.rows.shots().len(),
            paired: pairs.len(),
            missed_mm: missed_m.map(|it| 1e3 * it),
            lag_s: None,
            pairs: pairs.iter().take(MOST_PAIRS).map(|it| [it.0 + 1, it.1 + 1]).collect(),
            unmeasured: of_joints(self.unmeasured_rows(pairs)),
            repeated: of_joints(self.repeated_rows(pairs)),
            unread: of_shots.filter_map(entry_of).take(MOST_ALONE).collect(),
            robot_motion: robot_motion
                .map(|it| it.of_robot(self.robot, self.joints.spans.as_deref().unwrap_or_default())),
            measured_motion: None,
        }
    }

    pub(crate) fn readings(&self, pairs: &[RowPair]) -> ReadingsByLine {
        let mut found = ReadingsByLine { controller: self.joints.controller.clone(), ..ReadingsByLine::default() };
        for (joint, shot) in pairs {
            for &row in self.rows.shots().get(*shot).into_iter().flatten() {
                if let Some(observation) = self.data.observations.get(row as usize) {
                    found.lines.insert(observation.source.line as usize, self.rows.readings(*joint).to_vec());
                }
            }
        }
        found
    }

    pub(crate) fn joint_lines(&self, rows: &[usize]) -> String {
        self.joints.lines_of(rows)
    }

    /// The line of the first measurement at a configuration.
    fn shot_line(&self, shot: usize) -> Option<usize> {
        let row = *self.rows.shots().get(shot)?.first()?;
        Some(self.data.observations.get(row as usize)?.source.line as usize)
    }

    pub(crate) fn shot_lines(&self, shots: &[usize]) -> String {
        let line = |shot: &usize| self.shot_line(*shot).map(|it| it.to_string());
        number_lines(&shots.iter().filter_map(line).collect::<Vec<_>>())
    }
}
