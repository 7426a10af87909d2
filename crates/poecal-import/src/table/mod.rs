//! A file as a table: header and rows with their places.

pub(crate) mod builder;
pub(crate) mod cells;
mod columns;
pub(crate) mod configurations;
pub(crate) mod conventions;
pub(crate) mod cursor;
pub(crate) mod encodings;
pub(crate) mod fit_where;
pub(crate) mod header;
pub(crate) mod inputs;
pub(crate) mod kinds;
pub(crate) mod layout;
pub(crate) mod lost;
pub(crate) mod naming;
pub(crate) mod number;
pub(crate) mod numbered;
pub(crate) mod orientation;
pub(crate) mod picture_names;
pub(crate) mod places;
pub(crate) mod roles;
pub(crate) mod row;
pub(crate) mod rows;
pub(crate) mod targets;
pub(crate) mod text;
pub(crate) mod times;
pub(crate) mod understanding;
pub(crate) mod understood;

pub(crate) use columns::{column_names, column_spec, mapping, mapping_values};

use std::collections::BTreeMap;
use std::path::Path;

use crate::table::cells::{Cell, Separator, character_column, split, split_line};
use crate::table::header::{Header, are_units, is_number};
use crate::table::mapping::ColumnMap;
use crate::table::places::Places;
use crate::table::text::{Blocks, Lines, Said};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::limits::Limit;
use poecal_storage::looks_like::model_for_table;

/// Most lines in which the header is sought.
const LINES_ABOVE: usize = 40;
/// Lines below the first row that show whether all rows have another number of cells than the header.
const NEAR: usize = 10;
/// Most lines below the header that are checked if it is none.
const LINES_BELOW: usize = 10;

/// A row, valid until the next one is read.
pub(crate) struct Row<'t> {
    pub(crate) path: &'t Path,
    pub(crate) line: usize,
    pub(crate) text: &'t str,
    pub(crate) cells: &'t [Cell<'t>],
    /// Where it is in the file, if the table was made of another text.
    places: Option<&'t Places>,
}

/// A file, read block by block.
pub(crate) struct Table<'a> {
    pub(crate) header: Header<'a>,
    pub(crate) separator: Separator,
    /// The line that states the separator, as `sep=;`.
    pub(crate) separator_line: Option<usize>,
    blocks: Blocks<'a>,
    /// Of rows that were made of another file, where they are in it.
    places: Option<Places>,
    /// The last line of the header in the blocks.
    header_end: usize,
    /// Whether the rows of the current block are still to be returned.
    unread: bool,
}

/// The rows of a block.
pub(crate) struct TableRows<'t> {
    /// The whole block.
    pub(crate) text: &'t str,
    header: &'t Header<'t>,
    separator: Separator,
    places: Option<&'t Places>,
    lines: Lines<'t>,
    cells: Vec<Cell<'t>>,
    /// Whether no row was returned yet.
    is_first: bool,
}

impl<'a> Table<'a> {
    /// Reads the header with the lines of separator and units; the separator is the mapping's, stated or recognised.
    pub(crate) fn open(path: &'a Path, mut blocks: Blocks<'a>, map: &ColumnMap) -> Result<Self> {
        blocks.begin()?;
        let none =
            || ErrorKind::Syntax.error("found no line with text, expected a header and rows").in_file(path);
        let above = if map.skip_lines == 0 { lines_above(&blocks, map) } else { map.skip_lines };
        let (mut line, mut text) = next_line(&mut blocks, above)?.ok_or_else(none)?;
        if let Some(error) = model_for_table(&text, path, line) {
            return Err(error);
        }
        let stated = stated_separator(path, line, &text)?;
        let separator_line = stated.map(|_| line);
        if stated.is_some() {
            (line, text) = next_line(&mut blocks, line)?.ok_or_else(none)?;
        }
        let separator = map.separator.or(stated).unwrap_or_else(|| Separator::recognised(&text));
        let mut header = Header::new(path, line, &text, separator)?;
        header.ignore(&map.ignore);
        if let Some((line, text)) = next_line(&mut blocks, line)? {
            let mut cells = Vec::new();
            let is_table = split(&text, separator, &mut cells).is_ok() && cells.len() == header.cells.len();
            if is_table && are_units(&cells) {
                header.set_units(line, &text, &cells);
            }
        }
        let below = blocks.lines(line).take(LINES_BELOW);
        header.look_below(below.map(|(line, text)| (line, text.to_owned())));
        if let Some(text) = header.first_row() {
            let mut cells = Vec::new();
            if split(&text, separator, &mut cells).is_ok() && cells.len() == header.cells.len() {
                header.take_names(&cells);
            }
        }
        let (header_end, places) = (header.last_line(), blocks.places().cloned());
        if let Some(places) = &places {
            header.line = places.line(header.line);
            header.sheet.clone_from(&places.sheet);
            header.units_line = header.units_line.map(|line| places.line(line));
        }
        if above > map.skip_lines {
            blocks.say(format!("{}: took line {} for the names of the columns", path.display(), header.line));
        }
        Ok(Table { header, separator, separator_line, blocks, places, header_end, unread: true })
    }

    /// The text before the first block of rows, of blocks that hold what they pass.
    pub(crate) fn passed(&mut self) -> String {
        self.blocks.passed()
    }

    /// Whether the file begins with a byte order mark.
    pub(crate) fn is_marked(&self) -> bool {
        self.blocks.is_marked()
    }

    /// Whether it was made of a file in another form.
    pub(crate) fn is_made(&self) -> bool {
        self.places.is_some()
    }

    /// What the file is that it was made of.
    pub(crate) fn form(&self) -> Option<&'static str> {
        self.places.as_ref().map(|it| it.form)
    }

    /// Of columns that were made what they were made of.
    pub(crate) fn sources(&self) -> Option<&BTreeMap<String, String>> {
        self.places.as_ref().map(|it| &it.sources)
    }

    /// What was understood of a file in another form, in a few words.
    pub(crate) fn understood(&self) -> Option<String> {
        self.places.as_ref().map(|it| it.understood.clone()).filter(|it| !it.is_empty())
    }

    /// The sheet of a workbook that it was made of.
    pub(crate) fn is_sheet(&self) -> bool {
        self.places.as_ref().is_some_and(|it| it.sheet.is_some())
    }

    /// What was understood of the file, once.
    pub(crate) fn said(&mut self) -> Said {
        self.blocks.said()
    }

    /// Checksum of the bytes read so far.
    pub(crate) fn sha256(&self) -> Option<String> {
        self.blocks.sha256()
    }

    /// The rows of the next block.
    pub(crate) fn next_block(&mut self) -> Result<Option<TableRows<'_>>> {
        let is_first = std::mem::take(&mut self.unread);
        if !is_first && !self.blocks.advance()? {
            return Ok(None);
        }
        let Table { header, separator, blocks, places, header_end, .. } = self;
        let lines = blocks.lines(*header_end);
        let (text, places) = (blocks.text(), places.as_ref());
        Ok(Some(TableRows {
            text,
            header,
            separator: *separator,
            places,
            lines,
            cells: Vec::new(),
            is_first,
        }))
    }
}

impl TableRows<'_> {
    /// The next row that is not empty.
    pub(crate) fn next(&mut self) -> Result<Option<Row<'_>>> {
        let Header { path, line: header_line, .. } = *self.header;
        loop {
            let Some((line, text)) = self.lines.next() else { return Ok(None) };
            split_line(path, line, text, self.separator, &mut self.cells)?;
            let (found, expected) = (self.cells.len(), self.header.cells.len());
            if self.cells.iter().all(|cell| cell.raw.is_empty()) {
                continue;
            }
            if self.is_ended_otherwise(expected) {
                self.cells.resize(expected, Cell::EMPTY);
            } else if found != expected {
                let place = match self.cells.get(expected) {
                    Some(extra) => character_column(text, extra.offset),
                    None => text.trim_end().chars().count() + 1,
                };
                return Err(ErrorKind::Syntax
                    .error(format!(
                        "found {found} cell{}, expected {expected} as in the header (line {header_line}){}",
                        if found == 1 { "" } else { "s" },
                        self.count_hint(text)
                    ))
                    .at(path, line, place));
            }
            for (at, name) in &self.header.names {
                if let Some(cell) = self.cells.get(*at).filter(|cell| cell.text().trim() != name) {
                    let message = format!(
                        "found the joint `{}` in column `{}`, expected `{name}` as in the first row: write the rows of each order into a file of their own",
                        cell.text(),
                        self.header.cells.get(*at).map_or("", |it| it.text.as_str())
                    );
                    let place = character_column(text, cell.offset);
                    return Err(ErrorKind::Measurement.error(message).at(path, line, place));
                }
            }
            self.is_first = false;
            let line = self.places.map_or(line, |places| places.line(line));
            return Ok(Some(Row { path, line, text, cells: &self.cells, places: self.places }));
        }
    }

    /// Whether a row has only another number of empty cells at its end than the header.
    fn is_ended_otherwise(&self, expected: usize) -> bool {
        let found = self.cells.len();
        let more = self.cells.get(expected..).unwrap_or_default();
        let missing = self.header.cells.get(found..).unwrap_or_default();
        found != expected
            && more.iter().all(|cell| cell.raw.is_empty())
            && missing.iter().all(|cell| cell.text.is_empty())
    }

    /// Advice for a row with another number of cells than the header.
    fn count_hint(&self, text: &str) -> String {
        let (found, expected) = (self.cells.len(), self.header.cells.len());
        let mut cells = Vec::new();
        let is_alike = |line: &str| {
            let mut cells = Vec::new();
            split(line, self.separator, &mut cells).is_ok() && cells.len() == found
        };
        // The first row, and all others near it.
        let near: Vec<(usize, &str)> = self.lines.clone().take(NEAR).collect();
        let is_of_all = self.is_first && near.len() > 1 && near.iter().all(|it| is_alike(it.1));
        if is_of_all && found.abs_diff(expected) == 1 {
            return if found > expected {
                "; all rows have one more: the header has one name too few, as where row numbers have none, put a name in front".to_owned()
            } else {
                "; all rows have one fewer: the header has one name too many, take out that of the column that the rows do not have".to_owned()
            };
        }
        let others = [Separator::Comma, Separator::Semicolon, Separator::Tab];
        let other = others.into_iter().find(|&other| {
            other != self.separator && split(text, other, &mut cells).is_ok() && cells.len() == expected
        });
        if let Some(other) = other {
            format!("; separated by {} there are {expected}: separate header and rows alike", other.symbol())
        } else if found > expected && self.separator == Separator::Comma {
            "; numbers with a decimal comma need another separator, such as `;`, or quotes".to_owned()
        } else if found < expected {
            "; add the missing cells (they may be empty), or put `#` in front of a line that is no row"
                .to_owned()
        } else {
            String::new()
        }
    }
}

/// Number of lines above the header of a table that begins with other lines: the first line that names columns and has rows of numbers below it, or
/// below a line of units, if the lines before are no table.
fn lines_above(blocks: &Blocks<'_>, map: &ColumnMap) -> usize {
    let some: Vec<(usize, &str)> = blocks.lines(0).take(LINES_ABOVE).collect();
    let separator = |text: &str| map.separator.unwrap_or_else(|| Separator::recognised(text));
    // Numbers of cells with a text and with a number, but for empty ones.
    let counts = |text: &str, by: Separator| {
        let mut cells = Vec::new();
        if split(text, by, &mut cells).is_err() {
            return (0, 0);
        }
        let numbers = cells.iter().filter(|cell| is_number(cell.raw)).count();
        (cells.iter().filter(|cell| !cell.raw.is_empty()).count() - numbers, numbers)
    };
    let is_header = |at: usize| {
        let Some((_, text)) = some.get(at) else { return false };
        let by = separator(text);
        let (names, numbers) = counts(text, by);
        let is_row = |row: usize| some.get(row).is_some_and(|it| 2 * counts(it.1, by).1 >= names);
        let is_units = |row: usize| some.get(row).is_some_and(|it| counts(it.1, by).1 == 0);
        let first = if is_units(at + 1) { at + 2 } else { at + 1 };
        let is_second = some.get(first + 1).is_none() || is_row(first + 1);
        names >= 3 && numbers == 0 && is_row(first) && is_second
    };
    let is_stated =
        some.first().is_some_and(|it| it.1.trim_start_matches('"').to_lowercase().starts_with("sep="));
    if is_stated || is_header(0) {
        return 0;
    }
    // Lines with as many cells are of one table.
    let width = |at: usize| some.get(at).map(|it| counts(it.1, separator(it.1))).map_or(0, |it| it.0 + it.1);
    (1..some.len())
        .find(|at| is_header(*at) && width(*at) != width(0))
        .and_then(|at| some.get(at))
        .map_or(0, |it| it.0 - 1)
}

/// The first line after line `skip` that is neither blank nor a comment.
fn next_line(blocks: &mut Blocks<'_>, skip: usize) -> Result<Option<(usize, String)>> {
    loop {
        if let Some((line, text)) = blocks.lines(skip).next() {
            return Ok(Some((line, text.to_owned())));
        }
        if !blocks.advance()? {
            return Ok(None);
        }
    }
}

/// The separator stated by a line `sep=;`, as spreadsheets write it.
fn stated_separator(path: &Path, line: usize, text: &str) -> Result<Option<Separator>> {
    let text = text.strip_prefix('"').and_then(|text| text.trim_end().strip_suffix('"')).unwrap_or(text);
    let Some(stated) = text.get(..4).filter(|start| start.eq_ignore_ascii_case("sep=")) else {
        return Ok(None);
    };
    let stated = text.get(stated.len()..).unwrap_or_default();
    let mut characters = stated.chars();
    let separator = characters.next().and_then(Separator::of);
    match separator {
        Some(separator) if characters.all(|c| separator.matches(c) || c == ' ') => Ok(Some(separator)),
        _ => Err(ErrorKind::Syntax
            .error(format!("found the separator `{stated}`, expected `,`, `;`, a tab or a blank"))
            .at(path, line, 1)),
    }
}

/// Refuses rows beyond the limit: they are held in memory, and a pipe may be endless.
pub(crate) fn refuse_more_rows(read: usize, row: &Row<'_>) -> Result<()> {
    if read <= Limit::Rows.most_held() {
        return Ok(());
    }
    Err(ErrorKind::Measurement.error(Limit::Rows.exceeded("one file")).at_line(row.path, row.line))
}

impl Row<'_> {
    /// Line and column (characters, from 1) of a cell.
    pub(crate) fn place(&self, index: usize) -> (usize, usize) {
        let offset = self.cells.get(index).map_or(0, |cell| cell.offset);
        (self.line, character_column(self.text, offset))
    }

    /// An error at a cell.
    pub(crate) fn error(&self, index: usize, message: impl Into<String>) -> Error {
        let (line, column) = self.place(index);
        match self.places {
            Some(places) => places.error(self.path, line, index, ErrorKind::Measurement, message.into()),
            None => ErrorKind::Measurement.error(message).at(self.path, line, column),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_storage::limits;

    #[test]
    fn a_row_too_many_is_refused() {
        let row = Row { path: Path::new(PATH), line: 7, text: "", cells: &[], places: None };
        limits::on(limits::here().with(Limit::Rows, 3), || {
            assert!(refuse_more_rows(3, &row).is_ok());
            let error = refuse_more_rows(4, &row).unwrap_err().to_string();
            assert!(
                error.starts_with("x.csv:7: found more than 3 rows in one file, expected at most"),
                "{error}"
            );
        });
    }

    const PATH: &str = "x.csv";
    /// More bytes than any text here has, but one.
    const WHOLE: usize = 1 << 18;

    /// Line number and cells of each row, or what is wrong, when so many bytes are read at a time.
    fn rows(bytes: &[u8], size: usize) -> std::result::Result<Vec<(usize, Vec<String>)>, String> {
        let path = Path::new(PATH);
        let read = || {
            let mut table = Table::open(path, Blocks::sized(path, bytes, size), &ColumnMap::default())?;
            let mut found = Vec::new();
            while let Some(mut rows) = table.next_block()? {
                while let Some(row) = rows.next()? {
                    found.push((row.line, row.cells.iter().map(|cell| cell.text().into_owned()).collect()));
                }
            }
            Ok(found)
        };
        read().map_err(|error: Error| error.to_string())
    }

    /// Cuts a good file at every byte, and puts every awkward byte at every place.
    #[test]
    fn a_damaged_file_is_the_same_table_however_its_blocks_fall() {
        let good = "\u{feff}# c\r\n\r\n # \u{e9}\r\n\"id\";a[deg];\u{b5}\r\n\"1\";0,5;\u{e9}\r\n\r\n#\r\n2;1;\"q\"\r\n";
        let around = format!(
            "sep=;\n{}",
            good.trim_start_matches('\u{feff}').replacen("\r\n\"1\"", "\r\n#\r\n;deg;\r\n\"1\"", 1)
        );
        let (mut tables, mut errors) = (0, 0);
        let mut attempt = |bytes: &[u8]| {
            let whole = rows(bytes, WHOLE);
            for size in [1, 2, 5, 16] {
                assert_eq!(rows(bytes, size), whole, "{size}: {:?}", String::from_utf8_lossy(bytes));
            }
            if whole.is_ok() { tables += 1 } else { errors += 1 }
        };
        assert_eq!(
            rows(around.as_bytes(), WHOLE),
            rows(good.as_bytes(), WHOLE)
                .map(|rows| { rows.into_iter().map(|(line, cells)| (line + 3, cells)).collect() })
        );
        for (good, at) in
            [good, &around].into_iter().flat_map(|text| (0..text.len()).map(move |at| (text, at)))
        {
            attempt(&good.as_bytes()[..at]);
            for byte in [b'"', b';', b',', b'\n', b'\r', b'[', b']', b'-', b'#', 0, 0xff] {
                let mut bytes = good.as_bytes().to_vec();
                bytes[at] = byte;
                attempt(&bytes);
                bytes.insert(at, byte);
                attempt(&bytes);
            }
        }
        println!("{tables} tables, {errors} errors");
        assert!(tables > 100 && errors > 100);
    }

    #[test]
    fn what_is_no_text_is_named_with_its_place() {
        let text = "a,b\n".repeat(WHOLE / 2);
        let of = |rest: &[u8]| rows(&[text.as_bytes(), rest].concat(), WHOLE).unwrap_err();
        let advice = "expected text; save the file as `CSV UTF-8`";
        assert_eq!(
            rows(
                &["\u{b5},b\n", &text]
                    .map(str::as_bytes)
                    .concat()
                    .into_iter()
                    .chain(*b"3,\xef\xbf")
                    .collect::<Vec<u8>>(),
                WHOLE
            )
            .unwrap_err(),
            format!("x.csv:131074:3: found the byte 0xEF, {advice}")
        );
        assert_eq!(of(b"1,2\n\0"), format!("x.csv:131074:1: found a NUL byte, {advice}"));
    }
}
