//! Measurements of other kinds than positions and orientations, each in columns of its own.

use std::borrow::Cow;
use std::fmt;

use super::inputs::InputReader;
use super::roles::Role;
use crate::PlaneContact;
use crate::table::Row;
use poecal_model::measurement::{
    Columns, FUNCTIONS, From, Function, Measurement, Quantity, Row as TableRow, Stated,
};
use poecal_numerics::error::Result;

/// A kind of measurement: a function in a form of its own in files.
#[derive(Clone, Copy)]
pub(crate) struct Kind {
    pub(crate) function: &'static Function,
    pub(crate) columns: &'static Columns,
}

impl fmt::Debug for Kind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.key())
    }
}

/// All of them.
pub(crate) fn kinds() -> impl Iterator<Item = Kind> {
    let of =
        |row: &'static TableRow| row.columns.iter().map(|columns| Kind { function: row.function, columns });
    FUNCTIONS.iter().flat_map(of)
}

impl Kind {
    /// The column without which a file has no such rows: of one that names alone make, the last of its names.
    pub(crate) fn key(&self) -> &'static str {
        let of = match self.columns.from {
            From::Numbers { .. } => self.columns.numbers.first(),
            From::Name { .. } => self.columns.places.last(),
        };
        of.copied().unwrap_or_default()
    }

    /// Whether its numbers must be there.
    pub(crate) fn needs_numbers(&self) -> bool {
        matches!(self.columns.from, From::Numbers { .. })
    }

    /// What it is measured from, in words. The zero of readings is one of an instrument, so that distances have another one.
    pub(crate) fn place_word(&self) -> &'static str {
        match self.columns.places.last() {
            Some(_) if self.function.zero_is_unknown && self.needs_numbers() => "anchor of changes",
            Some(place) => place,
            None => "instrument",
        }
    }

    /// Words of a column of words.
    fn words(column: &str) -> impl Iterator<Item = &'static str> {
        kinds()
            .filter_map(|kind| kind.columns.word)
            .filter(move |(name, _)| *name == column)
            .map(|(_, word)| word)
    }
}

/// Names with a meaning in every file, beside those of joints.
pub(crate) fn our_names() -> impl Iterator<Item = &'static str> {
    Role::Ours.words().chain(names())
}

/// Whether a name has a meaning in every file.
pub(crate) fn is_our_name(name: &str) -> bool {
    our_names().any(|ours| ours == name)
}

/// Names of all their columns.
fn names() -> impl Iterator<Item = &'static str> {
    let words = kinds().filter_map(|kind| kind.columns.word).map(|(column, _)| column);
    kinds().flat_map(|kind| kind.columns.numbers.iter().chain(kind.columns.places).copied()).chain(words)
}

/// Where a file has a kind: its numbers and standard deviations as indices into the inputs, names and words as columns.
#[derive(Clone, Debug)]
pub(crate) struct KindColumns {
    pub(crate) kind: Kind,
    pub(crate) numbers: Vec<usize>,
    pub(crate) sigmas: Vec<(Quantity, usize)>,
    /// Columns with the name of its place.
    pub(crate) places: Vec<usize>,
    pub(crate) word: Option<usize>,
}

impl KindColumns {
    /// What its place is called, and the columns that name it.
    pub(crate) fn place(&self) -> (&'static str, &[usize]) {
        (self.kind.place_word(), &self.places)
    }

    /// Name of the place of a row; `None` if no cell names it.
    pub(crate) fn place_name<'r>(&self, row: &Row<'r>) -> Option<Cow<'r, str>> {
        let mut parts = self.places.iter().filter_map(|&at| row.cells.get(at)).map(|cell| cell.text());
        let first = parts.next()?;
        let joined = parts.fold(first, |all, part| match (all.is_empty(), part.is_empty()) {
            (true, _) => part,
            (false, true) => all,
            (false, false) => Cow::Owned(format!("{all}/{part}")),
        });
        Some(joined).filter(|name| !name.is_empty())
    }

    /// Whether the row's word is that of the kind; of none, the usual one.
    fn has_word(&self, row: &Row<'_>, usual: PlaneContact) -> Result<bool> {
        let Some((column, own)) = self.kind.columns.word else { return Ok(true) };
        let cell = self.word.and_then(|at| Some((at, row.cells.get(at)?.text())));
        let Some((at, text)) = cell.filter(|(_, text)| !text.is_empty()) else {
            return Ok(usual.word() == own);
        };
        if !Kind::words(column).any(|word| word == text) {
            let words: Vec<String> = Kind::words(column).map(|word| format!("`{word}`")).collect();
            let message = format!("found `{text}` in column `{column}`, expected {}", words.join(" or "));
            return Err(row.error(at, message));
        }
        Ok(text == own)
    }

    /// Whether a row has a measurement of the kind. `has_position` says whether it has a position too.
    pub(crate) fn is_measured(&self, row: &Row<'_>, inputs: &InputReader<'_>, has_position: bool) -> bool {
        let has_number = || self.numbers.iter().any(|&input| inputs.value(input).is_some());
        match self.kind.columns.from {
            From::Numbers { .. } => has_number(),
            From::Name { .. } => {
                let is_named = self
                    .places
                    .last()
                    .and_then(|&at| row.cells.get(at))
                    .is_some_and(|it| !it.text().is_empty());
                is_named && (!has_position || has_number())
            }
        }
    }

    /// Whether its numbers in a row are those of a lost beam.
    pub(crate) fn is_lost(&self, inputs: &InputReader<'_>) -> bool {
        self.kind.columns.from == (From::Numbers { above_zero: true })
            && self.numbers.iter().all(|&input| inputs.value(input) == Some(0.0))
    }

    /// The measurement of a row, with what the row states of its noise; `None` if it has none.
    pub(crate) fn measurement(
        &self,
        row: &Row<'_>,
        inputs: &InputReader<'_>,
        (has_position, usual): (bool, PlaneContact),
    ) -> Result<Option<(Measurement, Stated)>> {
        let Kind { function, columns } = self.kind;
        if !self.is_measured(row, inputs, has_position) || !self.has_word(row, usual)? {
            return Ok(None);
        }
        let mut numbers = vec![0.0; columns.numbers.len()];
        for (number, &input) in numbers.iter_mut().zip(&self.numbers) {
            let value = match (inputs.value(input), columns.from) {
                (Some(value), _) => value,
                (None, From::Name { .. }) => 0.0,
                (None, From::Numbers { .. }) => {
                    let expected = "all numbers of a measurement, or none";
                    return Err(inputs.error(row, input, "found an empty cell", expected));
                }
            };
            let is_size = columns.from == (From::Name { size: true }) && inputs.value(input).is_some();
            if (is_size || columns.from == (From::Numbers { above_zero: true })) && value <= 0.0 {
                let text = row.cells.get(inputs.column(input)).map_or("", |cell| cell.raw);
                let what =
                    if is_size { columns.numbers.first().copied() } else { Some(function.leading().name()) };
                let expected = format!("a {} above 0", what.unwrap_or("number"));
                return Err(inputs.error(row, input, &format!("found `{text}`"), &expected));
            }
            *number = value;
        }
        let mut stated = Stated::default();
        for &(quantity, input) in &self.sigmas {
            stated.set(quantity, inputs.sigma(row, Some(input))?);
        }
        Ok(Some(((columns.of)(&numbers), stated)))
    }
}
