//! A file as a table: header and rows with their places.

use std::collections::BTreeMap;
use std::path::Path;

use super::cells::{Cell, Separator, character_column, split};
use super::mapping::ColumnMap;
use super::text::{Blocks, Lines};
use crate::error::{Error, ErrorKind, Result, first_few, nearest};
use crate::io::looks_like::model_for_table;

/// A column of the header: `name[unit]`.
#[derive(Clone, Debug)]
pub(super) struct HeaderCell {
    /// As it stands in the file.
    pub(super) text: String,
    /// Without the unit.
    pub(super) name: String,
    /// What the brackets hold.
    pub(super) unit: Option<String>,
    column: usize,
}

/// The line that names the columns.
pub(super) struct Header<'a> {
    pub(super) path: &'a Path,
    pub(super) line: usize,
    pub(super) cells: Vec<HeaderCell>,
    /// The first and the second column of each name, with and without its unit.
    named: BTreeMap<String, (usize, Option<usize>)>,
}

/// A row, as long as the next one is not read.
pub(super) struct Row<'t> {
    pub(super) path: &'t Path,
    pub(super) line: usize,
    pub(super) text: &'t str,
    pub(super) cells: &'t [Cell<'t>],
}

/// A file being read block by block.
pub(super) struct Table<'a> {
    pub(super) header: Header<'a>,
    pub(super) separator: Separator,
    blocks: Blocks<'a>,
    /// Whether the block at hand, the header's, has yet to give its rows.
    unread: bool,
}

/// The rows of a block, one after the other.
pub(super) struct Rows<'t> {
    header: &'t Header<'t>,
    separator: Separator,
    lines: Lines<'t>,
    cells: Vec<Cell<'t>>,
}

impl<'a> Table<'a> {
    /// Reads the header; the separator is the mapping's or recognised.
    pub(super) fn open(path: &'a Path, mut blocks: Blocks<'a>, map: &ColumnMap) -> Result<Self> {
        while blocks.advance()? {
            let Some((line, text)) = blocks.lines(map.skip_lines).next() else { continue };
            if let Some(error) = model_for_table(text, path, line) {
                return Err(error);
            }
            let separator = map.separator.unwrap_or_else(|| Separator::recognised(text));
            let header = Header::new(path, line, text, separator)?;
            return Ok(Table { header, separator, blocks, unread: true });
        }
        let message = "found no line with text, expected a header and rows";
        Err(Error::new(ErrorKind::Syntax, message).in_file(path))
    }

    /// The checksum of the file, as far as it has been read.
    pub(super) fn sha256(&self) -> Option<String> {
        self.blocks.sha256()
    }

    /// The rows of the next block.
    pub(super) fn next_block(&mut self) -> Result<Option<Rows<'_>>> {
        if !std::mem::take(&mut self.unread) && !self.blocks.advance()? {
            return Ok(None);
        }
        let Table { header, separator, blocks, .. } = self;
        let lines = blocks.lines(header.line);
        Ok(Some(Rows { header, separator: *separator, lines, cells: Vec::new() }))
    }
}

impl Rows<'_> {
    /// The next row that is not empty.
    pub(super) fn next(&mut self) -> Result<Option<Row<'_>>> {
        let Header { path, line: header_line, .. } = *self.header;
        loop {
            let Some((line, text)) = self.lines.next() else { return Ok(None) };
            split_line(path, line, text, self.separator, &mut self.cells)?;
            let (found, expected) = (self.cells.len(), self.header.cells.len());
            if self.cells.iter().all(|cell| cell.raw.is_empty()) {
                continue;
            }
            if found != expected {
                let place = match self.cells.get(expected) {
                    Some(extra) => character_column(text, extra.offset),
                    None => text.trim_end().chars().count() + 1,
                };
                let message = format!(
                    "found {found} cells, expected {expected} as in the header (line {header_line}){}",
                    self.decimal_comma_hint(found, expected)
                );
                return Err(Error::new(ErrorKind::Syntax, message).at(path, line, place));
            }
            return Ok(Some(Row { path, line, text, cells: &self.cells }));
        }
    }

    fn decimal_comma_hint(&self, found: usize, expected: usize) -> &'static str {
        if self.separator == Separator::Comma && found > expected {
            "; numbers with a decimal comma need another separator, such as `;`, or quotes"
        } else {
            ""
        }
    }
}

fn split_line<'a>(
    path: &Path,
    line: usize,
    text: &'a str,
    separator: Separator,
    cells: &mut Vec<Cell<'a>>,
) -> Result<()> {
    split(text, separator, cells).map_err(|(offset, message)| {
        Error::new(ErrorKind::Syntax, message).at(path, line, character_column(text, offset))
    })
}

impl HeaderCell {
    fn new(text: &str, column: usize) -> Self {
        let bracketed = text.strip_suffix(']').and_then(|rest| rest.rsplit_once('['));
        let (name, unit) = match bracketed {
            Some((name, unit)) => (name.trim_end(), Some(unit.trim().to_owned())),
            None => (text, None),
        };
        HeaderCell {
            text: text.to_owned(),
            name: name.to_owned(),
            unit: unit.filter(|unit| !unit.is_empty()),
            column,
        }
    }
}

impl<'a> Header<'a> {
    fn new(path: &'a Path, line: usize, text: &str, separator: Separator) -> Result<Self> {
        let mut cells = Vec::new();
        split_line(path, line, text, separator, &mut cells)?;
        // Counted on from cell to cell: there may be very many.
        let (mut column, mut offset) = (1, 0);
        let mut cell = |cell: &Cell<'_>| {
            column += text.get(offset..cell.offset).map_or(0, |passed| passed.chars().count());
            offset = offset.max(cell.offset);
            HeaderCell::new(&cell.text(), column)
        };
        let cells: Vec<HeaderCell> = cells.iter().map(&mut cell).collect();
        if cells.iter().all(|cell| cell.text.replace(',', ".").parse::<f64>().is_ok()) {
            let message = "found a line of numbers, expected a header that names the columns \
                           (a line that begins with `#` is a comment)";
            return Err(Error::new(ErrorKind::Syntax, message).at_line(path, line));
        }
        let mut named: BTreeMap<String, (usize, Option<usize>)> = BTreeMap::new();
        for (index, cell) in cells.iter().enumerate() {
            let texts = [Some(&cell.name), Some(&cell.text).filter(|text| **text != cell.name)];
            for text in texts.into_iter().flatten() {
                match named.get_mut(text) {
                    Some((_, second)) => *second = second.or(Some(index)),
                    None => {
                        named.insert(text.clone(), (index, None));
                    }
                }
            }
        }
        Ok(Header { path, line, cells, named })
    }

    /// Index of the column of this name, which may include the unit as the file writes it.
    pub(super) fn find(&self, name: &str) -> Result<Option<usize>> {
        match self.named.get(name) {
            Some((_, Some(second))) => {
                let message =
                    format!("found a second column `{name}`, expected one; rename or remove one of them");
                Err(self.error(ErrorKind::Measurement, *second, message))
            }
            Some((first, None)) => Ok(Some(*first)),
            None => Ok(None),
        }
    }

    /// How many columns have this name.
    pub(super) fn count(&self, name: &str) -> usize {
        self.cells.iter().filter(|cell| cell.name == name).count()
    }

    /// As [`Header::find`], but the column must be there; `is_known` tells names that cannot be a misspelling of another column's.
    pub(super) fn require(
        &self,
        name: &str,
        purpose: &str,
        is_known: impl Fn(&str) -> bool,
    ) -> Result<usize> {
        if let Some(index) = self.find(name)? {
            return Ok(index);
        }
        let names = || self.cells.iter().map(|cell| cell.name.as_str()).filter(|found| !found.is_empty());
        let hint = match nearest(name, names().filter(|found| !is_known(found))) {
            Some(near) => format!("the nearest name found is `{near}`"),
            None => format!("the columns are {}", first_few(&names().collect::<Vec<_>>())),
        };
        let message = format!("found no column `{name}`, expected one {purpose}; {hint}");
        Err(Error::new(ErrorKind::Measurement, message).at_line(self.path, self.line))
    }

    /// An error at a column's name.
    pub(super) fn error(&self, kind: ErrorKind, index: usize, message: impl Into<String>) -> Error {
        let column = self.cells.get(index).map_or(1, |cell| cell.column);
        Error::new(kind, message).at(self.path, self.line, column)
    }
}

impl Row<'_> {
    /// Line and column (characters, from 1) of a cell.
    pub(super) fn place(&self, index: usize) -> (usize, usize) {
        let offset = self.cells.get(index).map_or(0, |cell| cell.offset);
        (self.line, character_column(self.text, offset))
    }

    /// An error at a cell.
    pub(super) fn error(&self, index: usize, message: impl Into<String>) -> Error {
        let (line, column) = self.place(index);
        Error::new(ErrorKind::Measurement, message).at(self.path, line, column)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let (mut tables, mut errors) = (0, 0);
        let mut attempt = |bytes: &[u8]| {
            let whole = rows(bytes, WHOLE);
            for size in [1, 2, 5, 16] {
                assert_eq!(rows(bytes, size), whole, "{size}: {:?}", String::from_utf8_lossy(bytes));
            }
            if whole.is_ok() { tables += 1 } else { errors += 1 }
        };
        for at in 0..good.len() {
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
        let advice = "expected UTF-8 text; save the file as `CSV UTF-8`";
        assert_eq!(of(b"1,2\n3,\xef\xbf"), format!("x.csv:131074:3: found the byte 0xEF, {advice}"));
        assert_eq!(of(b"1,2\n\0"), format!("x.csv:131074:1: found a NUL byte, {advice}"));
    }
}
