//! Reads a `residuals.csv` back.

use std::borrow::Cow;
use std::path::Path;

use super::rows::{
    CornerErrors, DIAGNOSTICS, FIRST, INSTRUMENT, MODELS, ModelErrors, ResidualRow, Residuals, RowDiagnostics, columns,
    corner_columns,
};
use poecal_import::{Cell, Separator, split};
use poecal_model::measurement::{ByQuantity, MeasuredQuantities, Quantity};
use poecal_model::robot::ReadingKind;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::limits::ResourceLimit;
use poecal_storage::source_text;

/// Advice for a file of another kind.
const EXPECTED: &str = "a residuals.csv as written by this version's `poecal calibrate`";

impl Residuals {
    /// Reads a file.
    ///
    /// # Errors
    /// [`ErrorKind::File`] if it cannot be read, [`ErrorKind::Syntax`] if it is no `residuals.csv` of this version.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::parse(&source_text::read_up_to(path, EXPECTED, ResourceLimit::Table)?, path)
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// [`ErrorKind::Syntax`] if it is no `residuals.csv` of this version.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self> {
        Self::parse_at(text, path.as_ref())
    }

    /// The part of reading that does not depend on the kind of path, compiled once.
    fn parse_at(text: &str, path: &Path) -> Result<Self> {
        let mut found = Residuals::default();
        let (mut named, mut is_head) = (false, true);
        let mut cells = Vec::new();
        for (start, record) in records(text) {
            let done = split(record, Separator::Comma, &mut cells)
                .map_err(|(offset, what)| (offset, format!("{what}, in {EXPECTED}: calibrate again")));
            let done = done.and_then(|()| {
                let texts: Vec<Cow<'_, str>> = cells.iter().map(Cell::text).collect();
                let read = if is_head { found.head(&texts, &mut named) } else { found.row(&texts, named) };
                read.map_err(|CellError { cell, message }| {
                    (cells.get(cell).map_or(record.len(), |cell| cell.offset), message)
                })
            });
            is_head = false;
            done.map_err(|(offset, message)| ErrorKind::Syntax.error(message).at_offset(path, text, start + offset))?;
        }
        Ok(found)
    }

    /// Reads the header; sets `named` to true if the last column names the instrument.
    fn head(&mut self, cells: &[Cow<'_, str>], named: &mut bool) -> std::result::Result<(), CellError> {
        let mut first = 0;
        FIRST.into_iter().try_for_each(|column| expect(cells, &mut first, column))?;
        for quantity in Quantity::ALL {
            let stands_at =
                |at: usize, column: Option<String>| column.is_some_and(|it| cells.get(at) == Some(&it.into()));
            let stands = stands_at(first, columns(quantity, false).next());
            if quantity.is_of_pose() || stands {
                self.has_corrected |= stands_at(first + MODELS, columns(quantity, true).nth(MODELS));
                let mut all = columns(quantity, self.has_corrected);
                all.try_for_each(|column| expect(cells, &mut first, &column))?;
                self.further.extend((!quantity.is_of_pose()).then_some(quantity));
            }
        }
        self.has_corners = corner_columns(false).next().is_some_and(|it| cells.get(first) == Some(&it.into()));
        if self.has_corners {
            let mut all = corner_columns(self.has_corrected);
            all.try_for_each(|column| expect(cells, &mut first, &column))?;
        }
        DIAGNOSTICS.into_iter().try_for_each(|column| expect(cells, &mut first, column))?;
        let cells = match cells.split_last() {
            Some((last, rest)) if last == INSTRUMENT => {
                *named = true;
                rest
            }
            _ => cells,
        };
        for (column, cell) in cells.iter().enumerate().skip(first) {
            let reading = ReadingKind::ALL.into_iter().find_map(|kind| {
                let name = cell.strip_suffix(&format!("[{}]", kind.symbol()))?;
                Some((name.to_owned(), kind))
            });
            let message =
                || format!("found the column `{cell}`, expected a joint's name with [deg] or [mm]: calibrate again");
            self.readings.push(reading.ok_or_else(|| CellError { cell: column, message: message() })?);
        }
        Ok(())
    }

    fn row(&mut self, cells: &[Cow<'_, str>], named: bool) -> std::result::Result<(), CellError> {
        let mut cells = RowCells { cells, next: 0 };
        let file = index_of(&mut self.files, cells.text()?);
        let line = cells.parsed("a line number")?;
        let id = cells.text()?.to_owned();
        let held_out = match cells.text()? {
            "held_out" => true,
            "fit" => false,
            other => return Err(cells.cell_error(other, "fit or held_out")),
        };
        let target = index_of(&mut self.targets, cells.text()?);
        let errors = cells.errors(self.quantities(), self.has_corrected)?;
        let corners = if self.has_corners { cells.corners(self.has_corrected)? } else { None };
        let judged = cells.read_diagnostics()?;
        for _ in 0..self.readings.len() {
            self.values.push(cells.number()?);
        }
        let station = if named { index_of(&mut self.stations, cells.text()?) } else { 0 };
        if let Some(extra) = cells.cells.get(cells.next) {
            cells.next += 1;
            return Err(cells.cell_error(extra, "no further cell"));
        }
        self.push(ResidualRow { file, line, id, held_out, target, station, errors, corners, judged });
        Ok(())
    }
}

/// Skips a column that must have this name.
fn expect(cells: &[Cow<'_, str>], next: &mut usize, expected: &str) -> std::result::Result<(), CellError> {
    let cell = cells.get(*next).map_or("", |cell| cell);
    if cell != expected {
        let message = format!("found the column `{cell}`, expected `{expected}`, as in {EXPECTED}: calibrate again");
        return Err(CellError { cell: *next, message });
    }
    *next += 1;
    Ok(())
}

/// Index of a name, which is added if new.
fn index_of(names: &mut Vec<String>, name: &str) -> usize {
    names.iter().rposition(|known| known == name).unwrap_or_else(|| {
        names.push(name.to_owned());
        names.len() - 1
    })
}

/// Records that are not blank, each with its byte offset: lines, which may break within quotes.
fn records(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let (mut is_quoted, mut next) = (false, 0);
    let records = text.split(move |c| {
        is_quoted ^= c == '"';
        c == '\n' && !is_quoted
    });
    let placed = records.map(move |record| {
        let start = next;
        next += record.len() + 1;
        match record.strip_prefix('\u{feff}') {
            Some(rest) if start == 0 => (record.len() - rest.len(), rest),
            _ => (start, record),
        }
    });
    placed.map(|(start, record)| (start, record.trim_end_matches('\r'))).filter(|(_, it)| !it.is_empty())
}

/// Error, and its cell, from 0.
struct CellError {
    cell: usize,
    message: String,
}

/// The cells of a row, in sequence.
struct RowCells<'a> {
    cells: &'a [Cow<'a, str>],
    next: usize,
}

impl<'a> RowCells<'a> {
    /// An error at the last cell that was read.
    fn cell_error(&self, found: &str, expected: &str) -> CellError {
        CellError {
            cell: self.next.saturating_sub(1),
            message: format!("found `{found}`, expected {expected}: calibrate again"),
        }
    }

    fn text(&mut self) -> std::result::Result<&'a str, CellError> {
        let cell = self.cells.get(self.next).map(|cell| &**cell);
        self.next += 1;
        let message = || "found the end of the row, expected a cell for each column: calibrate again".to_owned();
        cell.ok_or_else(|| CellError { cell: self.next.saturating_sub(1), message: message() })
    }

    fn parsed<T: std::str::FromStr>(&mut self, expected: &str) -> std::result::Result<T, CellError> {
        let cell = self.text()?;
        cell.parse().map_err(|_| self.cell_error(cell, expected))
    }

    fn number(&mut self) -> std::result::Result<f64, CellError> {
        let number: f64 = self.parsed("a number")?;
        let cell = self.next.checked_sub(1).and_then(|last| self.cells.get(last)).map_or("", |cell| cell);
        if number.is_finite() { Ok(number) } else { Err(self.cell_error(cell, "a finite number")) }
    }

    /// True if the next cells are all empty; then they are skipped.
    fn are_empty(&mut self, count: usize) -> bool {
        let here = self.cells.get(self.next..self.next + count);
        let empty = here.is_some_and(|cells| cells.iter().all(|cell| cell.is_empty()));
        self.next += if empty { count } else { 0 };
        empty
    }

    /// Errors of the quantities that have columns, of at least one.
    fn errors(
        &mut self,
        quantities: impl Iterator<Item = Quantity>,
        has_corrected: bool,
    ) -> std::result::Result<MeasuredQuantities<ModelErrors>, CellError> {
        let mut found: ByQuantity<Option<ModelErrors>> = ByQuantity::default();
        for quantity in quantities {
            found[quantity] = self.errors_of(quantity, has_corrected)?;
        }
        let errors = MeasuredQuantities::from_fn(|quantity| found[quantity]);
        if errors.leading_value().is_none() {
            return Err(self.cell_error("", "a number"));
        }
        Ok(errors)
    }

    fn errors_of(
        &mut self,
        quantity: Quantity,
        has_corrected: bool,
    ) -> std::result::Result<Option<ModelErrors>, CellError> {
        let components = quantity.components();
        let mut models = [0.0; MODELS];
        if self.are_empty(models.len() + usize::from(has_corrected) + components) {
            return Ok(None);
        }
        for value in &mut models {
            *value = self.number()?;
        }
        let corrected = if has_corrected { Some(self.number()?) } else { None };
        let mut residual = [0.0; Quantity::MOST_COMPONENTS];
        for value in residual.iter_mut().take(components) {
            *value = if self.are_empty(1) { f64::NAN } else { self.number()? };
        }
        let found = ModelErrors::new(models, residual.get(..components).unwrap_or_default());
        Ok(Some(found.with_corrected(corrected)))
    }

    fn corners(&mut self, has_corrected: bool) -> std::result::Result<Option<CornerErrors>, CellError> {
        if self.are_empty(MODELS + usize::from(has_corrected) + 1) {
            return Ok(None);
        }
        let mut number = || if self.are_empty(1) { Ok(f64::NAN) } else { self.number() };
        let models_px = [number()?, number()?, number()?];
        let corrected_px = if has_corrected { Some(number()?) } else { None };
        Ok(Some(CornerErrors { models_px, corrected_px, at_board_mm: number()? }))
    }

    fn read_diagnostics(&mut self) -> std::result::Result<Option<RowDiagnostics>, CellError> {
        if self.are_empty(4) {
            return Ok(None);
        }
        let weight = self.number()?;
        // Diagnostics may be missing.
        let (leverage, studentized) = (self.parsed("a number")?, self.parsed("a number")?);
        Ok(Some(RowDiagnostics { weight, leverage, studentized, suspected: self.number()? != 0.0 }))
    }
}
