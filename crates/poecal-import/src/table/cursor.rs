//! A cursor over the rows of a table: the numbers of each, in metres and radians, and statistics of them.

use super::header::Header;
use super::inputs::{InputSource, RowInput, ValueRange};
use super::layout::ColumnLayout;
use super::number::{DecimalSign, NumberReader};
use super::orientation::OrientationForm;
use crate::table::FileRow;
use poecal_arm::lie::angles::Angles;
use poecal_fit::input_doubts::joint_units::JointWatch;
use poecal_fit::input_doubts::turns::TurnWatch;
use poecal_fit::input_doubts::{DoubtLocation, InputDoubt, ReadColumn};
use poecal_model::robot::Robot;
use poecal_numerics::error::{Error, Result};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;
use poecal_storage::numbers::LARGEST_NUMBER;

/// Reads the numbers of one row after the other into the same buffers.
pub(crate) struct Cursor<'r> {
    pub(crate) layout: ColumnLayout,
    pub(crate) numbers: NumberReader,
    /// Smallest and largest value of each input.
    pub(crate) ranges: Vec<ValueRange>,
    /// Statistics of the joint readings of all rows, and of their orientations.
    watch: JointWatch<'r>,
    orientations: TurnWatch,
    values: Vec<Option<f64>>,
    readings: Vec<f64>,
    /// The whole turns that were subtracted from each joint reading of the current row.
    turns: Vec<f64>,
}

impl<'r> Cursor<'r> {
    /// A cursor over rows with these columns, the first of which are the robot's joint readings; with a decimal sign, or one to be found.
    pub(crate) fn new(layout: ColumnLayout, robot: &'r Robot, decimal: Option<DecimalSign>) -> Self {
        let joints = robot.reading_names().len().min(layout.inputs.len());
        Cursor {
            numbers: NumberReader::new(decimal),
            ranges: vec![ValueRange::default(); layout.inputs.len()],
            watch: JointWatch::new(robot),
            orientations: TurnWatch::default(),
            values: Vec::with_capacity(layout.inputs.len()),
            readings: Vec::new(),
            turns: vec![0.0; joints],
            layout,
        }
    }

    /// Reads a row's numbers; an empty cell is `None`.
    pub(crate) fn read(&mut self, row: &FileRow<'_>) -> Result<()> {
        self.values.clear();
        self.turns.fill(0.0);
        for (index, input) in self.layout.inputs.iter().enumerate() {
            let value = match input.source {
                InputSource::Constant(value) => Some(value),
                InputSource::Column(_) if !input.sum.is_empty() => sum(&mut self.numbers, row, input)?,
                InputSource::Column(column) => match row.raw_text(column) {
                    "" => None,
                    text => Some(self.numbers.parse(text, row.line).map_err(|expected| {
                        let hint = hint(text, index < self.turns.len());
                        let message = format!("found `{text}` in column `{}`, expected {expected}{hint}", input.label);
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

    /// Reads the joint readings of a row with nothing else.
    pub(crate) fn read_joints(&mut self, row: &FileRow<'_>) -> Result<&[f64]> {
        self.read(row)?;
        self.take_readings(row)?;
        self.observe(row);
        Ok(&self.readings)
    }

    /// Takes the joint readings of the current row, which are required; whole turns beyond their limits are subtracted.
    pub(crate) fn take_readings(&mut self, row: &FileRow<'_>) -> Result<()> {
        let inputs = &self.layout.inputs;
        let place = |input: usize| row.place(inputs.get(input).map_or(0, RowInput::column));
        self.watch.unwind(&place, &mut self.values, &mut self.turns);
        self.readings.clear();
        for (input, value) in self.values.iter().take(self.turns.len()).enumerate() {
            let Some(value) = value else {
                let expected = "a joint reading: add it, or leave out the row";
                return Err(self.error(row, input, "found an empty cell", expected));
            };
            self.readings.push(*value);
        }
        Ok(())
    }

    /// Adds the numbers of the current row, which has a measurement, to the statistics.
    pub(crate) fn observe(&mut self, row: &FileRow<'_>) {
        for (value, range) in self.values.iter().zip(&mut self.ranges) {
            if let Some(value) = value {
                range.include(*value);
            }
        }
        self.watch.observe(row.line, &self.values);
        for (form, columns) in self.layout.targets.iter().filter_map(|it| it.orientation.as_ref()) {
            let OrientationForm::Angles(angles) = form else { continue };
            let of = |input: &usize| self.layout.inputs.get(*input);
            let [Some(x), Some(y), Some(z)] = [0, 1, 2].map(|at| columns.get(at).and_then(of)) else {
                continue;
            };
            let values = [0, 1, 2].map(|at| self.value(columns[at]));
            let ([Some(a), Some(b), Some(c)], true) = (values, [x, y, z].iter().all(|it| it.unit.symbol() == "rad"))
            else {
                continue;
            };
            let place = || {
                let (line, column) = row.place(x.column());
                (DoubtLocation::Cell(line, column), [x, y, z].map(|it| it.label.clone()).to_vec())
            };
            self.orientations.observe([a, b, c], *angles == Angles::RotationVector, place);
        }
    }

    /// The columns of the inputs, with the numbers that were read.
    pub(crate) fn columns(&self) -> Vec<ReadColumn<'_>> {
        let inputs = self.layout.inputs.iter().zip(&self.ranges);
        inputs
            .map(|(input, range)| ReadColumn {
                name: &input.name,
                unit: input.unit,
                unit_from: input.unit_from,
                range: range.0,
            })
            .collect()
    }

    /// The warnings on the joint readings of a table.
    ///
    /// # Errors
    /// The doubt about their unit.
    pub(crate) fn joint_warnings(&self, header: &Header<'_>) -> Result<Vec<String>> {
        let found = self.watch.finish(&self.columns()).map_err(|it| self.doubt(header, it))?;
        Ok(found.into_iter().map(|it| format!("{}: {it}", header.path.display())).collect())
    }

    /// Refuses orientations in degrees that were read as radians.
    pub(crate) fn check_orientations(&self, header: &Header<'_>) -> Result<()> {
        self.refuse(header, self.orientations.doubt())
    }

    /// Total motion of the slides without limits, metres.
    pub(crate) fn unlimited_slides_m(&self) -> f64 {
        self.watch.unlimited_slides_m(&self.columns())
    }

    /// Refuses the table if there is a doubt.
    pub(crate) fn refuse(&self, header: &Header<'_>, doubt: Option<InputDoubt>) -> Result<()> {
        doubt.map_or(Ok(()), |it| Err(self.doubt(header, it)))
    }

    fn doubt(&self, header: &Header<'_>, doubt: InputDoubt) -> Error {
        header.doubt(doubt, &self.layout.inputs)
    }

    /// The time of a row, seconds; NaN if it has none.
    pub(crate) fn time_s(&self, row: &FileRow<'_>) -> f64 {
        let Some((column, seconds)) = self.layout.time else { return f64::NAN };
        let text = row.raw_text(column).trim_start_matches('\'');
        let value = if text.contains('.') { text.parse::<f64>() } else { text.replace(',', ".").parse() };
        value.map_or(f64::NAN, |it| it * seconds)
    }

    /// The row's standard deviation, if stated.
    pub(crate) fn sigma(&self, row: &FileRow<'_>, input: Option<usize>) -> Result<Option<f64>> {
        let Some(input) = input else { return Ok(None) };
        match self.value(input) {
            Some(value) if value <= 0.0 => {
                let found = format!("found `{}`", row.raw_text(self.column(input)));
                Err(self.error(row, input, &found, "a standard deviation above 0"))
            }
            value => Ok(value),
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

    /// Takes the joint readings of the current row from elsewhere.
    pub(crate) fn put_readings(&mut self, readings: &[f64]) {
        for (value, reading) in self.values.iter_mut().zip(readings) {
            *value = Some(*reading);
        }
    }

    /// The whole turns that were subtracted from each joint reading of the current row.
    pub(crate) fn turns(&self) -> &[f64] {
        &self.turns
    }

    /// Joint readings of the current row.
    pub(crate) fn readings(&self) -> &[f64] {
        &self.readings
    }

    /// An error at the cell of an input: "`found` in column …, expected `expected`".
    pub(crate) fn error(&self, row: &FileRow<'_>, input: usize, found: &str, expected: &str) -> Error {
        let name = self.layout.inputs.get(input).map_or("", |input| &input.label);
        row.error(self.column(input), format!("{found} in column `{name}`, expected {expected}"))
    }

    /// The file's column of an input; 0 for a constant.
    pub(crate) fn column(&self, input: usize) -> usize {
        self.layout.inputs.get(input).map_or(0, RowInput::column)
    }
}

/// Sum of an input's columns; `None` if a cell is empty.
fn sum(numbers: &mut NumberReader, row: &FileRow<'_>, input: &RowInput) -> Result<Option<f64>> {
    let mut sum = input.offset;
    for term in &input.sum {
        let text = row.raw_text(term.column);
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

/// Remedy for a word such as `nan`.
const NOTHING: &str = ": leave the cell empty where nothing was measured";

/// Remedy for a cell that is no number.
fn hint(text: &str, is_joint: bool) -> &'static str {
    if stands_for_nothing(text) {
        if is_joint { ": leave out a row without a reading" } else { NOTHING }
    } else if text.chars().all(|c| c.is_alphabetic() || c.is_whitespace()) {
        "; put `#` in front of a line that is no row"
    } else {
        ""
    }
}

/// True if programs write this cell for a missing number.
fn stands_for_nothing(text: &str) -> bool {
    let words = ["nan", "na", "n/a", "null", "none", "nil", "inf", "+inf", "-inf", "-nan"];
    let is_dashes = text.chars().all(|c| matches!(c, '-' | '–' | '—' | '.' | '*' | '?' | '/'));
    text.starts_with('#') || is_dashes || words.contains(&text.to_lowercase().as_str())
}

/// Refuses numbers beyond any measurement, whose squares would overflow.
fn check_size(value: f64, row: &FileRow<'_>, input: &RowInput) -> Result<()> {
    let InputSource::Column(column) = input.source else { return Ok(()) };
    if value.abs() <= LARGEST_NUMBER {
        return Ok(());
    }
    let text = row.raw_text(column);
    let si = match input.unit.si_unit() {
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
