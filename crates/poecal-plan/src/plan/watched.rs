//! What is watched while rows arrive, and what is found of each.

use super::expected::ExpectedErrors;
use super::options::PlannedFit;
use poecal_model::measurement::Dataset;
use poecal_model::simulate::Kind;

/// What is watched.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WatchOptions {
    /// The fit that will be made, and what is believed of the noise; the number of configurations does not matter.
    pub fit: PlannedFit,
    /// Configurations to choose the next from, readings one after the other; random ones within the limits if there are none.
    pub candidates: Option<Vec<f64>>,
    /// Configurations in which the robot will work; random ones within the limits if there are none.
    pub workspace: Option<Vec<f64>>,
    /// Seed of what is random.
    pub seed: u64,
}

impl WatchOptions {
    /// The same for the kind of these rows: poses if one has an orientation, else points.
    #[must_use]
    pub fn for_rows(mut self, data: &Dataset) -> Self {
        let poses = data.observations.iter().any(|row| row.measurement.sees_orientation());
        self.fit.session.kind = if poses { Kind::POSE } else { Kind::POINT };
        self
    }
}

/// What a row that is not as expected looks like.
#[derive(Clone, Debug, PartialEq)]
pub enum Mistake {
    /// The measurement of the configuration before.
    Stale,
    /// A joint's reading with the wrong sign.
    Sign(String),
    /// A joint's reading that is off by so much, radians or metres.
    Joint(String, f64),
    /// A measurement that is off by so many metres, of unknown cause.
    Off(f64),
    /// The row repeats the one before, number by number.
    Repeats,
    /// A target that was moved by so many metres before so many rows ago.
    Moved(f64, usize),
}

/// A row that was judged.
#[derive(Clone, Debug, PartialEq)]
pub struct WatchedRow {
    /// Index of the row.
    pub row: usize,
    /// What it looks like, if it is not as expected; it is not fitted then.
    pub mistake: Option<Mistake>,
    /// How far it is from what was expected, as a share of what is named; `None` while too few rows are known.
    pub ratio: Option<f64>,
    /// Least error of a measurement that would have been named in this row for certain, metres.
    pub noticed_m: Option<f64>,
    /// Expected errors of a fit of the rows so far.
    pub now: Option<ExpectedErrors>,
    /// The same after ten more that are chosen best.
    pub after: Option<ExpectedErrors>,
    /// The configuration that gains most.
    pub next: Option<Vec<f64>>,
}
