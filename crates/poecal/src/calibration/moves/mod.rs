//! What moved within a session that should have stood still: the measuring device, one target on the arm, or all of it slowly
//! (theory.md §9, *Moved*).

mod frames;
mod series;

pub(super) use frames::{Doubtful, FramesApart, frames_apart};

use nalgebra::Vector3;

use super::{Robustness, RowError};
use crate::estimate::{Chain, Estimate, Linkage, Packed, sample_rows};
use crate::measurement::Dataset;
use series::{Change, Series};

/// Rows that are looked at, at most: a change shows in fewer, and its place is then known to a few rows.
const MOST_ROWS: usize = 20_000;
/// Share of the suspected rows that a change explains, from which on it is what they are.
const EXPLAINED: f64 = 0.8;

/// What moved.
pub(super) struct Moved {
    /// What it is, from where on, how far, and what to do.
    pub(super) statement: String,
    /// Whether the result is not to be used.
    pub(super) is_grave: bool,
    parts: Parts,
}

/// What a change parts.
enum Parts {
    /// Device frames that no one model describes.
    Frames,
    /// The rows before and after a step.
    Sides([Vec<u32>; 2]),
    /// Nothing: it is steady.
    None,
}

impl Moved {
    /// Whether it is device frames that differ by so much that no one model describes the rows.
    pub(super) fn is_of_frames(&self) -> bool {
        matches!(self.parts, Parts::Frames)
    }

    /// Whether rows that are suspected to be grossly wrong are those on one side of the change.
    pub(super) fn explains(&self, robustness: &Robustness) -> bool {
        match &self.parts {
            Parts::Frames => true,
            Parts::None => false,
            Parts::Sides(sides) => {
                let within = |side: &Vec<u32>| {
                    robustness.suspects().filter(|row| side.binary_search(row).is_ok()).count()
                };
                let most = sides.iter().map(within).max().unwrap_or(0);
                most as f64 >= EXPLAINED * robustness.suspects().count() as f64
            }
        }
    }
}

/// A finished fit and the rows that are looked at, in the order in which they were measured.
#[derive(Clone, Copy)]
pub(super) struct Looked<'a> {
    pub(super) data: &'a Dataset,
    pub(super) packed: &'a Packed,
    pub(super) estimate: &'a Estimate,
    pub(super) rows: &'a [u32],
    /// Whether the device may stand anywhere.
    pub(super) device_free: bool,
    /// How to fit once more, with a device frame for each side of a step, if that tells better how far it is.
    pub(super) again: Option<&'a Doubtful<'a>>,
}

/// What a series of errors is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Subject {
    /// The device, at one of the places where it stood.
    Device(usize),
    /// A target on the arm.
    Target(usize),
}

/// The change that explains most of the squared errors, if one is no chance.
pub(super) fn moved(looked: &Looked<'_>) -> Option<Moved> {
    let rows = sample_rows(looked.rows, MOST_ROWS);
    let errors = super::row_errors(looked.data, looked.packed, &rows, looked.estimate);
    let mut found: Option<(Subject, Vec<u32>, Change)> = None;
    let mut consider = |subject: Subject, series: Series| {
        let change = series.change(matches!(subject, Subject::Device(_)));
        if let Some(change) = change
            && found.as_ref().is_none_or(|(_, _, best)| change.explained > best.explained)
        {
            found = Some((subject, series.rows, change));
        }
    };
    for station in 0..looked.data.station_count() {
        consider(Subject::Device(station), of_device(looked, &rows, &errors, station));
    }
    for (target, series) in of_targets(looked, &rows, &errors).into_iter().enumerate() {
        consider(Subject::Target(target), series);
    }
    let (subject, rows, change) = found?;
    Some(looked.moved(subject, &rows, &change))
}

/// Errors of the rows seen from one place, in the device's axes.
fn of_device(looked: &Looked<'_>, rows: &[u32], errors: &[RowError], station: usize) -> Series {
    let own = rows.iter().zip(errors);
    let own = own.filter(|(row, _)| looked.data.observations[**row as usize].station == station);
    let (rows, values): (Vec<u32>, Vec<Vector3<f64>>) =
        own.map(|(&row, error)| (row, error.position_m)).unzip();
    let configurations = rows.iter().map(|&row| shapes(looked.packed, row as usize)).collect();
    Series { rows, values, configurations }
}

/// What varies with the joint values themselves, so that it is not taken for a change with time.
fn shapes(packed: &Packed, row: usize) -> Vec<f64> {
    let values = packed.joint_values(row).iter().zip(packed.row(row)).zip(packed.turns());
    let mut shapes = vec![1.0];
    for ((&value, &(cosine, sine)), turns) in values {
        shapes.push(value);
        if turns {
            shapes.extend([cosine, sine]);
        } else {
            shapes.push(value * value);
        }
    }
    shapes
}

/// Errors of the rows of each target, in its own axes, which go with the last link.
fn of_targets(looked: &Looked<'_>, rows: &[u32], errors: &[RowError]) -> Vec<Series> {
    let mut series: Vec<Series> = vec![Series::default(); looked.data.targets.len()];
    let linkage = Linkage::new(looked.estimate);
    let mut chain = Chain::default();
    for (&row, error) in rows.iter().zip(errors) {
        let seen = &looked.data.observations[row as usize];
        chain.evaluate(&linkage, looked.packed, row as usize, seen);
        if let Some(own) = series.get_mut(seen.target) {
            own.rows.push(row);
            own.values.push(chain.target.rotation.transpose() * error.position_m);
        }
    }
    series
}

impl Looked<'_> {
    fn moved(&self, subject: Subject, rows: &[u32], change: &Change) -> Moved {
        let (data, far_mm) = (self.data, 1e3 * change.distance_m);
        let Some(at) = change.at else {
            let (first, last) = (rows.first().copied().unwrap_or(0), rows.last().copied().unwrap_or(0));
            let statement = format!(
                "the measurements drift by {far_mm:.2} mm from {} to {}, steadily with time: the measuring device, the robot or its tool \
                 was still warming up or settling; measure again when they have, or in shorter sessions",
                data.place(first),
                data.place(last)
            );
            return Moved { statement, is_grave: change.distance_m > change.left_m, parts: Parts::None };
        };
        let place = data.place(rows[at]);
        let statement = match subject {
            Subject::Device(_) => {
                let again = self.again.and_then(|again| again.moved_m(rows[at]));
                self.device_words(rows, at, again.map_or(far_mm, |far_m| 1e3 * far_m), &place)
            }
            Subject::Target(target) => match data.targets.get(target).and_then(Option::as_deref) {
                Some(name) if data.targets.len() > 1 => format!(
                    "from {place} on target `{name}` is shifted by {far_mm:.2} mm on the arm, and no other target is: \
                     its nest seems to have been knocked; give it another name from there on, or leave these rows out"
                ),
                _ => format!(
                    "from {place} on the target is shifted by {far_mm:.2} mm on the arm: it seems to have been moved; \
                     give it another name in a column `target` from there on, or calibrate each part by itself"
                ),
            },
        };
        let (before, after) = rows.split_at(at);
        Moved { statement, is_grave: true, parts: Parts::Sides([before.to_vec(), after.to_vec()]) }
    }

    /// The words for a device that was moved; at the first row of a file, that is what two files do not share.
    fn device_words(&self, rows: &[u32], at: usize, far_mm: f64, place: &str) -> String {
        let data = self.data;
        let file = |index: usize| {
            let file = data.observations[rows[index] as usize].source.file as usize;
            (file, data.files.get(file).map(|path| path.display().to_string()))
        };
        if let ((a, Some(before)), (b, Some(after))) = (file(at - 1), file(at))
            && a != b
            && self.device_free
            && data.station_count() == 1
        {
            return format!(
                "from {place} on the measurements are shifted by {far_mm:.2} mm: the files {before} and {after} do not share one \
                 device frame, the measuring device seems to have been moved between them; give each file its own with --frames per-file"
            );
        }
        let remedy = if self.device_free {
            "give the rows from there on another name in a column `instrument`, or calibrate each part by itself"
        } else {
            "calibrate each part by itself, or only one of them"
        };
        format!(
            "from {place} on the measurements are shifted by {far_mm:.2} mm: the measuring device or the target seems to have been \
             moved; {remedy}"
        )
    }
}
