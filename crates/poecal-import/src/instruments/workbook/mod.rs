//! Workbooks of spreadsheets (.xlsx, .xlsm, .xlsb, .xls, .ods): the one sheet that holds a table, or the one that was asked for.
//!
//! The sizes of an archive are bounded before it is opened (`archive.rs`), those of a sheet while it is read (`cells.rs`). Old workbooks are read here
//! (`old.rs`, from their container, `container.rs`), and binary ones (`binary.rs`), since no other reader bounds them.

mod archive;
mod binary;
mod cells;
mod container;
mod numbers;
mod old;

use std::collections::BTreeMap;
use std::io::Cursor;

use calamine::{Data, Ods, Range, Reader as _, Sheets, Xlsx};

use self::archive::Parts;
use self::cells::{Book, Left, ReadSheet};
use super::Opening;
use super::maker::{Made, Refused, Value};
use super::words::{number, quoted};
use super::workbook_cells::{no_number, refuse_uncomputed};
use crate::table::places::Sheet;
use poecal_numerics::error::first_few;

/// Rows in which the header is sought.
const FIRST: usize = 60;
/// Fewest columns of a table, and fewest rows of numbers.
const FEWEST_COLUMNS: usize = 3;
/// Seconds of a day, the unit of times in workbooks.
const DAY_S: f64 = 86_400.0;

/// Whether a file is a workbook, or an archive as workbooks are, by its first bytes.
pub(crate) fn is_one(head: &[u8]) -> bool {
    head.starts_with(b"PK\x03\x04") || head.starts_with(b"\xd0\xcf\x11\xe0")
}

/// Header and rows of a sheet, by their numbers in the range.
struct Found {
    header: usize,
    units: Option<usize>,
    rows: Vec<usize>,
    columns: usize,
}

/// A workbook whose sheets are read one by one.
enum Workbook<'b> {
    Archive(Box<Book<'b>>, Left),
    Read(Vec<ReadSheet>),
}

impl<'b> Workbook<'b> {
    fn open(bytes: &'b [u8]) -> Result<Self, String> {
        if bytes.starts_with(container::MAGIC) {
            return old::sheets(bytes).map(Workbook::Read);
        }
        let parts = Parts::of(bytes)?;
        if let Some(sheets) = binary::sheets(bytes, parts)? {
            return Ok(Workbook::Read(sheets));
        }
        let cursor = Cursor::new(bytes);
        let book = Xlsx::new(cursor.clone()).map(Sheets::Xlsx).or_else(|_| Ods::new(cursor).map(Sheets::Ods)).map_err(|_| {
            "found a ZIP archive that is no workbook such as .xlsx, or a workbook that is damaged, expected a measurement file (CSV), or a workbook: \
             save the table as `CSV UTF-8`"
        })?;
        parts.refuse_sheets(book.sheet_names().len())?;
        Ok(Workbook::Archive(Box::new(book), Left::of_workbook()))
    }

    fn names(&self) -> Vec<String> {
        match self {
            Workbook::Archive(book, _) => book.sheet_names(),
            Workbook::Read(sheets) => sheets.iter().map(|it| it.0.clone()).collect(),
        }
    }

    /// The cells of a sheet, once.
    fn range(&mut self, name: &str) -> Result<Range<Data>, String> {
        match self {
            Workbook::Archive(book, left) => cells::range(book, name, left),
            Workbook::Read(sheets) => {
                let own = sheets.iter_mut().find(|it| it.0 == name);
                Ok(own.map(|it| std::mem::take(&mut it.1)).unwrap_or_default())
            }
        }
    }

    /// Formulas of a sheet within a range; of those that are read here none.
    fn formulas(&mut self, name: &str, within: &Range<Data>) -> BTreeMap<(u32, u32), String> {
        match self {
            Workbook::Archive(book, _) => cells::formulas(book, name, within),
            Workbook::Read(_) => BTreeMap::new(),
        }
    }
}

/// The table of a workbook.
pub(crate) fn table(bytes: &[u8], opening: &Opening<'_>) -> Result<Made, Refused> {
    let mut book = Workbook::open(bytes).or_else(Refused::whole)?;
    let names = book.names();
    if let Some(wanted) = &opening.options.sheet {
        let Some(name) = names.iter().find(|it| *it == wanted) else {
            return Refused::whole(format!("found no sheet `{wanted}`, expected one of {}", quoted(&names)));
        };
        let range = book.range(name).or_else(Refused::whole)?;
        return match found(&range) {
            Some(table) => made(&mut book, &range, &table, name),
            None => Refused::whole(format!(
                "found no table in sheet `{name}`, expected a row that names the columns and rows of numbers below it"
            )),
        };
    }
    let mut tables = Vec::new();
    for name in &names {
        let range = book.range(name).or_else(Refused::whole)?;
        if let Some(table) = found(&range) {
            tables.push((name.clone(), range, table));
        }
    }
    match tables.as_slice() {
        [(name, range, table)] => made(&mut book, range, table, name),
        [] => Refused::whole(format!(
            "found no table in {}, expected a sheet with a row that names the columns and rows of numbers below it",
            if names.len() == 1 {
                format!("the sheet {}", quoted(&names))
            } else {
                format!("the sheets {}", quoted(&names))
            }
        )),
        several => {
            let names: Vec<String> = several.iter().map(|it| it.0.clone()).collect();
            Refused::whole(format!(
                "found tables in the sheets {}, expected one: name it by --sheet",
                quoted(&names)
            ))
        }
    }
}

/// A number of a cell.
fn value(cell: &Data) -> Option<f64> {
    match cell {
        Data::Float(value) => Some(*value).filter(|it| it.is_finite()),
        Data::Int(value) => Some(*value as f64),
        Data::DateTime(time) => Some(time.as_f64() * DAY_S),
        Data::String(text) => number(text),
        Data::Bool(_) | Data::DateTimeIso(_) | Data::DurationIso(_) | Data::Error(_) | Data::Empty => None,
    }
}

fn is_empty(cell: &Data) -> bool {
    matches!(cell, Data::Empty) || matches!(cell, Data::String(text) if text.trim().is_empty())
}

/// The table of a sheet: the first row of texts with numbers below, or below a row of units.
fn found(range: &Range<Data>) -> Option<Found> {
    let rows: Vec<&[Data]> = range.rows().collect();
    let is_text = |cell: &&Data| matches!(cell, Data::String(_)) && value(cell).is_none() && !is_empty(cell);
    for (header, row) in rows.iter().enumerate().take(FIRST) {
        let texts = row.iter().filter(is_text).count();
        let others = row.iter().filter(|it| !is_empty(it) && !is_text(it)).count();
        if texts < FEWEST_COLUMNS || others > 0 {
            continue;
        }
        let columns = row.iter().rposition(|it| !is_empty(it)).map_or(0, |it| it + 1);
        let is_row = |at: usize| {
            rows.get(at).is_some_and(|it| {
                let named = it.iter().zip(row.iter()).filter(|(_, name)| !is_empty(name));
                2 * named.filter(|(cell, _)| value(cell).is_some()).count() >= texts
            })
        };
        let first =
            (header + 1..rows.len()).find(|at| rows.get(*at).is_some_and(|it| !it.iter().all(is_empty)))?;
        let has_numbers = |at: usize| rows.get(at).is_some_and(|it| it.iter().any(|it| value(it).is_some()));
        let units = (!has_numbers(first)).then_some(first);
        let begin = units.map_or(first, |it| it + 1);
        if !is_row(begin) {
            continue;
        }
        let all = (begin..rows.len())
            .filter(|at| rows.get(*at).is_some_and(|it| !it.iter().take(columns).all(is_empty)));
        return Some(Found { header, units, rows: all.collect(), columns });
    }
    None
}

/// The text of a cell.
fn text(cell: &Data) -> String {
    if let Data::String(text) = cell {
        return text.trim().replace(['\n', '\r', '\t'], " ");
    }
    if is_empty(cell) { String::new() } else { cell.to_string() }
}

fn made(book: &mut Workbook<'_>, range: &Range<Data>, table: &Found, name: &str) -> Result<Made, Refused> {
    let (first_row, first_column) = range.start().unwrap_or_default();
    let line = |at: usize| first_row as usize + at + 1;
    let sheet = Sheet { name: name.to_owned(), first_column: first_column as usize };
    let rows: Vec<&[Data]> = range.rows().collect();
    let row = |at: usize| rows.get(at).copied().unwrap_or_default();
    let texts = |at: usize| -> Vec<String> {
        (0..table.columns).map(|column| row(at).get(column).map(text).unwrap_or_default()).collect()
    };
    let header = texts(table.header);
    refuse_uncomputed(&book.formulas(name, range), range, &sheet, (&table.rows, &header))?;
    let mut made = Made::new(line(table.header), header.iter().map(String::as_str));
    if let Some(units) = table.units {
        let units_of = texts(units);
        made.row(line(units), units_of.iter().map(|it| Value::Text(it)));
    }
    // Columns of numbers, in which a text is a number or a mistake.
    let numeric: Vec<bool> = (0..table.columns)
        .map(|column| {
            let is_number = |at: &&usize| {
                row(**at).get(column).is_some_and(|it| matches!(it, Data::Float(_) | Data::Int(_)))
            };
            2 * table.rows.iter().filter(is_number).count() > table.rows.len()
        })
        .collect();
    let mut stored = Vec::new();
    for &at in &table.rows {
        let cells = cells_of_row(row(at), (&numeric, &header), (&sheet, line(at)), &mut stored)?;
        let values = cells.iter().map(|(text, value)| match value {
            Some(value) => Value::Number(*value),
            None if text.is_empty() => Value::Empty,
            None => Value::Text(text),
        });
        made.row(line(at), values);
    }
    let first = table.rows.first().map_or(0, |at| line(*at));
    made.said.push(format!("sheet `{name}`, {} rows from row {first} on", table.rows.len()));
    if !stored.is_empty() {
        made.warned.push(format!(
            "sheet `{name}`: numbers that are stored as text are read as numbers: {}",
            first_few(&stored)
        ));
    }
    made.sheet = Some(sheet);
    Ok(made)
}

/// The cells of a row, as texts or numbers; numbers that are stored as text in a column of numbers are told.
fn cells_of_row(
    row: &[Data],
    (numeric, header): (&[bool], &[String]),
    (sheet, line): (&Sheet, usize),
    stored: &mut Vec<String>,
) -> Result<Vec<(String, Option<f64>)>, Refused> {
    let mut cells: Vec<(String, Option<f64>)> = Vec::with_capacity(numeric.len());
    for (column, is_numeric) in numeric.iter().enumerate() {
        let cell = row.get(column).unwrap_or(&Data::Empty);
        let is_text = matches!(cell, Data::String(_));
        if let Some(shown) = no_number(cell, header.get(column).map_or("", String::as_str)) {
            cells.push((shown, None));
            continue;
        }
        if *is_numeric && is_text && !is_empty(cell) {
            let written = text(cell);
            let place = sheet.cell(column, line);
            let Some(value) = number(&written) else {
                cells.push((written, None));
                continue;
            };
            if is_ambiguous(&written) {
                return Refused::whole(format!(
                    "sheet `{}`, cell {place}: found the text `{written}`, which is {value} with a decimal comma and another number with a \
                     separator of thousands, expected a number: type it in anew",
                    sheet.name
                ));
            }
            stored.push(format!("{place} (`{written}`)"));
            cells.push((String::new(), Some(value)));
            continue;
        }
        match value(cell).filter(|_| !is_text) {
            Some(value) => cells.push((String::new(), Some(value))),
            None => cells.push((text(cell), None)),
        }
    }
    Ok(cells)
}

/// Whether a number with a comma may be one of thousands: three digits behind it, and one to three before it that are not zero alone.
fn is_ambiguous(text: &str) -> bool {
    let Some((before, behind)) = text.trim().split_once(',') else { return false };
    let before = before.trim_start_matches(['-', '+']);
    behind.len() == 3 && (1..=3).contains(&before.len()) && before != "0"
}
