//! The rows of a table, one after the other, and what their cells say.

use std::borrow::Cow;
use std::fmt::Arguments;

use super::number::Numbers;
use super::{Row, Table, refuse_more_rows};
use poecal_numerics::error::{ErrorKind, Result};

impl Table<'_> {
    /// Hands over each row, as many as are held in memory, and counts them; there may be none.
    pub(crate) fn each_row(&mut self, mut take: impl FnMut(&Row<'_>) -> Result<()>) -> Result<usize> {
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

    /// The same of a table that has a row; `expected` says what it would be.
    pub(crate) fn some_rows(
        &mut self,
        expected: &str,
        take: impl FnMut(&Row<'_>) -> Result<()>,
    ) -> Result<usize> {
        match self.each_row(take)? {
            0 => Err(ErrorKind::Measurement
                .error(format!("found a header and no rows, expected {expected}"))
                .at_line(self.header.path, self.header.line)),
            count => Ok(count),
        }
    }
}

impl<'t> Row<'t> {
    /// The text of a cell as it is written; none of one that is not there.
    pub(crate) fn raw(&self, at: usize) -> &str {
        self.cells.get(at).map_or("", |cell| cell.raw)
    }

    /// The text in the cell of a column that is there.
    pub(crate) fn cell(&self, column: Option<usize>) -> Option<Cow<'t, str>> {
        Some(self.cells.get(column?)?.text())
    }

    /// The same without blanks around it; empty of a column that is not there.
    pub(crate) fn word(&self, column: Option<usize>) -> String {
        self.cell(column).unwrap_or_default().trim().to_owned()
    }

    /// The number of a cell; `of` says in an error what it is.
    pub(crate) fn number(&self, at: usize, numbers: &mut Numbers, of: Arguments<'_>) -> Result<f64> {
        let text = self.cell(Some(at)).unwrap_or_default();
        let found = numbers.parse(text.trim(), self.line);
        found.map_err(|expected| self.error(at, format!("found `{text}`{of}, expected {expected}")))
    }
}
