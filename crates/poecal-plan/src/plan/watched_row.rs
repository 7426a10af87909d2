//! Options of watching rows as they arrive, and the findings for each.

use super::error_curve::ExpectedErrors;
use super::options::PlannedFit;
use poecal_model::measurement::Dataset;
use poecal_model::simulate::SessionKind;

/// Options of a watched session.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WatchOptions {
    /// The future fit, and the prior belief in the noise; the number of configurations does not matter.
    pub fit: PlannedFit,
    /// Configurations to choose the next from, readings one after the other; random ones within the limits if there are none.
    pub candidates: Option<Vec<f64>>,
    /// Configurations of the robot's work; random ones within the limits if there are none.
    pub workspace: Option<Vec<f64>>,
    /// Seed of random choices.
    pub seed: u64,
}

impl WatchOptions {
    /// The options for the kind of these rows: poses if one has an orientation, else points.
    #[must_use]
    pub fn for_rows(mut self, data: &Dataset) -> Self {
        let poses = data.observations.iter().any(|row| row.measurement.sees_orientation());
        self.fit.session.kind = if poses { SessionKind::POSE } else { SessionKind::POINT };
        self
    }
}

/// Apparent mistake in an unexpected row.
#[derive(Clone, Debug, PartialEq)]
pub enum Mistake {
    /// The measurement of the configuration before.
    Stale,
    /// A joint's reading with the wrong sign.
    Sign(String),
    /// A joint's reading with this error, radians or metres.
    Joint(String, f64),
    /// A measurement with an error of this many metres, of unknown cause.
    Off(f64),
    /// The row repeats the one before, number by number.
    Repeats,
    /// A target that was moved by this many metres, this many rows ago.
    Moved(f64, usize),
}

/// A row that was judged.
#[derive(Clone, Debug, PartialEq)]
pub struct WatchedRow {
    /// Index of the row.
    pub row: usize,
    /// Apparent mistake, if the row is unexpected; it is not fitted then.
    pub mistake: Option<Mistake>,
    /// Deviation of the row from its prediction, relative to the reporting limit; `None` while too few rows are known.
    pub ratio: Option<f64>,
    /// Least error of a measurement that would certainly have been reported in this row, metres.
    pub noticed_m: Option<f64>,
    /// Expected errors of a fit of the rows so far.
    pub now: Option<ExpectedErrors>,
    /// Expected errors after ten more rows that are chosen best.
    pub after: Option<ExpectedErrors>,
    /// The configuration with the largest gain.
    pub next: Option<Vec<f64>>,
}
