//! Measurements of a few numbers, each in columns of its own, beside positions and orientations.

use super::inputs::InputReader;
use super::table::Row;
use super::units::Dimension;
use crate::error::Result;
use crate::measurement::{DistanceMeasurement, Measurement, Quantity};
use crate::unit::Unit;

/// A kind of measurement: its numbers are in the columns that [`Quantity::component_names`] names, their standard deviation is in `sigma_` and the
/// quantity's name.
pub(super) struct Kind {
    pub(super) quantity: Quantity,
    /// The column that names the place from which it is measured, in place of `instrument`.
    pub(super) place: &'static str,
    /// Whether its numbers are above 0; then 0 is a lost beam.
    pub(super) is_above_zero: bool,
    /// The measurement from its numbers, metres and radians.
    pub(super) of: fn(&[f64]) -> Measurement,
}

/// All of them. A new one is a line here.
pub(super) const KINDS: [Kind; 1] = [Kind {
    quantity: Quantity::Distance,
    place: "anchor",
    is_above_zero: true,
    of: |numbers| {
        Measurement::Distance(DistanceMeasurement { distance: numbers.first().copied().unwrap_or(f64::NAN) })
    },
}];

impl Kind {
    /// Names of its columns.
    pub(super) fn names(&self) -> &'static [&'static str] {
        self.quantity.component_names()
    }

    /// Dimension of its numbers.
    pub(super) fn dimension(&self) -> Dimension {
        match self.quantity.unit() {
            Unit::Metre => Dimension::Length,
            Unit::Radian => Dimension::Angle,
            Unit::One => Dimension::Number,
        }
    }
}

/// Names of all their columns.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    KINDS.iter().flat_map(|kind| kind.names().iter().copied().chain([kind.place]))
}

/// Where a file has the numbers of a kind: indices into the inputs.
#[derive(Clone, Debug)]
pub(super) struct KindColumns {
    /// Index of the kind.
    kind: usize,
    numbers: Vec<usize>,
    sigma: Option<usize>,
    /// Column with the name of its place.
    place: Option<usize>,
}

impl KindColumns {
    /// Of a kind by its index.
    pub(super) fn new(kind: usize, numbers: Vec<usize>, sigma: Option<usize>, place: Option<usize>) -> Self {
        KindColumns { kind, numbers, sigma, place }
    }

    /// Name and column of its place.
    pub(super) fn place(&self) -> Option<(&'static str, usize)> {
        Some((KINDS.get(self.kind)?.place, self.place?))
    }

    /// The inputs of its numbers.
    pub(super) fn numbers(&self) -> &[usize] {
        &self.numbers
    }

    /// Whether a row has any of its numbers.
    pub(super) fn is_measured(&self, inputs: &InputReader<'_>) -> bool {
        self.numbers.iter().any(|&input| inputs.value(input).is_some())
    }

    /// Whether its numbers in a row are those of a lost beam.
    pub(super) fn is_lost(&self, inputs: &InputReader<'_>) -> bool {
        let is_above_zero = KINDS.get(self.kind).is_some_and(|kind| kind.is_above_zero);
        is_above_zero && self.numbers.iter().all(|&input| inputs.value(input) == Some(0.0))
    }

    /// The measurement of a row, with its quantity and stated standard deviation; `None` if all its cells are empty.
    pub(super) fn measurement(
        &self,
        row: &Row<'_>,
        inputs: &InputReader<'_>,
    ) -> Result<Option<(Measurement, Quantity, Option<f64>)>> {
        let Some(kind) = KINDS.get(self.kind).filter(|_| self.is_measured(inputs)) else { return Ok(None) };
        let mut numbers = Vec::with_capacity(self.numbers.len());
        for &input in &self.numbers {
            let expected = "all numbers of a measurement, or none";
            let missing = || inputs.error(row, input, "found an empty cell", expected);
            let number = inputs.value(input).ok_or_else(missing)?;
            if kind.is_above_zero && number <= 0.0 {
                let text = row.cells.get(inputs.column(input)).map_or("", |cell| cell.raw);
                let expected = format!("a {} above 0", kind.quantity.name());
                return Err(inputs.error(row, input, &format!("found `{text}`"), &expected));
            }
            numbers.push(number);
        }
        Ok(Some(((kind.of)(&numbers), kind.quantity, inputs.sigma(row, self.sigma)?)))
    }
}
