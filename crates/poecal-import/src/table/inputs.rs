//! Numbers of a row, made of columns, in metres and radians.

use poecal_numerics::named_unit::{NamedUnit, UnitSource};

/// A number in each row.
#[derive(Clone, Debug)]
pub(crate) struct RowInput {
    /// Name in our form.
    pub(crate) name: String,
    /// Name in messages: the file's column; for a constant our name.
    pub(crate) label: String,
    pub(crate) source: InputSource,
    pub(crate) unit: NamedUnit,
    pub(crate) unit_from: UnitSource,
    /// Columns of a sum; `source` is the first of them.
    pub(crate) sum: Vec<SumTerm>,
    /// Offset that is added to a sum (metres, radians).
    pub(crate) offset: f64,
}

impl RowInput {
    /// The columns, each with its factor; empty for a constant.
    pub(crate) fn terms(&self) -> Vec<SumTerm> {
        match self.source {
            InputSource::Column(column) if self.sum.is_empty() => {
                vec![SumTerm { column, unit: self.unit, factor: 1.0 }]
            }
            InputSource::Column(_) => self.sum.clone(),
            InputSource::Constant(_) => Vec::new(),
        }
    }

    /// The file's column, or the first one of a sum; 0 for a constant.
    pub(crate) fn column(&self) -> usize {
        match self.source {
            InputSource::Column(column) => column,
            InputSource::Constant(_) => 0,
        }
    }

    /// Offset that is added to the columns (metres, radians); for a constant, its value.
    pub(crate) fn added_constant(&self) -> f64 {
        match self.source {
            InputSource::Column(_) => self.offset,
            InputSource::Constant(value) => value,
        }
    }
}

/// A column of a sum.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SumTerm {
    pub(crate) column: usize,
    pub(crate) unit: NamedUnit,
    pub(crate) factor: f64,
}

/// Source of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum InputSource {
    /// Index of the file's column.
    Column(usize),
    /// Constant (metres, radians).
    Constant(f64),
}

/// Smallest and largest value so far.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ValueRange(pub(crate) Option<(f64, f64)>);

impl ValueRange {
    pub(crate) fn include(&mut self, value: f64) {
        let (min, max) = self.0.unwrap_or((value, value));
        self.0 = Some((min.min(value), max.max(value)));
    }
}
