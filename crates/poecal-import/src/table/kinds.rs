//! Measurements of other kinds than positions and orientations, each in columns of its own.

use std::fmt;

use super::roles::ColumnRole;
use poecal_model::measurement::{
    FUNCTIONS, FormCriterion, FunctionRow as TableRow, MeasurementColumns, MeasurementFunction, Quantity,
};

/// A kind of measurement: a measured function and its columns in a file.
#[derive(Clone, Copy)]
pub(crate) struct FunctionKind {
    pub(crate) function: &'static MeasurementFunction,
    pub(crate) columns: &'static MeasurementColumns,
}

impl fmt::Debug for FunctionKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.key())
    }
}

/// All kinds.
pub(crate) fn kinds() -> impl Iterator<Item = FunctionKind> {
    let of =
        |row: &'static TableRow| row.columns.iter().map(|columns| FunctionKind { function: row.function, columns });
    FUNCTIONS.iter().flat_map(of)
}

impl FunctionKind {
    /// The column without which a file has no such rows; for a kind of names only, the last of its names.
    pub(crate) fn key(&self) -> &'static str {
        let of = match self.columns.from {
            FormCriterion::Numbers { .. } => self.columns.numbers.first(),
            FormCriterion::Name { .. } => self.columns.places.last(),
        };
        of.copied().unwrap_or_default()
    }

    /// True if its numbers are required.
    pub(crate) fn needs_numbers(&self) -> bool {
        matches!(self.columns.from, FormCriterion::Numbers { .. })
    }

    /// The origin of its measurement, in words. The zero of readings belongs to an instrument, so that distances have another word.
    pub(crate) fn place_word(&self) -> &'static str {
        match self.columns.places.last() {
            Some(_) if self.function.zero_is_unknown && self.needs_numbers() => "anchor of changes",
            Some(place) => place,
            None => "instrument",
        }
    }

    /// Words of a column of words.
    pub(crate) fn words(column: &str) -> impl Iterator<Item = &'static str> {
        kinds().filter_map(|kind| kind.columns.word).filter(move |(name, _)| *name == column).map(|(_, word)| word)
    }
}

/// Names with a meaning in every file, beside those of joints.
pub(crate) fn our_names() -> impl Iterator<Item = &'static str> {
    ColumnRole::Ours.words().chain(names())
}

/// True if a name has a meaning in every file.
pub(crate) fn is_our_name(name: &str) -> bool {
    our_names().any(|ours| ours == name)
}

/// Names of the columns of all kinds.
fn names() -> impl Iterator<Item = &'static str> {
    let words = kinds().filter_map(|kind| kind.columns.word).map(|(column, _)| column);
    kinds().flat_map(|kind| kind.columns.numbers.iter().chain(kind.columns.places).copied()).chain(words)
}

/// The columns of a kind in a file: its numbers and standard deviations as indices of inputs, names and words as columns.
#[derive(Clone, Debug)]
pub(crate) struct KindColumns {
    pub(crate) kind: FunctionKind,
    pub(crate) numbers: Vec<usize>,
    pub(crate) sigmas: Vec<(Quantity, usize)>,
    /// Columns with the name of its anchor.
    pub(crate) places: Vec<usize>,
    pub(crate) word: Option<usize>,
}

impl KindColumns {
    /// The word for its anchor, and the columns that name it.
    pub(crate) fn place(&self) -> (&'static str, &[usize]) {
        (self.kind.place_word(), &self.places)
    }
}
