//! A file as a table: header and rows with their positions.

pub(crate) mod beam_breaks;
pub(crate) mod cells;
mod columns;
pub(crate) mod configurations;
pub(crate) mod conventions;
pub(crate) mod cursor;
pub(crate) mod encodings;
pub(crate) mod header;
pub(crate) mod header_cells;
pub(crate) mod inputs;
pub(crate) mod kinds;
pub(crate) mod layout;
mod lines;
pub(crate) mod naming;
pub(crate) mod number;
pub(crate) mod numbered_columns;
pub(crate) mod orientation;
pub(crate) mod picture_names;
pub(crate) mod roles;
pub(crate) mod row;
pub(crate) mod rows;
pub(crate) mod source_cells;
mod table_start;
pub(crate) mod text;
pub(crate) mod times;
pub(crate) mod train_where;
pub(crate) mod understanding;
pub(crate) mod understood;

pub(crate) use columns::{builder, column_names, column_spec, mapping, mapping_values, motors, targets};

use std::collections::BTreeMap;
use std::path::Path;

use crate::table::cells::{Cell, Separator, character_column, split};
use crate::table::header::Header;
use crate::table::header_cells::are_units;
use crate::table::lines::Lines;
use crate::table::mapping::ColumnMap;
use crate::table::source_cells::SourceCells;
use crate::table::table_start::{lines_above, next_line, stated_separator};
use crate::table::text::{FileRemarks, LineBlocks};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::limits::ResourceLimit;
use poecal_storage::looks_like::model_for_table;

/// Largest number of lines below the header that are checked if it is none.
const LINES_BELOW: usize = 10;

/// A row, valid until the next one is read.
pub(crate) struct FileRow<'t> {
    pub(crate) path: &'t Path,
    pub(crate) line: usize,
    pub(crate) text: &'t str,
    pub(crate) cells: &'t [Cell<'t>],
    /// Positions of its cells in the file, if the table was made of another text.
    places: Option<&'t SourceCells>,
}

/// A file, read block by block.
pub(crate) struct FileTable<'a> {
    pub(crate) header: Header<'a>,
    pub(crate) separator: Separator,
    /// The line that states the separator, as `sep=;`.
    pub(crate) separator_line: Option<usize>,
    blocks: LineBlocks<'a>,
    /// Positions in the file, for rows that were made of another file.
    places: Option<SourceCells>,
    /// The last line of the header in the blocks.
    header_end: usize,
    /// True if the rows of the current block are still to be returned.
    unread: bool,
}

/// The rows of a block.
pub(crate) struct TableRows<'t> {
    /// The whole block.
    pub(crate) text: &'t str,
    header: &'t Header<'t>,
    separator: Separator,
    places: Option<&'t SourceCells>,
    lines: Lines<'t>,
    cells: Vec<Cell<'t>>,
    /// True if no row was returned yet.
    is_first: bool,
}

impl<'a> FileTable<'a> {
    /// Reads the header with the lines of separator and units; the separator is that of the mapping, a stated or a recognised one.
    pub(crate) fn open(path: &'a Path, mut blocks: LineBlocks<'a>, map: &ColumnMap) -> Result<Self> {
        blocks.begin()?;
        let none = || ErrorKind::Syntax.error("found no line with text, expected a header and rows").in_file(path);
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
        let separator = map.separator.or(stated).unwrap_or_else(|| Separator::recognise(&text));
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
        Ok(FileTable { header, separator, separator_line, blocks, places, header_end, unread: true })
    }

    /// The text before the first block of rows, if the blocks keep it.
    pub(crate) fn take_passed_text(&mut self) -> String {
        self.blocks.take_passed_text()
    }

    /// True if the file begins with a byte order mark.
    pub(crate) fn is_marked(&self) -> bool {
        self.blocks.is_marked()
    }

    /// True if it was made of a file in another form.
    pub(crate) fn is_made(&self) -> bool {
        self.places.is_some()
    }

    /// The form of the file of which it was made.
    pub(crate) fn form(&self) -> Option<&'static str> {
        self.places.as_ref().map(|it| it.form)
    }

    /// The sources of columns that were made of others.
    pub(crate) fn sources(&self) -> Option<&BTreeMap<String, String>> {
        self.places.as_ref().map(|it| &it.sources)
    }

    /// Interpretation of a file in another form, in a few words.
    pub(crate) fn understood_form(&self) -> Option<String> {
        self.places.as_ref().map(|it| it.understood.clone()).filter(|it| !it.is_empty())
    }

    /// True if it was made of a sheet of a workbook.
    pub(crate) fn is_sheet(&self) -> bool {
        self.places.as_ref().is_some_and(|it| it.sheet.is_some())
    }

    /// Takes the notes and warnings on the file.
    pub(crate) fn take_remarks(&mut self) -> FileRemarks {
        self.blocks.take_remarks()
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
        let FileTable { header, separator, blocks, places, header_end, .. } = self;
        let lines = blocks.lines(*header_end);
        let (text, places) = (blocks.text(), places.as_ref());
        Ok(Some(TableRows { text, header, separator: *separator, places, lines, cells: Vec::new(), is_first }))
    }
}

/// Refuses rows beyond the limit: they are held in memory, and a pipe may be endless.
pub(crate) fn refuse_more_rows(read: usize, row: &FileRow<'_>) -> Result<()> {
    if read <= ResourceLimit::Rows.most_held() {
        return Ok(());
    }
    Err(ErrorKind::Measurement.error(ResourceLimit::Rows.exceeded_error("one file")).at_line(row.path, row.line))
}

impl FileRow<'_> {
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
            None => ErrorKind::Measurement.error(message).at_position(self.path, line, column),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_storage::limits;

    #[test]
    fn a_row_too_many_is_refused() {
        let row = FileRow { path: Path::new(PATH), line: 7, text: "", cells: &[], places: None };
        limits::run_with_limits(limits::current_limits().with_limit(ResourceLimit::Rows, 3), || {
            assert!(refuse_more_rows(3, &row).is_ok());
            let error = refuse_more_rows(4, &row).unwrap_err().to_string();
            assert!(error.starts_with("x.csv:7: found more than 3 rows in one file, expected at most"), "{error}");
        });
    }

    const PATH: &str = "x.csv";
    /// A number of bytes that only one text here exceeds.
    const WHOLE: usize = 1 << 18;

    /// Line number and cells of each row, or the error, if `size` bytes are read at a time.
    fn rows(bytes: &[u8], size: usize) -> std::result::Result<Vec<(usize, Vec<String>)>, String> {
        let path = Path::new(PATH);
        let read = || {
            let mut table =
                FileTable::open(path, LineBlocks::with_block_size(path, bytes, size), &ColumnMap::default())?;
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

    /// A good file is cut at every byte, and every awkward byte is put at every position.
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
        for (good, at) in [good, &around].into_iter().flat_map(|text| (0..text.len()).map(move |at| (text, at))) {
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
