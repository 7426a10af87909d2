//! Files that were measured with the device at different places and fitted as if it had stood at one.

use super::super::{CalibrationOptions, delivered, fit_screws, row_errors};
use super::{Moved, Parts};
use crate::estimate::{Estimate, Packed};
use crate::measurement::{Dataset, Noise};
use crate::problem::Prior;
use crate::robot::Robot;
use crate::start::{Registration, register};

/// Files whose frames are looked for, at most, and rows that each has at least.
const MOST_FILES: usize = 20;
const FEWEST_ROWS: usize = 4;
/// How many times less a fit with a frame for each file must leave.
const BETTER: f64 = 3.0;

/// Files with device frames of their own.
pub(in crate::calibration) struct FilesApart {
    /// What it is, and what to do.
    statement: String,
    /// The data with a place of the device for each file.
    pub(in crate::calibration) data: Dataset,
    /// What a fit of these finds.
    pub(in crate::calibration) estimate: Estimate,
}

impl FilesApart {
    /// What is said of it.
    pub(in crate::calibration) fn moved(&self) -> Moved {
        Moved { statement: self.statement.clone(), is_grave: true, parts: Parts::Files }
    }
}

/// Fits with a device frame for each file, and compares what that leaves with what is left now (root mean square, metres).
pub(in crate::calibration) fn files_apart(
    robot: &Robot,
    (data, packed): (&Dataset, &Packed),
    rows: &[u32],
    (noise, length_m): (Noise, f64),
    left_m: f64,
    options: &CalibrationOptions,
) -> Option<FilesApart> {
    let apart = by_file(data, rows)?;
    let start = delivered(robot, &apart);
    let registration =
        Registration { data: &apart, packed, rows, noise, length_m, device_free: true, targets_free: true };
    let mut registered = register(&registration, &start).0;
    registered.recentre(&apart, packed, rows);
    let prior = options.believed().map(|tolerance| Prior::new(robot, tolerance, true));
    let prior = prior.as_ref().map(|prior| (prior, 1.0));
    let (estimate, ..) = fit_screws(&apart, packed, rows, registered, noise, length_m, prior, options);
    let errors = row_errors(&apart, packed, rows, &estimate);
    let squares: f64 = errors.iter().map(|error| error.position_m.norm_squared()).sum();
    let own_m = (squares / rows.len().max(1) as f64).sqrt();
    if own_m.is_nan() || BETTER * own_m > left_m {
        return None;
    }
    let names: Vec<String> = apart.files.iter().map(|path| path.display().to_string()).collect();
    let names = match names.as_slice() {
        [a, b] => format!("{a} and {b}"),
        [first, .., last] => format!("{first} to {last}"),
        _ => return None,
    };
    let statement = format!(
        "the files {names} do not share one device frame: with a frame for each, the fit leaves {:.3} mm (RMS) instead of {:.1} mm; the \
         measuring device seems to have been moved between them; calibrate with --frames per-file",
        1e3 * own_m,
        1e3 * left_m
    );
    Some(FilesApart { statement, data: apart, estimate })
}

/// The data with a place of the device for each file; none unless several files have rows enough.
fn by_file(data: &Dataset, rows: &[u32]) -> Option<Dataset> {
    let files = data.files.len();
    if data.station_count() > 1 || !(2..=MOST_FILES).contains(&files) {
        return None;
    }
    let mut apart = data.clone();
    apart.stations = data.files.iter().map(|path| Some(path.display().to_string())).collect();
    apart.observations.iter_mut().for_each(|row| row.station = row.source.file as usize);
    let enough = (0..files).all(|file| apart.seen_from(file, rows).len() >= FEWEST_ROWS);
    enough.then_some(apart)
}
