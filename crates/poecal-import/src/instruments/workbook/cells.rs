//! The cells of a sheet as a range, once the range is known to be within the limits.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::io::Cursor;

use calamine::{Cell, Data, Range, Reader as _, Sheets};

use poecal_storage::limits::ResourceLimit;

/// A workbook of bytes.
pub(crate) type WorkbookBytes<'b> = Sheets<Cursor<&'b [u8]>>;

/// Remaining budget of the sheets of a workbook.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RemainingAllowance {
    /// Cells of their ranges.
    cells: u64,
    /// Bytes of their texts, each as often as a cell has it.
    texts: u64,
}

impl RemainingAllowance {
    /// The budget of a whole workbook.
    pub(crate) fn new() -> Self {
        RemainingAllowance { cells: ResourceLimit::Cells.value(), texts: ResourceLimit::Unpacked.value() }
    }
}

/// The cells of one sheet and their extent.
#[derive(Default)]
pub(crate) struct SheetCells {
    cells: Vec<Cell<Data>>,
    /// First and last row and column.
    extent: Option<[u32; 4]>,
}

impl SheetCells {
    /// Takes a cell, unless the range or the texts then exceed the remaining budget.
    ///
    /// # Errors
    /// The sentence of the limit.
    pub(crate) fn add(
        &mut self,
        (row, column): (u32, u32),
        value: Data,
        left: &mut RemainingAllowance,
    ) -> Result<(), String> {
        if matches!(value, Data::Empty) {
            return Ok(());
        }
        let [top, bottom, first, last] = self.extent.unwrap_or([row, row, column, column]);
        let extent = [top.min(row), bottom.max(row), first.min(column), last.max(column)];
        self.extent = Some(extent);
        // A file may state one cell repeatedly.
        if self.area() > left.cells || self.cells.len() as u64 >= left.cells {
            let [top, bottom, first, last] = extent.map(u64::from);
            let (rows, columns) = (bottom - top + 1, last - first + 1);
            return Err(ResourceLimit::Cells.sentence(&format!("a sheet of {rows} rows and {columns} columns")));
        }
        if let Data::String(text) = &value {
            let rest = left.texts.checked_sub(text.len() as u64);
            left.texts = rest.ok_or_else(|| ResourceLimit::Unpacked.exceeded_error("the texts of the cells"))?;
        }
        self.cells.push(Cell::new((row, column), value));
        Ok(())
    }

    /// The number of cells of the range, including empty ones.
    fn area(&self) -> u64 {
        let [top, bottom, first, last] = self.extent.map(|it| it.map(u64::from)).unwrap_or([1, 0, 1, 0]);
        (bottom + 1 - top).saturating_mul(last + 1 - first)
    }

    /// The range; its cells are taken from the budget.
    pub(crate) fn range(self, left: &mut RemainingAllowance) -> Range<Data> {
        left.cells = left.cells.saturating_sub(self.area());
        Range::from_sparse(self.cells)
    }
}

/// A sheet: its name and its cells.
pub(crate) type ReadSheet = (String, Range<Data>);

/// The message on a damaged sheet.
pub(crate) fn damage_message(name: &str, error: &dyn Display) -> String {
    format!("the sheet `{name}` cannot be read ({error}), expected a workbook that is whole: save it again")
}

/// The cells of a sheet.
///
/// # Errors
/// The defect, in a sentence.
pub(crate) fn range(
    book: &mut WorkbookBytes<'_>,
    name: &str,
    left: &mut RemainingAllowance,
) -> Result<Range<Data>, String> {
    let broken = |error: &dyn Display| damage_message(name, error);
    let mut found = SheetCells::default();
    match book {
        Sheets::Xlsx(book) => {
            let mut reader = match book.worksheet_cells_reader(name) {
                Ok(reader) => reader,
                // The sheet is a chart or a macro.
                Err(calamine::XlsxError::NotAWorksheet(_)) => return Ok(Range::default()),
                Err(error) => return Err(broken(&error)),
            };
            while let Some(cell) = reader.next_cell().map_err(|error| broken(&error))? {
                found.add(cell.get_position(), Data::from(cell.get_value().clone()), left)?;
            }
        }
        // The cells of .ods were counted before it was opened; the other forms are read elsewhere.
        Sheets::Ods(_) | Sheets::Xls(_) | Sheets::Xlsb(_) => {
            return book.worksheet_range(name).map_err(|error| broken(&error));
        }
    }
    Ok(found.range(left))
}

/// Formulas of a sheet by row and column.
pub(crate) type Formulas = BTreeMap<(u32, u32), String>;

/// Formulas of a sheet within a range, by row and column; empty if the form of workbook has formulas that cannot be read.
pub(crate) fn formulas(book: &mut WorkbookBytes<'_>, name: &str, within: &Range<Data>) -> Formulas {
    let mut found = Formulas::new();
    let (Some(start), Some(end)) = (within.start(), within.end()) else { return found };
    let mut take = |(row, column): (u32, u32), text: &String| {
        let is_within = (start.0..=end.0).contains(&row) && (start.1..=end.1).contains(&column);
        if is_within && !text.is_empty() {
            found.insert((row, column), text.clone());
        }
    };
    match book {
        Sheets::Xlsx(book) => {
            if let Ok(mut reader) = book.worksheet_cells_reader(name) {
                while let Ok(Some(cell)) = reader.next_formula() {
                    take(cell.get_position(), cell.get_value());
                }
            }
        }
        Sheets::Ods(_) | Sheets::Xls(_) | Sheets::Xlsb(_) => {
            if let Ok(all) = book.worksheet_formula(name) {
                let first = all.start().unwrap_or_default();
                for (row, column, text) in all.used_cells() {
                    take((first.0 + row as u32, first.1 + column as u32), text);
                }
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_extent_is_held_up_to_its_limit() {
        let mut left = RemainingAllowance { cells: 6, texts: 5 };
        let mut found = SheetCells::default();
        assert_eq!(found.area(), 0);
        for place in [(1, 1), (2, 3), (2, 3)] {
            found.add(place, Data::Int(1), &mut left).unwrap();
        }
        assert_eq!(found.area(), 6);
        found.add((1 << 31, 1 << 31), Data::Empty, &mut left).unwrap();
        let error = found.add((1_048_575, 1), Data::Int(1), &mut left).unwrap_err();
        assert!(error.starts_with("found a sheet of 1048575 rows and 3 columns, expected at most"), "{error}");
        let mut same = SheetCells::default();
        assert!((0..7).map(|_| same.add((0, 0), Data::Int(1), &mut left)).any(|it| it.is_err()));
        let text = || Data::String("abc".to_owned());
        let mut texts = SheetCells::default();
        texts.add((0, 0), text(), &mut left).unwrap();
        assert!(texts.add((0, 1), text(), &mut left).is_err());
        texts.range(&mut left);
        assert_eq!(left.cells, 4);
    }
}
