//! Device frames so different that no single model describes the rows: frames of files that were measured from different stations and fitted as from
//! one, and of two parts of a session.

use super::super::{CalibrationOptions, fit_screws, nominal_estimate};
use super::{ChangeKind, DetectedMove};
use poecal_fit::start::{Registration, register};
use poecal_fit::state::{Estimate, Session, rms_m};
use poecal_model::measurement::{Dataset, Noise};

/// Most files whose frames are compared, and fewest rows of each.
const MOST_FILES: usize = 20;
const FEWEST_ROWS: usize = 4;
/// Fewest rows of a session in two parts, and the number of its parts: the first and the last are assumed to have one frame each.
const FEWEST_TO_PART: usize = 32;
const PARTS: usize = 4;
/// Least ratio by which a fit with separate frames must reduce the error.
const BETTER: f64 = 3.0;

/// Result of a fit with separate device frames.
pub(crate) struct SeparateFrames {
    /// Description and advice.
    statement: String,
    /// The data with a station for each frame.
    pub(crate) data: Dataset,
    /// Estimate by these data.
    pub(crate) estimate: Estimate,
}

impl SeparateFrames {
    /// The result as a warning.
    pub(crate) fn to_move(&self) -> DetectedMove {
        DetectedMove { statement: self.statement.clone(), is_grave: true, kind: ChangeKind::Frames }
    }
}

/// A fit with one unknown device frame, to be compared with one of several frames.
#[derive(Clone, Copy)]
pub(crate) struct FrameSearch<'a> {
    pub(crate) session: Session<'a>,
    /// The fitted rows, in order.
    pub(crate) rows: &'a [u32],
    pub(crate) noise: Noise,
    pub(crate) options: &'a CalibrationOptions,
    /// Root mean square position error of the fit, metres.
    pub(crate) left_m: f64,
}

/// Fits with a device frame for each file, or for each part of the session, and compares the errors (theory.md §9, *Change points*).
pub(crate) fn frames_apart(search: &FrameSearch<'_>) -> Option<SeparateFrames> {
    if search.session.data.station_count() > 1 {
        return None;
    }
    search.files_apart().or_else(|| search.parts_apart())
}

impl FrameSearch<'_> {
    fn files_apart(&self) -> Option<SeparateFrames> {
        let data = self.by_file()?;
        let names: Vec<String> = data.files.iter().map(|path| path.display().to_string()).collect();
        let names = match names.as_slice() {
            [a, b] => format!("{a} and {b}"),
            [first, .., last] => format!("{first} to {last}"),
            _ => return None,
        };
        let (estimate, own_m) = self.fit_rows(&data);
        let left = self.describe_improvement(own_m)?;
        let statement = format!(
            "the files {names} do not share one device frame: with a frame for each, {left}; the measuring device seems to have been moved \
             between them; calibrate with --device-frames per-file"
        );
        Some(SeparateFrames { statement, data, estimate })
    }

    /// The data with a station for each file; `None` unless several files have enough rows.
    fn by_file(&self) -> Option<Dataset> {
        let files = self.session.data.files.len();
        if !(2..=MOST_FILES).contains(&files) {
            return None;
        }
        let mut apart = self.session.data.clone();
        apart.stations = apart.files.iter().map(|path| Some(path.display().to_string())).collect();
        apart.observations.iter_mut().for_each(|row| row.station = row.source.file as usize);
        let enough = (0..files).all(|file| apart.seen_from(file, self.rows).len() >= FEWEST_ROWS);
        enough.then_some(apart)
    }

    fn parts_apart(&self) -> Option<SeparateFrames> {
        let count = self.rows.len();
        if count < FEWEST_TO_PART {
            return None;
        }
        let first = self.register(self.session.data, &self.rows[..count / PARTS]);
        let last = self.register(self.session.data, &self.rows[count - count / PARTS..]);
        let mut at = self.split_row(&first, &last);
        let mut data = self.in_parts(at);
        let (mut estimate, mut own_m) = self.fit_rows(&data);
        // Registrations of the two parts may overlap; fitted screws find the row exactly.
        let better = self.split_row(&estimate.seen_from(0), &estimate.seen_from(1));
        if better != at {
            at = better;
            data = self.in_parts(at);
            (estimate, own_m) = self.fit_rows(&data);
        }
        let left = self.describe_improvement(own_m)?;
        let statement = format!(
            "from {} on the measurements are in another device frame: with one frame before and another from there on, {left}; the \
             measuring device seems to have been moved, by {:.0} mm as seen at the robot; give the rows from there on another name in a \
             column `instrument`, or calibrate each part by itself",
            self.session.data.place(self.rows[at]),
            1e3 * self.far_m(at, &estimate)
        );
        Some(SeparateFrames { statement, data, estimate })
    }

    /// Distance by which the device was moved before a row, from a fit with separate frames before and after it, metres.
    pub(crate) fn moved_m(&self, first: u32) -> Option<f64> {
        let at = self.rows.partition_point(|&row| row < first);
        if self.session.data.station_count() > 1 || at < FEWEST_ROWS || self.rows.len() - at < FEWEST_ROWS {
            return None;
        }
        let (estimate, own_m) = self.fit_rows(&self.in_parts(at));
        own_m.is_finite().then(|| self.far_m(at, &estimate))
    }

    /// Distance between the frames before and after the fitted row of this index, at the robot, metres.
    fn far_m(&self, at: usize, estimate: &Estimate) -> f64 {
        let [before, after] = [0, 1].map(|station| *estimate.device(station));
        let middle = before.inverse().act(&self.session.data.mean_position(&self.rows[..at]));
        (after.act(&middle) - before.act(&middle)).norm()
    }

    /// The data with one station before the fitted row of this index, and another from there on.
    fn in_parts(&self, at: usize) -> Dataset {
        let mut apart = self.session.data.clone();
        apart.stations = vec![Some("before".to_owned()), Some("after".to_owned())];
        for (row, observation) in apart.observations.iter_mut().enumerate() {
            observation.station = usize::from(row >= self.rows[at] as usize);
        }
        apart
    }

    /// First row from which on the second of two estimates is better: by logarithms of errors, so that no single row decides.
    fn split_row(&self, first: &Estimate, second: &Estimate) -> usize {
        let errors = [first, second].map(|it| self.session.errors(self.rows, it));
        let log = |error: &super::RowError| error.length_m().max(f64::MIN_POSITIVE).ln();
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

    fn register(&self, data: &Dataset, rows: &[u32]) -> Estimate {
        let session = Session { data, noise_ratios: &[], ..self.session };
        let prior = self.options.prior(&session);
        let registration = Registration {
            session,
            rows,
            noise: self.noise,
            targets_free: true,
            prior: prior.as_ref().map(|it| (it, 1.0)),
        };
        register(&registration, &nominal_estimate(session.robot, data)).0
    }

    /// A fit, and its root mean square position error, metres.
    fn fit_rows(&self, data: &Dataset) -> (Estimate, f64) {
        let mut start = self.register(data, self.rows);
        let session = Session { data, noise_ratios: &[], ..self.session };
        start.recentre(&session, self.rows);
        let prior = self.options.prior(&session);
        let prior = prior.as_ref().map(|prior| (prior, 1.0));
        let (estimate, ..) = fit_screws(session, self.rows, start, self.noise, prior, self.options);
        let own_m = rms_m(&session.errors(self.rows, &estimate));
        (estimate, own_m)
    }

    /// Comparison of the errors in words, if the reduction is significant.
    fn describe_improvement(&self, own_m: f64) -> Option<String> {
        let is_better = BETTER * own_m <= self.left_m;
        is_better.then(|| format!("the residual is {:.3} mm (RMS) instead of {:.1} mm", 1e3 * own_m, 1e3 * self.left_m))
    }
}
