//! Workbooks of spreadsheets (.xlsx, .xlsm, .xls, .ods): the one sheet with a table, or the one that was asked for.
//!
//! The sizes of an archive are limited before it is opened (`archive.rs`), those of a sheet while it is read (`cells.rs`). Old workbooks are read
//! here (`old.rs`), since no other reader limits them.

mod archive;
mod cells;
mod heads;
mod numbers;
mod old;

use std::io::Cursor;

use calamine::{Data, Ods, Range, Reader as _, Sheets, Xlsx};

use self::archive::ArchiveParts;
use self::cells::{Formulas, ReadSheet, RemainingAllowance, WorkbookBytes};
use self::heads::{SheetHead, head, is_sum};
use super::made_table::{CellValue, MadeTable, Refusal, TableColumn};
use super::words::{number, quote_names};
use super::workbook_cells::{is_empty, no_number, refuse_uncomputed, text, value};
use super::{OpeningContext, two_sets};
use crate::table::mapping::ColumnMap;
use crate::table::source_cells::WorkbookSheet;
use poecal_numerics::error::first_few;
use poecal_storage::containers::office;

/// True if a file is a workbook, or an archive like a workbook, by its first bytes.
pub(crate) fn is_one(head: &[u8]) -> bool {
    head.starts_with(b"PK\x03\x04") || head.starts_with(b"\xd0\xcf\x11\xe0")
}

/// A workbook whose sheets are read one by one.
enum Workbook<'b> {
    Archive(Box<WorkbookBytes<'b>>, RemainingAllowance),
    Read(Vec<ReadSheet>),
}

impl<'b> Workbook<'b> {
    fn open(bytes: &'b [u8]) -> Result<Self, String> {
        if bytes.starts_with(office::MAGIC) {
            return old::sheets(bytes).map(Workbook::Read);
        }
        let parts = ArchiveParts::from_bytes(bytes)?;
        let cursor = Cursor::new(bytes);
        let book = Xlsx::new(cursor.clone()).map(Sheets::Xlsx).or_else(|_| Ods::new(cursor).map(Sheets::Ods)).map_err(|_| {
            "found a ZIP archive that is no workbook such as .xlsx, or a workbook that is damaged, expected a measurement file (CSV), or a workbook: \
             save the table as `CSV UTF-8`"
        })?;
        parts.refuse_sheets(book.sheet_names().len())?;
        Ok(Workbook::Archive(Box::new(book), RemainingAllowance::new()))
    }

    fn names(&self) -> Vec<String> {
        match self {
            Workbook::Archive(book, _) => book.sheet_names(),
            Workbook::Read(sheets) => sheets.iter().map(|it| it.0.clone()).collect(),
        }
    }

    /// The cells of a sheet; they can be taken once.
    fn range(&mut self, name: &str) -> Result<Range<Data>, String> {
        match self {
            Workbook::Archive(book, left) => cells::range(book, name, left),
            Workbook::Read(sheets) => {
                let own = sheets.iter_mut().find(|it| it.0 == name);
                Ok(own.map(|it| std::mem::take(&mut it.1)).unwrap_or_default())
            }
        }
    }

    /// Formulas of a sheet within a range; empty for old workbooks, which are read here.
    fn formulas(&mut self, name: &str, within: &Range<Data>) -> Formulas {
        match self {
            Workbook::Archive(book, _) => cells::formulas(book, name, within),
            Workbook::Read(_) => Formulas::new(),
        }
    }
}

/// The table of a workbook.
pub(crate) fn table(bytes: &[u8], opening: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
    let mut book = Workbook::open(bytes)?;
    let names = book.names();
    let wanted = opening.options.sheet.as_ref();
    if let Some(wanted) = wanted.filter(|it| !names.contains(it)) {
        return Refusal::refuse_whole(format!("found no sheet `{wanted}`, expected one of {}", quote_names(&names)));
    }
    let mut tables = Vec::new();
    for name in wanted.map_or(names.iter().collect(), |it| vec![it]) {
        tables.extend(SheetTable::from_range(book.range(name)?, name));
    }
    if let [found] = tables.as_slice() {
        return found.sets(&book.formulas(&found.sheet.name, &found.range), opening);
    }
    let (one, many) = (names.len() == 1, !tables.is_empty());
    Refusal::refuse_whole(match wanted {
        _ if many => {
            let names = quote_names(tables.iter().map(|it| &it.sheet.name));
            format!("found tables in the sheets {names}, expected one: name it by --sheet")
        }
        Some(name) => format!(
            "found no table in sheet `{name}`, expected a row that names the columns and rows of numbers below it"
        ),
        None => format!(
            "found no table in the sheet{} {}, expected a sheet with a row that names the columns and rows of numbers below it",
            if one { "" } else { "s" },
            quote_names(&names)
        ),
    })
}

/// Number of rows at the end of a table among which sums are sought.
const LAST: usize = 10;

/// The table of a sheet: its header, units and rows by their numbers in the range.
struct SheetTable {
    range: Range<Data>,
    sheet: WorkbookSheet,
    header: usize,
    names: Vec<String>,
    units: Option<usize>,
    rows: Vec<usize>,
    /// True if a row of groups is above the names; then the lines at the end that summarise the rows.
    is_two: bool,
    sums: Vec<usize>,
}

impl SheetTable {
    /// The first head with numbers below.
    fn from_range(range: Range<Data>, name: &str) -> Option<Self> {
        let rows: Vec<&[Data]> = range.rows().collect();
        let SheetHead { names, header, units, begin, is_two } = head(&rows)?;
        let is_filled = |at: &usize| rows.get(*at).is_some_and(|it| !it.iter().take(names.len()).all(is_empty));
        let mut rows_at: Vec<usize> = (begin..rows.len()).filter(is_filled).collect();
        // From the first sum on, all rows below are of the same kind.
        let first = rows_at.len().saturating_sub(LAST);
        let is_sum = |at: &usize| rows.get(*at).is_some_and(|it| is_sum(it));
        let sum = rows_at.iter().skip(first).position(is_sum).map_or(rows_at.len(), |it| first + it);
        let sums = rows_at.split_off(sum);
        let first_column = range.start().map_or(0, |it| it.1 as usize);
        let sheet = WorkbookSheet { name: name.to_owned(), first_column };
        Some(SheetTable { sheet, header, names, units, rows: rows_at, is_two, sums, range })
    }

    /// The number of a row in the sheet.
    fn line(&self, row: usize) -> usize {
        self.range.start().map_or(0, |it| it.0 as usize) + row + 1
    }

    fn cell(&self, row: usize, column: usize) -> &Data {
        self.range.get((row, column)).unwrap_or(&Data::Empty)
    }

    /// The table, or both tables if it has two sets of coordinates, unless a mapping names columns.
    fn sets(&self, formulas: &Formulas, opening: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
        refuse_uncomputed(formulas, &self.range, &self.sheet, (&self.rows, &self.names))?;
        let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
        let is_mapped = opening.options.mapping.as_ref().is_some_and(ColumnMap::names_columns);
        match two_sets::split(&names).filter(|_| !is_mapped) {
            Some(([first, second], called)) => {
                Ok(self.make_table(&first)?.with_other(called, self.make_table(&second)?))
            }
            None => self.make_table(&names.into_iter().map(TableColumn::from).enumerate().collect::<Vec<_>>()),
        }
    }

    /// The table of some columns.
    fn make_table(&self, columns: &[(usize, TableColumn)]) -> Result<MadeTable, Refusal> {
        let mut made = MadeTable::new(self.line(self.header), columns.iter().map(|it| it.1.clone()));
        if let Some(units) = self.units {
            let texts: Vec<String> = columns.iter().map(|it| text(self.cell(units, it.0))).collect();
            made.row(self.line(units), texts.iter().map(|it| CellValue::Text(it)));
        }
        // Columns of numbers: a text in them is a number or a mistake.
        let is_numeric = |column: usize| {
            let is_number = |at: &&usize| matches!(self.cell(**at, column), Data::Float(_) | Data::Int(_));
            2 * self.rows.iter().filter(is_number).count() > self.rows.len()
        };
        let numeric: Vec<(usize, bool)> = columns.iter().map(|it| (it.0, is_numeric(it.0))).collect();
        let mut stored = Vec::new();
        for &row in &self.rows {
            let cells = numeric.iter();
            let cells: Vec<(String, Option<f64>)> =
                cells.map(|(at, it)| self.read_cell((row, *at), *it, &mut stored)).collect::<Result<_, _>>()?;
            let typed = cells.iter().map(|(text, number)| number.map_or(CellValue::Text(text), CellValue::Number));
            made.row(self.line(row), typed);
        }
        let (name, first) = (&self.sheet.name, self.rows.first().map_or(0, |at| self.line(*at)));
        made.say(format!("sheet `{name}`, {} rows from row {first} on", self.rows.len()));
        if self.is_two {
            made.say(format!(
                "names of columns in two rows, {} and {}",
                self.line(self.header) - 1,
                self.line(self.header)
            ));
        }
        if !self.sums.is_empty() {
            let sums: Vec<String> = self.sums.iter().map(|at| self.line(*at).to_string()).collect();
            made.say(format!("left out what sums up the rows in row {}", sums.join(", ")));
        }
        if !stored.is_empty() {
            let stored = first_few(&stored);
            made.warn(format!("sheet `{name}`: numbers that are stored as text are read as numbers: {stored}"));
        }
        made.sheet = Some(self.sheet.clone());
        Ok(made)
    }

    /// The text of a cell, or its number; numbers stored as text in a column of numbers are reported.
    fn read_cell(
        &self,
        (row, column): (usize, usize),
        is_numeric: bool,
        stored: &mut Vec<String>,
    ) -> Result<(String, Option<f64>), Refusal> {
        let cell = self.cell(row, column);
        if let Some(shown) = no_number(cell, self.names.get(column).map_or("", String::as_str)) {
            return Ok((shown, None));
        }
        let written = text(cell);
        if !matches!(cell, Data::String(_)) {
            return Ok((written, value(cell)));
        }
        let Some(value) = number(&written).filter(|_| is_numeric) else { return Ok((written, None)) };
        let place = self.sheet.cell(column, self.line(row));
        if is_ambiguous(&written) {
            return Refusal::refuse_whole(format!(
                "sheet `{}`, cell {place}: found the text `{written}`, which is {value} with a decimal comma and another number with a \
                 separator of thousands, expected a number: type it in anew",
                self.sheet.name
            ));
        }
        stored.push(format!("{place} (`{written}`)"));
        Ok((written, Some(value)))
    }
}

/// True if the comma may separate thousands: three digits follow it, and one to three that are not only zero precede it.
fn is_ambiguous(text: &str) -> bool {
    let Some((before, behind)) = text.trim().split_once(',') else { return false };
    let before = before.trim_start_matches(['-', '+']);
    behind.len() == 3 && (1..=3).contains(&before.len()) && before != "0"
}
