//! Doubts about rows as they were read, by the nominal robot: units, turns, boards, and joined data (docs/file-formats.md, "Measurements").
//!
//! Each rule takes numbers with the known facts of their columns, and returns a [`InputDoubt`]: one sentence with its evidence, and its place in the file.
//! The readers of files refuse it at that place.

pub mod boards;
pub mod joined_rows;
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
    /// Name in a header of poecal.
    pub name: &'a str,
    /// Unit.
    pub unit: NamedUnit,
    /// Source of the unit.
    pub unit_from: UnitSource,
    /// Smallest and largest number (m, rad).
    pub range: Option<(f64, f64)>,
}

/// Most likely mistake in the rows that were read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputDoubt {
    /// Place in the file.
    pub place: DoubtLocation,
    /// Message: found, expected, and remedy.
    pub message: String,
}

/// Place of a doubt in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DoubtLocation {
    /// Line and column (characters, from 1) of a cell.
    Cell(usize, usize),
    /// A line of the file.
    Line(usize),
    /// Head of a column, by its number among those that were read.
    Head(usize),
}

impl InputDoubt {
    /// Doubt at a place.
    #[must_use]
    pub fn new(place: DoubtLocation, message: String) -> Self {
        InputDoubt { place, message }
    }

    /// Error of a file; without the place of a column's head, which only the reader of the file knows.
    #[must_use]
    pub fn error(self, kind: ErrorKind, path: &Path) -> Error {
        let error = kind.error(self.message);
        match self.place {
            DoubtLocation::Cell(line, column) => error.at_position(path, line, column),
            DoubtLocation::Line(line) => error.at_line(path, line),
            DoubtLocation::Head(_) => error.in_file(path),
        }
    }
}

/// Remedy that states a unit beside the header: by an option if a column states none.
fn state_it(unit_from: UnitSource, symbol: &str) -> String {
    match unit_from {
        UnitSource::Si | UnitSource::Maker => format!("state --units {symbol}"),
        UnitSource::Header | UnitSource::UnitsLine | UnitSource::Mapping => "the unit in the mapping".to_owned(),
    }
}

/// A number to four significant digits.
fn format_short(value: f64) -> String {
    format!("{value:.3e}").parse::<f64>().unwrap_or(value).to_string()
}
