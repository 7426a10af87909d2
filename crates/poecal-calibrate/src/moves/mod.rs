//! Change points and drift within a session: the device or a target was moved, or either moved slowly (theory.md §9, *Change points*).

mod frames;
mod series;

pub(crate) use frames::{FrameSearch, SeparateFrames, frames_apart};

use nalgebra::Vector3;

use super::{Robustness, RowError};
use poecal_fit::state::{Estimate, Linkage, PackedValues, RowChain, Session, sample_rows};
use poecal_model::measurement::Quantity;
use series::{ErrorSeries, SeriesChange};

/// Most rows of the search: with fewer a change still shows, and its position is determined to a few rows.
const MOST_ROWS: usize = 20_000;
/// Least share of the suspected rows that a change explains if it is their cause.
const EXPLAINED: f64 = 0.8;

/// A change point, drift, or difference of device frames.
pub(crate) struct DetectedMove {
    /// Moved object, first row, distance, and advice.
    pub(crate) statement: String,
    /// True if the result must not be used.
    pub(crate) is_grave: bool,
    kind: ChangeKind,
}

/// Kind of a change.
enum ChangeKind {
    /// Different device frames.
    Frames,
    /// A step between two rows.
    Step([Vec<u32>; 2]),
    /// A drift.
    Drift,
}

impl DetectedMove {
    /// True if device frames differ so much that no single model describes the rows.
    pub(crate) fn is_of_frames(&self) -> bool {
        matches!(self.kind, ChangeKind::Frames)
    }

    /// True if the suspected rows are those on one side of the change.
    pub(crate) fn explains(&self, robustness: &Robustness) -> bool {
        match &self.kind {
            ChangeKind::Frames => true,
            ChangeKind::Drift => false,
            ChangeKind::Step(sides) => {
                let within =
                    |side: &Vec<u32>| robustness.suspects().filter(|row| side.binary_search(row).is_ok()).count();
                let most = sides.iter().map(within).max().unwrap_or(0);
                most as f64 >= EXPLAINED * robustness.suspects().count() as f64
            }
        }
    }
}

/// A finished fit, and the rows to be searched in the order measured.
#[derive(Clone, Copy)]
pub(crate) struct ChangeSearch<'a> {
    pub(crate) session: Session<'a>,
    pub(crate) estimate: &'a Estimate,
    pub(crate) rows: &'a [u32],
    /// A fit with a device frame for each side of a step, for a better estimate of the distance.
    pub(crate) again: Option<&'a FrameSearch<'a>>,
}

/// Moved object of a series of errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MovedObject {
    /// The device at one station.
    Device(usize),
    /// A target.
    Target(usize),
}

/// The change that explains most of the squared errors, if it is significant.
pub(crate) fn find_move(search: &ChangeSearch<'_>) -> Option<DetectedMove> {
    let rows = sample_rows(search.rows, MOST_ROWS);
    let errors = search.session.errors(&rows, search.estimate);
    let mut found: Option<(MovedObject, Vec<u32>, SeriesChange)> = None;
    let mut consider = |subject: MovedObject, series: ErrorSeries| {
        let change = series.change(matches!(subject, MovedObject::Device(_)));
        if let Some(change) = change
            && found.as_ref().is_none_or(|(_, _, best)| change.explained > best.explained)
        {
            found = Some((subject, series.rows, change));
        }
    };
    for station in 0..search.session.data.station_count() {
        consider(MovedObject::Device(station), of_device(search, &rows, &errors, station));
    }
    for (target, series) in of_targets(search, &rows, &errors).into_iter().enumerate() {
        consider(MovedObject::Target(target), series);
    }
    let (subject, rows, change) = found?;
    Some(search.move_of_change(subject, &rows, &change))
}

/// Errors of the rows of one station, in the device's axes.
fn of_device(search: &ChangeSearch<'_>, rows: &[u32], errors: &[RowError], station: usize) -> ErrorSeries {
    let own = rows.iter().zip(errors);
    let own = own.filter(|(row, error)| search.session.observation(**row).station == station && is_position(error));
    let (rows, values): (Vec<u32>, Vec<Vector3<f64>>) = own.map(|(&row, error)| (row, error.lead())).unzip();
    let configurations = rows.iter().map(|&row| shapes(search.session.packed, row as usize)).collect();
    ErrorSeries { rows, values, configurations }
}

/// True if an error has a direction in space.
fn is_position(error: &RowError) -> bool {
    error.leading_quantity() == Some(Quantity::Position)
}

/// Functions of the joint values, which keep errors of the robot apart from a drift.
fn shapes(packed: &PackedValues, row: usize) -> Vec<f64> {
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

/// Errors of the rows of each target, in the axes of the last link.
fn of_targets(search: &ChangeSearch<'_>, rows: &[u32], errors: &[RowError]) -> Vec<ErrorSeries> {
    let mut series: Vec<ErrorSeries> = vec![ErrorSeries::default(); search.session.data.targets.len()];
    let linkage = Linkage::new(search.estimate);
    let mut chain = RowChain::default();
    for (&row, error) in rows.iter().zip(errors) {
        let seen = search.session.observation(row);
        chain.evaluate(&linkage, search.session.packed, row as usize, seen);
        if let Some(own) = series.get_mut(seen.target).filter(|_| is_position(error)) {
            own.rows.push(row);
            own.values.push(chain.target.rotation.transpose() * error.lead());
        }
    }
    series
}

impl ChangeSearch<'_> {
    fn move_of_change(&self, subject: MovedObject, rows: &[u32], change: &SeriesChange) -> DetectedMove {
        let (data, far_mm) = (self.session.data, 1e3 * change.distance_m);
        let Some(at) = change.at else {
            let (first, last) = (rows.first().copied().unwrap_or(0), rows.last().copied().unwrap_or(0));
            let statement = format!(
                "the measurements drift by {far_mm:.2} mm from {} to {}, steadily with time: the measuring device, the robot or its tool \
                 was still warming up or settling; measure again when they have, or in shorter sessions",
                data.place(first),
                data.place(last)
            );
            return DetectedMove { statement, is_grave: change.distance_m > change.left_m, kind: ChangeKind::Drift };
        };
        let place = data.place(rows[at]);
        let statement = match subject {
            MovedObject::Device(_) => {
                let again = self.again.and_then(|again| again.moved_m(rows[at]));
                self.device_words(rows, at, again.map_or(far_mm, |far_m| 1e3 * far_m), &place)
            }
            MovedObject::Target(target) => match data.targets.get(target).and_then(Option::as_deref) {
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
        DetectedMove { statement, is_grave: true, kind: ChangeKind::Step([before.to_vec(), after.to_vec()]) }
    }

    /// Description of a moved device; at the first row of a file, a description of files without a common device frame.
    fn device_words(&self, rows: &[u32], at: usize, far_mm: f64, place: &str) -> String {
        let data = self.session.data;
        let file = |index: usize| {
            let file = data.observations[rows[index] as usize].source.file as usize;
            (file, data.files.get(file).map(|path| path.display().to_string()))
        };
        if let ((a, Some(before)), (b, Some(after))) = (file(at - 1), file(at))
            && a != b
            && self.session.device_free
            && data.station_count() == 1
        {
            return format!(
                "from {place} on the measurements are shifted by {far_mm:.2} mm: the files {before} and {after} do not share one \
                 device frame, the measuring device seems to have been moved between them; give each file its own with --device-frames per-file"
            );
        }
        let remedy = if self.session.device_free {
            "name the rows from there on otherwise in a column `instrument`, or calibrate each part by itself"
        } else {
            "calibrate each part by itself, or only one of them"
        };
        format!(
            "from {place} on the measurements are shifted by {far_mm:.2} mm: the measuring device or the target seems to have been \
             moved; {remedy}"
        )
    }
}
