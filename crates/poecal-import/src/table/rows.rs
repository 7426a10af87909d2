//! The rows of a table, one after the other, and their cells.

use std::borrow::Cow;
use std::fmt::Arguments;

use super::cells::{Cell, Separator, character_column, split, split_line};
use super::header::Header;
use super::number::NumberReader;
use super::{FileRow, FileTable, TableRows, refuse_more_rows};
use poecal_numerics::error::{ErrorKind, Result};

/// Number of lines below the first row that show whether all rows have another number of cells than the header.
const NEAR: usize = 10;

impl FileTable<'_> {
    /// Passes each row to `take`, as many as are held in memory, and counts them; there may be none.
    pub(crate) fn each_row(&mut self, mut take: impl FnMut(&FileRow<'_>) -> Result<()>) -> Result<usize> {
        let mut count = 0;
        while let Some(mut rows) = self.next_block()? {
            while let Some(row) = rows.next()? {
                count += 1;
                refuse_more_rows(count, &row)?;
                take(&row)?;
            }
        }
        Ok(count)
    }

    /// Passes the rows of a table that must have one; `expected` describes it.
    pub(crate) fn some_rows(&mut self, expected: &str, take: impl FnMut(&FileRow<'_>) -> Result<()>) -> Result<usize> {
        match self.each_row(take)? {
            0 => Err(ErrorKind::Measurement
                .error(format!("found a header and no rows, expected {expected}"))
                .at_line(self.header.path, self.header.line)),
            count => Ok(count),
        }
    }
}

impl TableRows<'_> {
    /// The next row that is not empty.
    pub(crate) fn next(&mut self) -> Result<Option<FileRow<'_>>> {
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
                    .at_position(path, line, place));
            }
            for (at, name) in &self.header.names {
                if let Some(cell) = self.cells.get(*at).filter(|cell| cell.text().trim() != name) {
                    let message = format!(
                        "found the joint `{}` in column `{}`, expected `{name}` as in the first row: write the rows of each order into a file of their own",
                        cell.text(),
                        self.header.cells.get(*at).map_or("", |it| it.text.as_str())
                    );
                    let place = character_column(text, cell.offset);
                    return Err(ErrorKind::Measurement.error(message).at_position(path, line, place));
                }
            }
            self.is_first = false;
            let line = self.places.map_or(line, |places| places.line(line));
            return Ok(Some(FileRow { path, line, text, cells: &self.cells, places: self.places }));
        }
    }

    /// True if a row differs from the header only in the number of empty cells at its end.
    fn is_ended_otherwise(&self, expected: usize) -> bool {
        let found = self.cells.len();
        let more = self.cells.get(expected..).unwrap_or_default();
        let missing = self.header.cells.get(found..).unwrap_or_default();
        found != expected
            && more.iter().all(|cell| cell.raw.is_empty())
            && missing.iter().all(|cell| cell.text.is_empty())
    }

    /// Remedy for a row with another number of cells than the header.
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
            "; add the missing cells (they may be empty), or put `#` in front of a line that is no row".to_owned()
        } else {
            String::new()
        }
    }
}

impl<'t> FileRow<'t> {
    /// The text of a cell in the file; empty if there is no such cell.
    pub(crate) fn raw_text(&self, at: usize) -> &str {
        self.cells.get(at).map_or("", |cell| cell.raw)
    }

    /// The text in the cell of a column that exists.
    pub(crate) fn cell(&self, column: Option<usize>) -> Option<Cow<'t, str>> {
        Some(self.cells.get(column?)?.text())
    }

    /// The text without blanks around it; empty if the column does not exist.
    pub(crate) fn word(&self, column: Option<usize>) -> String {
        self.cell(column).unwrap_or_default().trim().to_owned()
    }

    /// The number of a cell; `of` describes it in an error.
    pub(crate) fn number(&self, at: usize, numbers: &mut NumberReader, of: Arguments<'_>) -> Result<f64> {
        let text = self.cell(Some(at)).unwrap_or_default();
        let found = numbers.parse(text.trim(), self.line);
        found.map_err(|expected| self.error(at, format!("found `{text}`{of}, expected {expected}")))
    }
}
