//! Device frames that differ by so much that no one model describes the rows: of files that were measured from different places and
//! fitted as if from one, and of the two parts of a session.

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
/// Rows in which two parts are looked for, at least; the first and the last of so many parts are taken for rows of one frame each.
const FEWEST_TO_PART: usize = 32;
const PARTS: usize = 4;
/// How many times less a fit with a frame for each must leave.
const BETTER: f64 = 3.0;

/// Rows with device frames of their own.
pub(in crate::calibration) struct FramesApart {
    /// What it is, and what to do.
    statement: String,
    /// The data with a place of the device for each frame.
    pub(in crate::calibration) data: Dataset,
    /// What a fit of these finds.
    pub(in crate::calibration) estimate: Estimate,
}

impl FramesApart {
    /// What is said of it.
    pub(in crate::calibration) fn moved(&self) -> Moved {
        Moved { statement: self.statement.clone(), is_grave: true, parts: Parts::Frames }
    }
}

/// A session that one device frame may not describe.
#[derive(Clone, Copy)]
pub(in crate::calibration) struct Doubtful<'a> {
    pub(in crate::calibration) robot: &'a Robot,
    pub(in crate::calibration) data: &'a Dataset,
    pub(in crate::calibration) packed: &'a Packed,
    /// The fitted rows, in order.
    pub(in crate::calibration) rows: &'a [u32],
    pub(in crate::calibration) noise: Noise,
    pub(in crate::calibration) length_m: f64,
    pub(in crate::calibration) options: &'a CalibrationOptions,
    /// What is left now, root mean square, metres.
    pub(in crate::calibration) left_m: f64,
}

/// Fits with a device frame for each file, or for each part of the session, and compares what that leaves with what is left now.
pub(in crate::calibration) fn frames_apart(doubtful: &Doubtful<'_>) -> Option<FramesApart> {
    if doubtful.data.station_count() > 1 {
        return None;
    }
    doubtful.files_apart().or_else(|| doubtful.parts_apart())
}

impl Doubtful<'_> {
    fn files_apart(&self) -> Option<FramesApart> {
        let data = self.by_file()?;
        let names: Vec<String> = data.files.iter().map(|path| path.display().to_string()).collect();
        let names = match names.as_slice() {
            [a, b] => format!("{a} and {b}"),
            [first, .., last] => format!("{first} to {last}"),
            _ => return None,
        };
        let (estimate, own_m) = self.fitted(&data);
        let left = self.better(own_m)?;
        let statement = format!(
            "the files {names} do not share one device frame: with a frame for each, {left}; the measuring device seems to have been moved \
             between them; calibrate with --frames per-file"
        );
        Some(FramesApart { statement, data, estimate })
    }

    /// The data with a place of the device for each file; none unless several files have rows enough.
    fn by_file(&self) -> Option<Dataset> {
        let files = self.data.files.len();
        if !(2..=MOST_FILES).contains(&files) {
            return None;
        }
        let mut apart = self.data.clone();
        apart.stations = apart.files.iter().map(|path| Some(path.display().to_string())).collect();
        apart.observations.iter_mut().for_each(|row| row.station = row.source.file as usize);
        let enough = (0..files).all(|file| apart.seen_from(file, self.rows).len() >= FEWEST_ROWS);
        enough.then_some(apart)
    }

    fn parts_apart(&self) -> Option<FramesApart> {
        let count = self.rows.len();
        if count < FEWEST_TO_PART {
            return None;
        }
        let first = self.registered(self.data, &self.rows[..count / PARTS]);
        let last = self.registered(self.data, &self.rows[count - count / PARTS..]);
        let mut at = self.parted(&first, &last);
        let mut data = self.in_parts(at);
        let (mut estimate, mut own_m) = self.fitted(&data);
        // Screws that fit tell the rows about the place apart.
        let better = self.parted(&estimate.seen_from(0), &estimate.seen_from(1));
        if better != at {
            at = better;
            data = self.in_parts(at);
            (estimate, own_m) = self.fitted(&data);
        }
        let left = self.better(own_m)?;
        let statement = format!(
            "from {} on the measurements are in another device frame: with one frame before and another from there on, {left}; the \
             measuring device seems to have been moved, by {:.0} mm as seen at the robot; give the rows from there on another name in a \
             column `instrument`, or calibrate each part by itself",
            self.data.place(self.rows[at]),
            1e3 * self.far_m(at, &estimate)
        );
        Some(FramesApart { statement, data, estimate })
    }

    /// How far the device was moved before a row, by a fit with a frame for the rows before and one for the others, metres.
    pub(in crate::calibration) fn moved_m(&self, first: u32) -> Option<f64> {
        let at = self.rows.partition_point(|&row| row < first);
        if self.data.station_count() > 1 || at < FEWEST_ROWS || self.rows.len() - at < FEWEST_ROWS {
            return None;
        }
        let (estimate, own_m) = self.fitted(&self.in_parts(at));
        own_m.is_finite().then(|| self.far_m(at, &estimate))
    }

    /// How far the frame after the fitted row of this index is from that before, where the robot is, metres.
    fn far_m(&self, at: usize, estimate: &Estimate) -> f64 {
        let [before, after] = [0, 1].map(|station| *estimate.device(station));
        let middle = before.inverse().act(&self.data.mean_position(&self.rows[..at]));
        (after.act(&middle) - before.act(&middle)).norm()
    }

    /// The data with a place of the device for the rows before the fitted one of this index, and another from there on.
    fn in_parts(&self, at: usize) -> Dataset {
        let mut apart = self.data.clone();
        apart.stations = vec![Some("before".to_owned()), Some("after".to_owned())];
        for (row, observation) in apart.observations.iter_mut().enumerate() {
            observation.station = usize::from(row >= self.rows[at] as usize);
        }
        apart
    }

    /// From where on the second of two estimates is the better one: by ratios of errors, so that no row decides alone.
    fn parted(&self, first: &Estimate, second: &Estimate) -> usize {
        let errors = [first, second].map(|it| row_errors(self.data, self.packed, self.rows, it));
        let log = |error: &super::RowError| error.position_m.norm().max(f64::MIN_POSITIVE).ln();
        let gains = errors[0].iter().zip(&errors[1]).map(|(a, b)| log(a) - log(b));
        let (mut sum, mut least, mut best) = (0.0, f64::INFINITY, FEWEST_ROWS);
        for (index, gain) in gains.enumerate() {
            if index >= FEWEST_ROWS && index + FEWEST_ROWS <= self.rows.len() && sum < least {
                (least, best) = (sum, index);
            }
            sum += gain;
        }
        best
    }

    fn registered(&self, data: &Dataset, rows: &[u32]) -> Estimate {
        let registration = Registration {
            data,
            packed: self.packed,
            rows,
            noise: self.noise,
            length_m: self.length_m,
            device_free: true,
            targets_free: true,
        };
        register(&registration, &delivered(self.robot, data)).0
    }

    /// A fit, and the root mean square of what it leaves, metres.
    fn fitted(&self, data: &Dataset) -> (Estimate, f64) {
        let mut start = self.registered(data, self.rows);
        start.recentre(data, self.packed, self.rows);
        let (packed, options) = (self.packed, self.options);
        let prior = options.believed().map(|tolerance| Prior::new(self.robot, tolerance, true));
        let prior = prior.as_ref().map(|prior| (prior, 1.0));
        let (noise, length_m) = (self.noise, self.length_m);
        let (estimate, ..) = fit_screws(data, packed, self.rows, start, noise, length_m, prior, options);
        let errors = row_errors(data, packed, self.rows, &estimate);
        let squares: f64 = errors.iter().map(|error| error.position_m.norm_squared()).sum();
        let own_m = (squares / self.rows.len().max(1) as f64).sqrt();
        (estimate, own_m)
    }

    /// What is left, in words, if it is so much less that it is no chance.
    fn better(&self, own_m: f64) -> Option<String> {
        let is_better = BETTER * own_m <= self.left_m;
        is_better.then(|| {
            format!("the residual is {:.3} mm (RMS) instead of {:.1} mm", 1e3 * own_m, 1e3 * self.left_m)
        })
    }
}
