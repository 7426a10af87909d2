//! Measurements of other kinds than positions and orientations, each in columns of its own.

use std::borrow::Cow;

use super::PlaneContact;
use super::inputs::InputReader;
use super::table::Row;
use super::units::Dimension;
use crate::error::Result;
use crate::measurement::{
    DirectionMeasurement, DistanceMeasurement, FlushMeasurement, HeightMeasurement, Measurement, Quantity,
    SocketMeasurement, Stated,
};
use crate::unit::Unit;

/// A kind of measurement. Standard deviations are in columns `sigma_` and the name of a quantity.
pub(super) struct Kind {
    /// What its numbers are of; the first is that of its numbers in columns.
    pub(super) quantities: &'static [Quantity],
    /// Columns of its numbers.
    pub(super) numbers: &'static [&'static str],
    /// Columns that name the place from which it is measured; two of them together.
    pub(super) places: &'static [&'static str],
    /// Column of a word that tells kinds apart, with the word of this one.
    word: Option<(&'static str, &'static str)>,
    /// Where its numbers come from.
    from: From,
    /// The measurement from its numbers, metres and radians; zero where none is in the row.
    of: fn(&[f64]) -> Measurement,
}

/// What makes a row one of a kind.
#[derive(Clone, Copy, PartialEq, Eq)]
enum From {
    /// Its numbers, all of them; where they are above 0, zero is a lost beam.
    Numbers { above_zero: bool },
    /// The name of its place, in a row without a position; its numbers, if there are any, else zero. A size is above 0.
    Name { size: bool },
}

/// All of them. A new one is an entry here.
pub(super) const KINDS: [Kind; 7] = [
    Kind {
        quantities: &[Quantity::Distance],
        numbers: &["distance"],
        places: &["anchor"],
        word: None,
        from: From::Numbers { above_zero: true },
        of: |numbers| Measurement::Distance(DistanceMeasurement::new(number(numbers, 0))),
    },
    Kind {
        quantities: &[Quantity::Distance],
        numbers: &["distance_change"],
        places: &["anchor"],
        word: None,
        from: From::Numbers { above_zero: false },
        of: |numbers| Measurement::Distance(DistanceMeasurement::from_unknown_zero(number(numbers, 0))),
    },
    Kind {
        quantities: &[Quantity::Distance],
        numbers: &["radius"],
        places: &["sphere"],
        word: None,
        from: From::Name { size: true },
        of: |numbers| {
            let radius = number(numbers, 0);
            let is_known = radius > 0.0;
            Measurement::Distance(if is_known {
                DistanceMeasurement::new(radius)
            } else {
                DistanceMeasurement::from_unknown_zero(0.0)
            })
        },
    },
    Kind {
        quantities: &[Quantity::Contact],
        numbers: &[],
        places: &["place", "socket"],
        word: None,
        from: From::Name { size: false },
        of: |_| Measurement::Socket(SocketMeasurement::default()),
    },
    Kind {
        quantities: &[Quantity::Height],
        numbers: &["height"],
        places: &["plane"],
        word: Some(("contact", "point")),
        from: From::Name { size: false },
        of: |numbers| Measurement::Height(HeightMeasurement { height: number(numbers, 0) }),
    },
    Kind {
        quantities: &[Quantity::Height, Quantity::Tilt],
        numbers: &["height"],
        places: &["plane"],
        word: Some(("contact", "flush")),
        from: From::Name { size: false },
        of: |numbers| {
            let height = number(numbers, 0);
            Measurement::Flush(FlushMeasurement { height, ..FlushMeasurement::default() })
        },
    },
    Kind {
        quantities: &[Quantity::Tilt],
        numbers: &["tilt_x", "tilt_y"],
        places: &["direction"],
        word: None,
        from: From::Numbers { above_zero: false },
        of: |numbers| {
            Measurement::Direction(DirectionMeasurement::of_tilts([number(numbers, 0), number(numbers, 1)]))
        },
    },
];

fn number(numbers: &[f64], at: usize) -> f64 {
    numbers.get(at).copied().unwrap_or(f64::NAN)
}

impl Kind {
    /// The quantity of its numbers.
    pub(super) fn quantity(&self) -> Quantity {
        self.quantities.first().copied().unwrap_or(Quantity::Position)
    }

    /// Dimension of its numbers.
    pub(super) fn dimension(&self) -> Dimension {
        match self.quantity().unit() {
            Unit::Metre => Dimension::Length,
            Unit::Radian => Dimension::Angle,
            Unit::One => Dimension::Number,
        }
    }

    /// The column without which a file has no such rows: of one that names alone make, the last of its names.
    pub(super) fn key(&self) -> &'static str {
        let of = match self.from {
            From::Numbers { .. } => self.numbers.first(),
            From::Name { .. } => self.places.last(),
        };
        of.copied().unwrap_or_default()
    }

    /// Whether its numbers must be there.
    pub(super) fn needs_numbers(&self) -> bool {
        matches!(self.from, From::Numbers { .. })
    }

    /// What it is measured from, in words. The zero of readings is one of an instrument, so that distances have another one.
    pub(super) fn place_word(&self) -> &'static str {
        match self.places.last() {
            Some(_) if self.numbers == ["distance_change"] => "anchor of changes",
            Some(place) => place,
            None => "instrument",
        }
    }

    /// The column of its word, and the word.
    pub(super) fn word(&self) -> Option<(&'static str, &'static str)> {
        self.word
    }

    /// Words of a column of words.
    fn words(column: &str) -> impl Iterator<Item = &'static str> {
        KINDS
            .iter()
            .filter_map(|kind| kind.word)
            .filter(move |(name, _)| *name == column)
            .map(|(_, word)| word)
    }
}

/// Names of all their columns.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    let words = KINDS.iter().filter_map(|kind| kind.word).map(|(column, _)| column);
    KINDS.iter().flat_map(|kind| kind.numbers.iter().chain(kind.places).copied()).chain(words)
}

/// Where a file has a kind: its numbers and standard deviations as indices into the inputs, names and words as columns.
#[derive(Clone, Debug)]
pub(super) struct KindColumns {
    /// Index of the kind.
    pub(super) kind: usize,
    pub(super) numbers: Vec<usize>,
    pub(super) sigmas: Vec<(Quantity, usize)>,
    /// Columns with the name of its place.
    pub(super) places: Vec<usize>,
    pub(super) word: Option<usize>,
}

impl KindColumns {
    fn kind(&self) -> Option<&'static Kind> {
        KINDS.get(self.kind)
    }

    /// What its place is called, and the columns that name it.
    pub(super) fn place(&self) -> (&'static str, &[usize]) {
        (self.kind().map_or("instrument", Kind::place_word), &self.places)
    }

    /// Name of the place of a row; `None` if no cell names it.
    pub(super) fn place_name<'r>(&self, row: &Row<'r>) -> Option<Cow<'r, str>> {
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
        let Some((column, own)) = self.kind().and_then(Kind::word) else { return Ok(true) };
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
    pub(super) fn is_measured(&self, row: &Row<'_>, inputs: &InputReader<'_>, has_position: bool) -> bool {
        let has_number = || self.numbers.iter().any(|&input| inputs.value(input).is_some());
        match self.kind().map(|kind| kind.from) {
            None => false,
            Some(From::Numbers { .. }) => has_number(),
            Some(From::Name { .. }) => {
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
    pub(super) fn is_lost(&self, inputs: &InputReader<'_>) -> bool {
        self.kind().is_some_and(|kind| kind.from == From::Numbers { above_zero: true })
            && self.numbers.iter().all(|&input| inputs.value(input) == Some(0.0))
    }

    /// The measurement of a row, with what the row states of its noise; `None` if it has none.
    pub(super) fn measurement(
        &self,
        row: &Row<'_>,
        inputs: &InputReader<'_>,
        (has_position, usual): (bool, PlaneContact),
    ) -> Result<Option<(Measurement, Stated)>> {
        let Some(kind) = self.kind() else { return Ok(None) };
        if !self.is_measured(row, inputs, has_position) || !self.has_word(row, usual)? {
            return Ok(None);
        }
        let mut numbers = vec![0.0; kind.numbers.len()];
        for (number, &input) in numbers.iter_mut().zip(&self.numbers) {
            let value = match (inputs.value(input), kind.from) {
                (Some(value), _) => value,
                (None, From::Name { .. }) => 0.0,
                (None, From::Numbers { .. }) => {
                    let expected = "all numbers of a measurement, or none";
                    return Err(inputs.error(row, input, "found an empty cell", expected));
                }
            };
            let is_size = kind.from == (From::Name { size: true }) && inputs.value(input).is_some();
            if (is_size || kind.from == (From::Numbers { above_zero: true })) && value <= 0.0 {
                let text = row.cells.get(inputs.column(input)).map_or("", |cell| cell.raw);
                let what = if is_size { kind.numbers.first().copied() } else { Some(kind.quantity().name()) };
                let expected = format!("a {} above 0", what.unwrap_or("number"));
                return Err(inputs.error(row, input, &format!("found `{text}`"), &expected));
            }
            *number = value;
        }
        let mut stated = Stated::default();
        for &(quantity, input) in &self.sigmas {
            stated.set(quantity, inputs.sigma(row, Some(input))?);
        }
        Ok(Some(((kind.of)(&numbers), stated)))
    }
}
