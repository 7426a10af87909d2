//! Doubts about rows as they were read, by the nominal robot: units, turns, boards, and what was joined (docs/file-formats.md, "Measurements").
//!
//! Each rule gets numbers with what is known of their columns, and answers with a [`Doubt`]: one sentence with its evidence, and where it shows. Those
//! who read files refuse it at its place.

pub mod boards;
pub mod joined;
pub mod joint_units;
pub mod lengths;
pub mod picture_sizes;
pub mod spread;
pub mod turns;

use std::path::Path;

use poecal_numerics::error::{Error, ErrorKind};
use poecal_numerics::named_unit::{NamedUnit, UnitSource};

/// Least share of rows with implausible values: a few corrupt rows are no wrong unit.
pub const SHARE: f64 = 0.1;

/// A column of numbers as it was read.
#[derive(Clone, Copy, Debug)]
pub struct ReadColumn<'a> {
    /// Its name in a header of ours.
    pub name: &'a str,
    /// Its unit.
    pub unit: NamedUnit,
    /// What says the unit.
    pub unit_from: UnitSource,
    /// Smallest and largest number (m, rad).
    pub range: Option<(f64, f64)>,
}

/// What is most likely wrong with what was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Doubt {
    /// Where it shows.
    pub place: DoubtPlace,
    /// What was found and is expected, with what to do.
    pub message: String,
}

/// Where a doubt shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DoubtPlace {
    /// Line and column (characters, from 1) of a cell.
    Cell(usize, usize),
    /// A line of the file.
    Line(usize),
    /// The head of a column, by its number among those that were read.
    Head(usize),
}

impl Doubt {
    /// A doubt at a place.
    #[must_use]
    pub fn new(place: DoubtPlace, message: String) -> Self {
        Doubt { place, message }
    }

    /// The error of a file; without the place of a column's head, which those know who read it.
    #[must_use]
    pub fn error(self, kind: ErrorKind, path: &Path) -> Error {
        let error = kind.error(self.message);
        match self.place {
            DoubtPlace::Cell(line, column) => error.at(path, line, column),
            DoubtPlace::Line(line) => error.at_line(path, line),
            DoubtPlace::Head(_) => error.in_file(path),
        }
    }
}

/// How to state a unit beside the header: where a column states none, by an option.
fn state_it(unit_from: UnitSource, symbol: &str) -> String {
    match unit_from {
        UnitSource::Si | UnitSource::Maker => format!("say --units {symbol}"),
        UnitSource::Header | UnitSource::UnitsLine | UnitSource::Mapping => {
            "the unit in the mapping".to_owned()
        }
    }
}

/// A number to four significant digits.
fn short(value: f64) -> String {
    format!("{value:.3e}").parse::<f64>().unwrap_or(value).to_string()
}
