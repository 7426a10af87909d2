//! Positions of the rows of a table in the file of which it was made.

use std::collections::BTreeMap;
use std::path::Path;

use poecal_numerics::error::{Error, ErrorKind};

/// Positions of the rows and columns of a table that was made of another file.
#[derive(Clone, Debug, Default)]
pub(crate) struct SourceCells {
    /// The line of the file of each line of the table.
    pub(crate) lines: Vec<usize>,
    /// The sheet of a workbook.
    pub(crate) sheet: Option<WorkbookSheet>,
    /// Title of the file, as in "a workbook".
    pub(crate) form: &'static str,
    /// Interpretation of the file, in a few words.
    pub(crate) understood: String,
    /// Sources of columns of the table that have another name in the file.
    pub(crate) sources: BTreeMap<String, String>,
}

/// A sheet of a workbook.
#[derive(Clone, Debug, Default)]
pub(crate) struct WorkbookSheet {
    pub(crate) name: String,
    /// Number of the first column, from 0.
    pub(crate) first_column: usize,
}

impl WorkbookSheet {
    /// The name of a cell, like `C7`; the column is one of the table, from 0.
    pub(crate) fn cell(&self, column: usize, row: usize) -> String {
        format!("{}{row}", letters(self.first_column + column))
    }

    /// An error in a cell, by its row of the sheet and its column of the table.
    pub(crate) fn error(&self, path: &Path, (row, column): (usize, usize), kind: ErrorKind, message: &str) -> Error {
        let message = format!("sheet `{}`, cell {}: {message}", self.name, self.cell(column, row));
        Error::new(kind, message).in_file(path)
    }
}

impl SourceCells {
    /// The line of the file of a line of the table.
    pub(crate) fn line(&self, line: usize) -> usize {
        line.checked_sub(1).and_then(|at| self.lines.get(at)).copied().unwrap_or(line)
    }

    /// An error in a row of the table, by its line of the file, and in a column.
    pub(crate) fn error(&self, path: &Path, line: usize, column: usize, kind: ErrorKind, message: String) -> Error {
        match &self.sheet {
            Some(sheet) => sheet.error(path, (line, column), kind, &message),
            None => Error::new(kind, message).at_line(path, line),
        }
    }
}

/// The letters of a column of a sheet, from 0: A to Z, AA and so on.
fn letters(mut column: usize) -> String {
    let mut found = Vec::new();
    loop {
        found.push(char::from(b'A' + u8::try_from(column % 26).unwrap_or_default()));
        match (column / 26).checked_sub(1) {
            Some(next) => column = next,
            None => return found.into_iter().rev().collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_named_as_spreadsheets_name_them() {
        let names = [(0, "A"), (25, "Z"), (26, "AA"), (51, "AZ"), (52, "BA"), (701, "ZZ"), (702, "AAA")];
        for (column, name) in names {
            assert_eq!(letters(column), name);
        }
    }
}
