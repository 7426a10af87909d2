//! Tables whose joint readings are replaced, row by row; all else stays unchanged.

use std::f64::consts::TAU;
use std::path::Path;

use crate::ReadOptions;
use crate::table::cursor::Cursor;
use crate::table::header::Header;
use crate::table::inputs::{InputSource, RowInput, SumTerm};
use crate::table::layout::ColumnLayout;
use crate::table::mapping::ColumnMap;
use crate::table::number::DecimalSign;
use crate::table::text::LineBlocks;
use crate::table::{FileTable, TableRows};
use poecal_model::robot::{ControllerMap, Robot};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::text::escape_invisible;
use poecal_storage::numbers::push_number;

/// A row of joint readings, and the text in their place.
#[derive(Debug)]
pub struct JointRow<'a> {
    /// Line of the file, from 1.
    pub line: usize,
    /// Readings (rad, m), in the order of [`Robot::reading_names`].
    pub readings: &'a [f64],
}

/// A rewritten table.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RewrittenTable {
    /// Number of rows.
    pub rows: usize,
    /// Warnings, a sentence each.
    pub warnings: Vec<String>,
}

/// Reads a file of joint readings (CSV) and passes it on with new readings. `change` receives each row and changes its numbers (rad, m) in place,
/// `out` receives the text piece by piece. Everything except the digits of changed readings stays byte for byte; they keep the column's unit and
/// the decimal sign. Only a few hundred kilobytes are held.
///
/// # Errors
/// Those of [`crate::read_joints`]; [`ErrorKind::Measurement`] if a reading is a constant, [`ErrorKind::Option`] if sums of columns cannot be
/// inverted; the errors that `change` and `out` return.
pub fn rewrite_joints(
    path: impl AsRef<Path>,
    robot: &Robot,
    options: &ReadOptions,
    change: &mut dyn FnMut(&JointRow<'_>, &mut [f64]) -> Result<()>,
    out: &mut dyn FnMut(&str) -> Result<()>,
) -> Result<RewrittenTable> {
    let path = path.as_ref();
    let no_map = ColumnMap::default();
    let map = options.mapping.as_ref().unwrap_or(&no_map);
    let blocks = LineBlocks::open(path, "a file of joint readings (CSV)")?;
    let mut table = FileTable::open(path, blocks.with_passed_text(), map)?;
    let layout = ColumnLayout::joints(&table.header, robot, options, map)?;
    let counting = invert_sums(&layout, path)?;
    let columns = columns(&layout, counting.as_ref(), &table.header)?;
    let mut inputs = Cursor::new(layout, robot, map.decimal);
    let mut rewritten = RewrittenTable::default();
    if table.is_marked() {
        out("\u{feff}")?;
    }
    out(&table.take_passed_text())?;
    let mut row_of = Rewriting { columns, counting, numbers: Vec::new(), text: String::new() };
    while let Some(rows) = table.next_block()? {
        rewritten.rows += row_of.block(rows, &mut inputs, change)?;
        out(&row_of.text)?;
    }
    if rewritten.rows == 0 {
        return Err(ErrorKind::Measurement
            .error("found a header and no rows, expected at least one row of joint readings")
            .at_line(path, table.header.line));
    }
    let mut warnings = inputs.joint_warnings(&table.header)?;
    warnings.extend(inputs.layout.joint_words().into_iter().map(|words| format!("{}: {words}", path.display())));
    rewritten.warnings = warnings.iter().map(|warning| escape_invisible(warning).into_owned()).collect();
    Ok(rewritten)
}

/// Column and unit of each counted number: of each reading, or, if readings are sums, of the columns in the order of [`ControllerMap::names`].
fn columns(
    layout: &ColumnLayout,
    counting: Option<&ControllerMap>,
    header: &Header<'_>,
) -> Result<Vec<(usize, NamedUnit)>> {
    let terms: Vec<SumTerm> = layout.inputs.iter().flat_map(RowInput::terms).collect();
    let Some(counting) = counting else { return Ok(terms.iter().map(|it| (it.column, it.unit)).collect()) };
    let mut columns = Vec::with_capacity(terms.len());
    for name in counting.names() {
        let mut own = terms.iter().filter(|it| header.cells.get(it.column).is_some_and(|cell| cell.name == *name));
        let Some(first) = own.next() else { continue };
        if let Some(other) = own.find(|it| it.unit.symbol() != first.unit.symbol()) {
            return Err(ErrorKind::Measurement
                .error(format!(
                    "found column `{name}` in {} and in {} by the mapping, expected one unit",
                    first.unit.symbol(),
                    other.unit.symbol()
                ))
                .in_file(header.path));
        }
        columns.push((first.column, first.unit));
    }
    Ok(columns)
}

/// The inverse conversion of readings that are sums to their columns; `None` if each reading is a column.
fn invert_sums(layout: &ColumnLayout, path: &Path) -> Result<Option<ControllerMap>> {
    if let Some(input) = layout.inputs.iter().find(|it| matches!(it.source, InputSource::Constant(_))) {
        return Err(ErrorKind::Measurement
            .error(format!(
                "joint `{}` is a constant by the mapping, expected a column of its own, which can be corrected",
                input.name
            ))
            .in_file(path));
    }
    let sums = layout.controller.as_ref().filter(|it| !it.is_plain());
    sums.map(|it| it.controller_map().map_err(|error| error.in_file(path))).transpose()
}

/// The current block with its new numbers.
struct Rewriting {
    columns: Vec<(usize, NamedUnit)>,
    counting: Option<ControllerMap>,
    numbers: Vec<f64>,
    text: String,
}

impl Rewriting {
    fn block(
        &mut self,
        mut rows: TableRows<'_>,
        inputs: &mut Cursor<'_>,
        change: &mut dyn FnMut(&JointRow<'_>, &mut [f64]) -> Result<()>,
    ) -> Result<usize> {
        let block = rows.text;
        self.text.clear();
        let (mut count, mut copied) = (0, 0);
        // Cells in the order of the file.
        let mut order: Vec<usize> = (0..self.columns.len()).collect();
        order.sort_by_key(|&at| self.columns[at].0);
        while let Some(row) = rows.next()? {
            inputs.read_joints(&row)?;
            self.numbers.clear();
            self.numbers.extend_from_slice(inputs.readings());
            change(&JointRow { line: row.line, readings: inputs.readings() }, &mut self.numbers)?;
            let start = row.text.as_ptr() as usize - block.as_ptr() as usize;
            // Columns of sums change by the amounts that produce the change of the readings.
            let changes = self.counting.as_ref().map(|counting| {
                let of = self.numbers.iter().zip(inputs.readings());
                counting.change(&of.map(|(new, old)| new - old).collect::<Vec<f64>>())
            });
            for &at in &order {
                let (column, unit) = self.columns[at];
                let Some(cell) = row.cells.get(column) else { continue };
                let number = match &changes {
                    None if self.numbers[at].to_bits() == inputs.readings()[at].to_bits() => continue,
                    // The controller includes the turns that were subtracted.
                    None => self.numbers[at] + inputs.turns()[at] * TAU,
                    Some(changes) if changes[at] == 0.0 => continue,
                    Some(changes) => {
                        // It was read before, as a part of a sum.
                        let counted = inputs.numbers.parse(cell.raw, row.line);
                        unit.to_si(counted.map_err(|error| row.error(column, error))?) + changes[at]
                    }
                };
                let from = start + (cell.raw.as_ptr() as usize - row.text.as_ptr() as usize);
                self.text.push_str(block.get(copied..from).unwrap_or_default());
                let digits = self.text.len();
                push_number(&mut self.text, unit.from_si(number));
                if inputs.numbers.sign() == DecimalSign::Comma {
                    let with_comma = self.text.split_off(digits).replace('.', ",");
                    self.text.push_str(&with_comma);
                }
                copied = from + cell.raw.len();
            }
            count += 1;
        }
        self.text.push_str(block.get(copied..).unwrap_or_default());
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use poecal_model::simulate::scara;

    #[test]
    fn readings_that_stay_keep_their_digits() {
        let path = std::env::temp_dir().join(format!("poecal_rewritten_{}.csv", std::process::id()));
        fs::write(&path, "note,joint1[deg],joint2,joint3,joint4\nstart,90.0,0,0,0\n").unwrap();
        let mut text = String::new();
        let mut change = |_: &JointRow<'_>, numbers: &mut [f64]| {
            numbers[1] += 0.5;
            Ok(())
        };
        let mut out = |piece: &str| {
            text.push_str(piece);
            Ok(())
        };
        let table = rewrite_joints(&path, &scara(), &ReadOptions::default(), &mut change, &mut out);
        fs::remove_file(&path).unwrap();
        assert_eq!(table.unwrap().rows, 1);
        assert_eq!(text, "note,joint1[deg],joint2,joint3,joint4\nstart,90.0,0.5,0,0\n");
    }
}
