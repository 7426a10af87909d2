//! Static intervals of two files that are joined, and readings without a measurement.

use std::collections::BTreeSet;
use std::path::Path;

use crate::join::join_pairs::JoinedReadings;
use crate::join::missing_intervals::MissingIntervals;
use poecal_fit::start::{FEWEST_PAIRS, MeasuredStands};
use poecal_numerics::error::{Error, ErrorKind, Result};

/// Joint readings at which no file so far has a measurement.
#[derive(Clone, Debug, Default)]
pub(super) struct UnmeasuredReadings {
    pub(super) rows: Option<BTreeSet<usize>>,
    /// Index of their warning among all warnings.
    pub(super) at: usize,
}

impl UnmeasuredReadings {
    /// Adds a file of measurements.
    pub(super) fn include(&mut self, rows: Vec<usize>, at: usize) {
        let rows: BTreeSet<usize> = rows.into_iter().collect();
        match &mut self.rows {
            Some(known) => known.retain(|it| rows.contains(it)),
            None => (self.rows, self.at) = (Some(rows), at),
        }
    }
}

/// Takes the means of static intervals, and reports the scatter of their rows.
pub(super) fn take_stands(found: &mut JoinedReadings, stands: MeasuredStands, path: &Path) {
    found.notes.push(format!(
        "{}: each stand is the mean of its rows, which scatter by {:.3} mm",
        path.display(),
        1e3 * stands.scatter_m
    ));
    found.warnings.extend(stands.warnings.iter().map(|it| format!("{}: {it}", path.display())));
    found.readings.means = stands.means;
}

/// Refuses a recording whose times go back.
pub(super) fn refuse_backwards(path: &Path, why: &MissingIntervals) -> Result<()> {
    let MissingIntervals::Recorded { why, back: Some(line) } = why else { return Ok(()) };
    let message = format!(
        "found {why}, expected rows in the order of their times: sort them, or leave out those of another recording"
    );
    Err(ErrorKind::Measurement.error(message).at_line(path, *line))
}

/// The error of a stream in which the robot is hardly ever static.
pub(super) fn no_stands(path: &Path, what: &str, count: usize) -> Error {
    ErrorKind::Measurement
        .error(format!(
            "found a stream of {what} with {count} times in which nothing moves for 0.3 s or longer, expected at least {FEWEST_PAIRS} stands: let the robot stop at each configuration, or join the recordings in motion (--join motion), or rows of the same time (--join rows)"
        ))
        .in_file(path)
}
