//! Limits of workbooks in ZIP archives, before any part is held: the unpacked size of the parts, and the cells that a part of .ods repeats.

use std::io::{self, BufReader, Cursor, Read};

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use zip::ZipArchive;

use poecal_storage::limits::{ResourceLimit, amount};

/// The part that names the sheets of a binary workbook (.xlsb), whose reader does not check lengths.
const BINARY: &str = "xl/workbook.bin";
/// The part of .ods that holds all sheets.
const CONTENT: &str = "content.xml";
/// Largest number of columns of a row in .ods: its reader leaves out the others.
const MOST_COLUMNS: u64 = 16_384;
/// Ratio of the limit of texts: the tags of cells count with them.
const MOST_TEXT: u64 = 4;
/// Ratio of the limit of all parts, up to which a workbook is read in which each sheet could be the largest part.
const READ_AGAIN: u64 = 4;

/// Sizes of an archive's parts, bytes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ArchiveParts {
    largest: u64,
}

impl ArchiveParts {
    /// Unpacks all parts without holding them.
    ///
    /// Errors are a binary workbook, and the sentence of the limit that is exceeded. An archive that cannot be read is not an error here.
    pub(crate) fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let Ok(mut archive) = ZipArchive::new(Cursor::new(bytes)) else { return Ok(ArchiveParts::default()) };
        let most = ResourceLimit::Unpacked.value();
        let (mut sum, mut parts) = (0_u64, ArchiveParts::default());
        for at in 0..archive.len() {
            let Ok(part) = archive.by_index(at) else { continue };
            if part.name().eq_ignore_ascii_case(BINARY) {
                return Err(
                    "found a binary workbook (.xlsb), expected .xlsx, .xls or .ods: save it as .xlsx".to_owned()
                );
            }
            let is_content = part.name() == CONTENT;
            let mut counted = CountedReader { inner: part.take(most - sum + 1), count: 0 };
            let cells = if is_content { cells_of_ods(&mut counted) } else { Ok(()) };
            // A reader that needs a damaged part reports it.
            let _ = io::copy(&mut counted, &mut io::sink());
            sum += counted.count;
            parts.largest = parts.largest.max(counted.count);
            if sum > most {
                return Err(ResourceLimit::Unpacked.exceeded_error("the parts of this workbook"));
            }
            cells?;
        }
        Ok(parts)
    }

    /// Refuses a number of sheets whose reading would take too long.
    pub(crate) fn refuse_sheets(self, count: usize) -> Result<(), String> {
        let read = self.largest.saturating_mul(count as u64);
        if read <= ResourceLimit::Unpacked.value().saturating_mul(READ_AGAIN) {
            return Ok(());
        }
        let size = amount(self.largest, ResourceLimit::Unpacked.row().unit);
        Err(ResourceLimit::Unpacked.sentence(&format!("{count} sheets, and a part of {size}")))
    }
}

/// A reader that counts its bytes.
struct CountedReader<R> {
    inner: R,
    count: u64,
}

impl<R: Read> Read for CountedReader<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(into)?;
        self.count += count as u64;
        Ok(count)
    }
}

/// A sheet of .ods while it is read.
#[derive(Default)]
struct OdsSheet {
    /// Rows up to the last one with a cell, and empty ones behind it.
    rows: u64,
    empty_rows: u64,
    /// Columns of the current row up to the last cell, and empty ones behind it.
    columns: u64,
    empty_columns: u64,
    repeated: u64,
    /// Columns of the widest row.
    widest: u64,
    /// Cells of the rows as the file states them, without repetitions.
    written: u64,
    /// Bytes of the current cell and of the current row, with repetitions.
    of_cell: u64,
    of_row: u64,
}

impl OdsSheet {
    fn begin_row(&mut self, repeated: u64) {
        (self.columns, self.empty_columns, self.repeated) = (0, 0, repeated);
        (self.of_cell, self.of_row) = (0, 0);
    }

    /// The end of a cell with its bytes.
    fn end_cell(&mut self, repeated: u64) {
        let own = std::mem::take(&mut self.of_cell).saturating_mul(repeated);
        self.of_row = self.of_row.saturating_add(own);
    }

    fn cell(&mut self, repeated: u64, is_empty: bool) {
        if is_empty {
            self.empty_columns = self.empty_columns.saturating_add(repeated).min(MOST_COLUMNS);
        } else {
            let own = self.columns.saturating_add(self.empty_columns).saturating_add(repeated);
            (self.columns, self.empty_columns) = (own.min(MOST_COLUMNS), 0);
        }
    }

    fn end_row(&mut self) {
        if self.columns == 0 {
            self.empty_rows = self.empty_rows.saturating_add(self.repeated);
            return;
        }
        self.rows = self.rows.saturating_add(self.empty_rows).saturating_add(self.repeated);
        self.empty_rows = 0;
        self.widest = self.widest.max(self.columns);
        self.written = self.written.saturating_add(std::mem::take(&mut self.columns));
    }

    fn cells(&self) -> u64 {
        self.rows.saturating_mul(self.widest).max(self.written.saturating_add(self.columns))
    }
}

/// Refuses the content of .ods whose sheets exceed the limit of cells, or whose texts have more blanks than bytes.
fn cells_of_ods(content: impl Read) -> Result<(), String> {
    let mut reader = Reader::from_reader(BufReader::new(content));
    reader.config_mut().check_end_names = false;
    let (mut buffer, mut before, mut texts) = (Vec::new(), 0_u64, 0_u64);
    let (mut sheet, mut again) = (OdsSheet::default(), 1);
    // The reader of the workbook refuses text that is no XML.
    while let Ok(event) = reader.read_event_into(&mut buffer) {
        match event {
            Event::Eof => break,
            Event::Start(tag) | Event::Empty(tag) if tag.name().as_ref() == b"text:s" => {
                sheet.of_cell = sheet.of_cell.saturating_add(repetition_count(&tag, b"text:c"));
            }
            Event::Text(text) => sheet.of_cell = sheet.of_cell.saturating_add(text.len() as u64),
            Event::Start(tag) if tag.name().as_ref() == b"table:table-row" => {
                sheet.begin_row(repetition_count(&tag, b"table:number-rows-repeated"));
            }
            Event::Start(tag) if is_cell(tag.name().as_ref()) => {
                again = repetition_count(&tag, b"table:number-columns-repeated");
                sheet.cell(again, false);
                sheet.of_cell = tag.len() as u64;
            }
            Event::Empty(tag) if is_cell(tag.name().as_ref()) => {
                let again = repetition_count(&tag, b"table:number-columns-repeated");
                sheet.cell(again, is_empty(&tag));
                sheet.of_cell = if is_empty(&tag) { 0 } else { tag.len() as u64 };
                sheet.end_cell(again.min(MOST_COLUMNS));
            }
            Event::End(tag) if is_cell(tag.name().as_ref()) => sheet.end_cell(again.min(MOST_COLUMNS)),
            Event::End(tag) if tag.name().as_ref() == b"table:table-row" => {
                texts = texts.saturating_add(sheet.of_row.saturating_mul(sheet.repeated));
                sheet.end_row();
            }
            Event::End(tag) if tag.name().as_ref() == b"table:table" => {
                before = before.saturating_add(sheet.cells());
                sheet = OdsSheet::default();
            }
            Event::Start(_)
            | Event::End(_)
            | Event::Empty(_)
            | Event::CData(_)
            | Event::Comment(_)
            | Event::Decl(_)
            | Event::PI(_)
            | Event::DocType(_)
            | Event::GeneralRef(_) => {}
        }
        let cells = before.saturating_add(sheet.cells());
        if cells > ResourceLimit::Cells.value() {
            return Err(ResourceLimit::Cells.exceeded_error("the sheets of this workbook"));
        }
        if texts.saturating_add(sheet.of_row).saturating_add(sheet.of_cell)
            > MOST_TEXT * ResourceLimit::Unpacked.value()
        {
            return Err(ResourceLimit::Unpacked.exceeded_error("the texts of the cells"));
        }
        buffer.clear();
    }
    Ok(())
}

fn is_cell(name: &[u8]) -> bool {
    matches!(name, b"table:table-cell" | b"table:covered-table-cell")
}

/// True if a cell without content has no value either.
fn is_empty(tag: &BytesStart<'_>) -> bool {
    !tag.attributes().flatten().any(|it| {
        let name = it.key.as_ref();
        name.starts_with(b"office:") || name == b"table:formula"
    })
}

/// The number of repetitions; 1 if it is not stated as a number.
fn repetition_count(tag: &BytesStart<'_>, name: &[u8]) -> u64 {
    let stated = tag.attributes().flatten().find(|it| it.key.as_ref() == name);
    let digits = stated.and_then(|it| {
        let text = String::from_utf8_lossy(&it.value).into_owned();
        quick_xml::escape::unescape(&text).ok().map(|it| it.into_owned())
    });
    digits.and_then(|it| it.trim_start_matches('+').parse().ok()).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_storage::limits;

    fn refuse_rows(most: u64, rows: &str) -> Option<String> {
        let content =
            format!("<office:spreadsheet><table:table table:name='A'>{rows}</table:table></office:spreadsheet>");
        limits::run_with_limits(limits::current_limits().with_limit(ResourceLimit::Cells, most), || {
            cells_of_ods(content.as_bytes()).err()
        })
    }

    #[test]
    fn a_binary_workbook_is_refused_by_name() {
        let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
        archive.start_file(BINARY, zip::write::SimpleFileOptions::default()).unwrap();
        let error = ArchiveParts::from_bytes(&archive.finish().unwrap().into_inner()).unwrap_err();
        assert!(error.starts_with("found a binary workbook (.xlsb)"), "{error}");
    }

    #[test]
    fn cells_that_are_repeated_count() {
        let cell =
            |count: u64, value: &str| format!("<table:table-cell table:number-columns-repeated=\"{count}\"{value}/>");
        let row = |count: u64, cells: &str| {
            format!("<table:table-row table:number-rows-repeated=\"{count}\">{cells}</table:table-row>")
        };
        let value = " office:value='1'";
        // Empty cells behind the last cell and the last row, as every program writes them, do not count.
        let plain = row(3, &(cell(2, value) + &cell(16_000, ""))) + &row(1_048_000, &cell(16_384, ""));
        assert_eq!(refuse_rows(6, &plain), None);
        assert!(refuse_rows(5, &plain).is_some_and(|it| it.contains("limit `cells`")));
        // Empty cells before a distant cell count.
        let far = row(1, &cell(1, value)) + &row(999_998, &cell(1, "")) + &row(1, &cell(1, value));
        assert_eq!(refuse_rows(1_000_000, &far), None);
        assert!(refuse_rows(999_999, &far).is_some());
        let right = row(1, &(cell(9_999, "") + &cell(1, value)));
        assert!(refuse_rows(10_000, &right).is_none() && refuse_rows(9_999, &right).is_some());
        // No number overflows.
        assert!(refuse_rows(1000, &row(u64::MAX, &cell(u64::MAX, value))).is_some());
    }
}
