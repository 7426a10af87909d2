//! The numbers of a row, in metres and radians.

use super::header::Header;
use super::number::Numbers;
use crate::table::Row;
use poecal_fit::input_doubts::ReadColumn;
use poecal_fit::input_doubts::joint_units::JointWatch;
use poecal_numerics::error::{Error, Result};
use poecal_numerics::named_unit::{NamedUnit, UnitSource};
use poecal_numerics::unit::Unit;
use poecal_storage::numbers::LARGEST_NUMBER;

/// A number in each row.
#[derive(Clone, Debug)]
pub(crate) struct Input {
    /// Our name.
    pub(crate) name: String,
    /// Name in messages: the file's column; of a constant our name.
    pub(crate) label: String,
    pub(crate) source: InputSource,
    pub(crate) unit: NamedUnit,
    pub(crate) unit_from: UnitSource,
    /// Columns of a sum; `source` is the first of them.
    pub(crate) sum: Vec<Term>,
    /// What is added to a sum (metres, radians).
    pub(crate) offset: f64,
}

impl Input {
    /// The columns, each with its factor; none of a constant.
    pub(crate) fn terms(&self) -> Vec<Term> {
        match self.source {
            InputSource::Column(column) if self.sum.is_empty() => {
                vec![Term { column, unit: self.unit, factor: 1.0 }]
            }
            InputSource::Column(_) => self.sum.clone(),
            InputSource::Constant(_) => Vec::new(),
        }
    }

    /// What is added to the columns (metres, radians): of a constant, it itself.
    pub(crate) fn added(&self) -> f64 {
        match self.source {
            InputSource::Column(_) => self.offset,
            InputSource::Constant(value) => value,
        }
    }
}

/// A column of a sum.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Term {
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
pub(crate) struct Range(pub(crate) Option<(f64, f64)>);

impl Range {
    pub(crate) fn include(&mut self, value: f64) {
        let (min, max) = self.0.unwrap_or((value, value));
        self.0 = Some((min.min(value), max.max(value)));
    }
}

/// Reads the inputs of one row after the other into the same buffers.
pub(crate) struct InputReader<'a> {
    pub(crate) numbers: Numbers,
    /// Smallest and largest value of each input.
    pub(crate) ranges: Vec<Range>,
    inputs: &'a [Input],
    values: Vec<Option<f64>>,
    readings: Vec<f64>,
    /// Of each joint reading of the current row, the whole turns that were taken off.
    turns: Vec<f64>,
    /// Number of joint readings, which come first.
    joints: usize,
}

impl<'a> InputReader<'a> {
    /// For these inputs, the first `joints` of which are joint readings.
    pub(crate) fn new(inputs: &'a [Input], joints: usize, numbers: Numbers) -> Self {
        InputReader {
            numbers,
            joints,
            ranges: vec![Range::default(); inputs.len()],
            inputs,
            values: Vec::with_capacity(inputs.len()),
            readings: Vec::new(),
            turns: vec![0.0; joints],
        }
    }

    /// The row's standard deviation, if stated.
    pub(crate) fn sigma(&self, row: &Row<'_>, input: Option<usize>) -> Result<Option<f64>> {
        let Some(input) = input else { return Ok(None) };
        match self.value(input) {
            Some(value) if value <= 0.0 => {
                let text = row.cells.get(self.column(input)).map_or("", |cell| cell.raw);
                Err(self.error(row, input, &format!("found `{text}`"), "a standard deviation above 0"))
            }
            value => Ok(value),
        }
    }

    /// Reads a row's numbers; an empty cell is `None`.
    pub(crate) fn read(&mut self, row: &Row<'_>) -> Result<()> {
        self.values.clear();
        self.turns.fill(0.0);
        for (index, input) in self.inputs.iter().enumerate() {
            let value = match input.source {
                InputSource::Constant(value) => Some(value),
                InputSource::Column(_) if !input.sum.is_empty() => sum(&mut self.numbers, row, input)?,
                InputSource::Column(column) => match row.cells.get(column).map_or("", |cell| cell.raw) {
                    "" => None,
                    text => Some(self.numbers.parse(text, row.line).map_err(|expected| {
                        let hint = hint(text, index < self.joints);
                        let message =
                            format!("found `{text}` in column `{}`, expected {expected}{hint}", input.label);
                        row.error(column, message)
                    })?),
                }
                .map(|value| input.unit.to_si(value)),
            };
            if let Some(value) = value {
                check_size(value, row, input)?;
            }
            self.values.push(value);
        }
        Ok(())
    }

    /// Updates the extreme values by the current row.
    pub(crate) fn include_in_ranges(&mut self) {
        for (value, range) in self.values.iter().zip(&mut self.ranges) {
            if let Some(value) = value {
                range.include(*value);
            }
        }
    }

    /// Treats numbers of the current row as empty cells.
    pub(crate) fn forget(&mut self, inputs: &[usize]) {
        for &input in inputs {
            if let Some(value) = self.values.get_mut(input) {
                *value = None;
            }
        }
    }

    /// Value of an input in the current row.
    pub(crate) fn value(&self, input: usize) -> Option<f64> {
        self.values.get(input).copied().flatten()
    }

    /// Values of inputs in the current row.
    pub(crate) fn all<const N: usize>(&self, inputs: [usize; N]) -> [Option<f64>; N] {
        inputs.map(|input| self.value(input))
    }

    /// Reads the joint readings of the current row, which are required.
    pub(crate) fn take_readings(&mut self, row: &Row<'_>) -> Result<()> {
        self.readings.clear();
        for (input, value) in self.values.iter().take(self.joints).enumerate() {
            let Some(value) = value else {
                let expected = "a joint reading: add it, or leave out the row";
                return Err(self.error(row, input, "found an empty cell", expected));
            };
            self.readings.push(*value);
        }
        Ok(())
    }

    /// Takes the joint readings of the current row from elsewhere.
    pub(crate) fn put_readings(&mut self, readings: &[f64]) {
        for (value, reading) in self.values.iter_mut().zip(readings) {
            *value = Some(*reading);
        }
    }

    /// Takes whole turns off the joint readings of the current row that are beyond their limits.
    pub(crate) fn unwind(&mut self, row: &Row<'_>, watch: &mut JointWatch<'_>) {
        let inputs = self.inputs;
        let place = |input| row.place(column(inputs, input));
        watch.unwind(&place, &mut self.values, &mut self.turns);
    }

    /// Reads the joint readings of a row that has nothing else, which are watched.
    pub(crate) fn read_joints(&mut self, row: &Row<'_>, watch: &mut JointWatch<'_>) -> Result<&[f64]> {
        self.read(row)?;
        self.unwind(row, watch);
        self.take_readings(row)?;
        self.include_in_ranges();
        watch.observe(row.line, &self.values);
        Ok(&self.readings)
    }

    /// What was read of each input.
    pub(crate) fn columns(&self) -> Vec<ReadColumn<'a>> {
        let column = |(input, range): (&'a Input, &Range)| ReadColumn {
            name: &input.name,
            unit: input.unit,
            unit_from: input.unit_from,
            range: range.0,
        };
        self.inputs.iter().zip(&self.ranges).map(column).collect()
    }

    /// The warnings on the joint readings of a table.
    ///
    /// # Errors
    /// The doubt about their unit.
    pub(crate) fn joint_warnings(&self, header: &Header<'_>, watch: &JointWatch<'_>) -> Result<Vec<String>> {
        let found = watch.finish(&self.columns()).map_err(|it| header.doubt(it, self.inputs))?;
        Ok(found.into_iter().map(|it| format!("{}: {it}", header.path.display())).collect())
    }

    /// The whole turns that were taken off each joint reading of the current row.
    pub(crate) fn turns(&self) -> &[f64] {
        &self.turns
    }

    /// The numbers of the current row.
    pub(crate) fn values(&self) -> &[Option<f64>] {
        &self.values
    }

    /// Joint readings of the current row.
    pub(crate) fn readings(&self) -> &[f64] {
        &self.readings
    }

    /// An error at the cell of an input: "`found` in column …, expected `expected`".
    pub(crate) fn error(&self, row: &Row<'_>, input: usize, found: &str, expected: &str) -> Error {
        let name = self.inputs.get(input).map_or("", |input| &input.label);
        row.error(self.column(input), format!("{found} in column `{name}`, expected {expected}"))
    }

    /// The file's column of an input; 0 for a constant.
    pub(crate) fn column(&self, input: usize) -> usize {
        column(self.inputs, input)
    }
}

/// The file's column of an input; 0 for a constant.
fn column(inputs: &[Input], input: usize) -> usize {
    match inputs.get(input).map(|input| input.source) {
        Some(InputSource::Column(column)) => column,
        Some(InputSource::Constant(_)) | None => 0,
    }
}

/// Sum of an input's columns; `None` if a cell is empty.
fn sum(numbers: &mut Numbers, row: &Row<'_>, input: &Input) -> Result<Option<f64>> {
    let mut sum = input.offset;
    for term in &input.sum {
        let text = row.cells.get(term.column).map_or("", |cell| cell.raw);
        if text.is_empty() {
            return Ok(None);
        }
        let value = numbers.parse(text, row.line).map_err(|expected| {
            let message = format!("found `{text}` in a column of `{}`, expected {expected}", input.label);
            row.error(term.column, message)
        })?;
        sum += term.factor * term.unit.to_si(value);
    }
    Ok(Some(sum))
}

/// Advice for a word such as `nan`.
const NOTHING: &str = ": leave the cell empty where nothing was measured";

/// Advice for a cell that is no number.
fn hint(text: &str, is_joint: bool) -> &'static str {
    if stands_for_nothing(text) {
        if is_joint { ": leave out a row without a reading" } else { NOTHING }
    } else if text.chars().all(|c| c.is_alphabetic() || c.is_whitespace()) {
        "; put `#` in front of a line that is no row"
    } else {
        ""
    }
}

/// Whether programs write this cell where they have no number.
fn stands_for_nothing(text: &str) -> bool {
    let words = ["nan", "na", "n/a", "null", "none", "nil", "inf", "+inf", "-inf", "-nan"];
    let is_dashes = text.chars().all(|c| matches!(c, '-' | '–' | '—' | '.' | '*' | '?' | '/'));
    text.starts_with('#') || is_dashes || words.contains(&text.to_lowercase().as_str())
}

/// Refuses numbers beyond any measurement, whose squares would overflow.
fn check_size(value: f64, row: &Row<'_>, input: &Input) -> Result<()> {
    let InputSource::Column(column) = input.source else { return Ok(()) };
    if value.abs() <= LARGEST_NUMBER {
        return Ok(());
    }
    let text = row.cells.get(column).map_or("", |cell| cell.raw);
    let si = match input.unit.of() {
        Unit::One | Unit::Second => String::new(),
        quantity @ (Unit::Metre | Unit::Radian) => format!(" {}", NamedUnit::from(quantity).symbol()),
    };
    let message = format!(
        "found `{text}` in column `{}`, expected at most {LARGEST_NUMBER:e}{si}: correct the number or the column's unit, \
         or leave out the row",
        input.label
    );
    Err(row.error(column, message))
}
