//! Header: the line of column names, and the line of units that may follow it.

use std::collections::BTreeMap;
use std::path::Path;

use super::cells::{Cell, Separator, character_column, split_line};
use super::column_names::number_of_column;
use super::configurations::advice;
use super::header_cells::{HeaderCell, beside_name, header_cells, is_number, strip_brackets};
use super::inputs::{InputSource, RowInput};
use super::source_cells::WorkbookSheet;
use poecal_fit::input_doubts::{DoubtLocation, InputDoubt};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_numerics::named_unit::{NamedUnit, UnitSource};
use poecal_numerics::unit::Unit;
use poecal_storage::limits::ResourceLimit;

/// The line of column names.
pub(crate) struct Header<'a> {
    pub(crate) path: &'a Path,
    pub(crate) line: usize,
    pub(crate) cells: Vec<HeaderCell>,
    /// First and second column of each name, with and without its unit.
    pub(crate) named: BTreeMap<String, (usize, Option<usize>)>,
    /// The line of units, if there is one.
    pub(crate) units_line: Option<usize>,
    /// The first lines below, for the message if this is no header.
    pub(crate) below: Vec<(usize, String)>,
    /// Columns whose cells name the joint of another column, with the name.
    pub(crate) names: Vec<(usize, String)>,
    /// The sheet of a workbook.
    pub(crate) sheet: Option<WorkbookSheet>,
}

impl<'a> Header<'a> {
    pub(crate) fn new(path: &'a Path, line: usize, text: &str, separator: Separator) -> Result<Self> {
        let mut cells = Vec::new();
        split_line(path, line, text, separator, &mut cells)?;
        if cells.len() > ResourceLimit::Columns.most_held() {
            let found = format!("{} columns", cells.len());
            return Err(ErrorKind::Syntax.error(ResourceLimit::Columns.sentence(&found)).at_line(path, line));
        }
        if cells.iter().all(|cell| is_number(&cell.text())) {
            return Err(ErrorKind::Syntax
                .error(format!(
                    "found a line of numbers, expected a header that names the columns \
                     (a line that begins with `#` is a comment){}",
                    advice(path)
                ))
                .at_line(path, line));
        }
        let cells = header_cells(text, &cells);
        let mut named: BTreeMap<String, (usize, Option<usize>)> = BTreeMap::new();
        for (index, cell) in cells.iter().enumerate() {
            let texts = [Some(&cell.name), Some(&cell.text).filter(|text| **text != cell.name)];
            for text in texts.into_iter().flatten() {
                let places = named.entry(text.clone());
                places.and_modify(|(_, second)| *second = second.or(Some(index))).or_insert((index, None));
            }
        }
        Ok(Header { path, line, cells, named, units_line: None, below: Vec::new(), names: Vec::new(), sheet: None })
    }

    /// Adds the line of units.
    pub(crate) fn set_units(&mut self, line: usize, text: &str, cells: &[Cell<'_>]) {
        self.units_line = Some(line);
        for (header, cell) in self.cells.iter_mut().zip(cells) {
            let unit = cell.text();
            let unit = Some(strip_brackets(&unit)).filter(|unit| !unit.is_empty());
            header.below = unit.map(|unit| (character_column(text, cell.offset), unit.to_owned()));
        }
    }

    /// Replaces names of columns `…position0` by the joint's name in the cells of `…name0`, as in a recorded `JointState`. The first row decides,
    /// and all others must agree.
    pub(crate) fn take_names(&mut self, cells: &[Cell<'_>]) {
        let mut taken = Vec::new();
        for (index, (header, cell)) in self.cells.iter().zip(cells).enumerate() {
            let Some(position) = beside_name(&header.text) else { continue };
            let at = self.named.get(&position).map(|it| it.0);
            let at = at.filter(|at| self.cells.get(*at).is_some_and(|it| it.text == position));
            let name = cell.text().trim().to_owned();
            if let Some(at) = at.filter(|_| !name.is_empty() && !is_number(&name)) {
                taken.push((index, at, name));
            }
        }
        for (_, at, name) in &taken {
            if let Some(cell) = self.cells.get_mut(*at) {
                (cell.name, cell.unit) = (name.clone(), None);
            }
            self.named
                .entry(name.clone())
                .and_modify(|(_, second)| *second = second.or(Some(*at)))
                .or_insert((*at, None));
        }
        self.names = taken.into_iter().map(|(index, _, name)| (index, name)).collect();
    }

    /// Removes names of columns, which then have no meaning; a file need not have them.
    pub(crate) fn ignore(&mut self, names: &[String]) {
        for name in names {
            let Some(at) = self.find(name).ok().flatten() else { continue };
            if let Some(cell) = self.cells.get_mut(at) {
                (cell.text, cell.name, cell.unit) = (String::new(), String::new(), None);
            }
            self.named.retain(|_, places| places.0 != at);
        }
    }

    /// Stores the first lines below, for the message if this is no header.
    pub(crate) fn look_below(&mut self, lines: impl Iterator<Item = (usize, String)>) {
        self.below = lines.collect();
    }

    /// The first row, if it is near.
    pub(crate) fn first_row(&self) -> Option<String> {
        let row = self.below.iter().find(|(line, _)| *line > self.last_line());
        row.map(|(_, text)| text.clone())
    }

    /// The last line of the header.
    pub(crate) fn last_line(&self) -> usize {
        self.units_line.unwrap_or(self.line)
    }

    /// Refuses a column of a dimensionless number with another unit than this.
    pub(crate) fn only_unit(&self, index: usize, expected: &str) -> Result<()> {
        let Some(cell) = self.cells.get(index) else { return Ok(()) };
        let below = self.units_line.zip(cell.below.as_ref());
        let below = below.map(|(line, (column, unit))| (line, *column, strip_brackets(unit)));
        let stated = cell.unit.as_deref().map(|unit| (self.line, cell.column, unit));
        match stated.into_iter().chain(below).find(|(.., unit)| *unit != expected) {
            Some((line, column, unit)) => Err(self.error_at(
                ErrorKind::Unit,
                (line, column, index),
                format!("found the unit `{unit}` of `{}`, expected `{expected}` or none", cell.name),
            )),
            None => Ok(()),
        }
    }

    /// Unit of a column by the header, the line of units, or both.
    pub(crate) fn unit(&self, index: usize, quantity: Unit, purpose: &str) -> Result<Option<(NamedUnit, UnitSource)>> {
        let Some(cell) = self.cells.get(index) else { return Ok(None) };
        let parse = |symbol: &str, place: (usize, usize)| {
            NamedUnit::parse_for(symbol, quantity, &format!(" {purpose}"))
                .map_err(|error| self.error_at(ErrorKind::Unit, (place.0, place.1, index), error.message()))
        };
        let in_header = cell.unit.as_deref().map(|unit| parse(unit, (self.line, cell.column))).transpose()?;
        let Some((line, (column, symbol))) = self.units_line.zip(cell.below.as_ref()) else {
            return Ok(in_header.map(|unit| (unit, UnitSource::Header)));
        };
        let below = parse(symbol, (line, *column))?;
        match in_header {
            Some(unit) if unit != below => {
                let message = format!(
                    "found the unit `{symbol}` below `{}`, expected `{}` as in the header (line {}), or an empty cell",
                    cell.text,
                    unit.symbol(),
                    self.line
                );
                Err(self.error_at(ErrorKind::Unit, (line, *column, index), message))
            }
            Some(unit) => Ok(Some((unit, UnitSource::Header))),
            None => Ok(Some((below, UnitSource::UnitsLine))),
        }
    }

    /// Index of the column of this name, which may include the unit as in the file.
    pub(crate) fn find(&self, name: &str) -> Result<Option<usize>> {
        if let Some(second) = self.second_index(name) {
            let message = format!("found a second column `{name}`, expected one; rename or remove one of them");
            return Err(self.error(ErrorKind::Measurement, second, message));
        }
        let by_number = || number_of_column(name).map(|it| it - 1).filter(|it| *it < self.cells.len());
        Ok(self.named.get(name).map(|(first, _)| *first).or_else(by_number))
    }

    /// Index of a second column of this name, if there is one.
    pub(crate) fn second_index(&self, name: &str) -> Option<usize> {
        self.named.get(name)?.1
    }

    /// Number of columns with this name.
    pub(crate) fn count(&self, name: &str) -> usize {
        self.cells.iter().filter(|cell| cell.name == name).count()
    }

    /// A column's name in the file.
    pub(crate) fn text(&self, index: usize) -> &str {
        self.cells.get(index).map_or("", |cell| cell.text.as_str())
    }

    /// An error at a column's name.
    pub(crate) fn error(&self, kind: ErrorKind, index: usize, message: impl Into<String>) -> Error {
        let column = self.cells.get(index).map_or(1, |cell| cell.column);
        self.error_at(kind, (self.line, column, index), message)
    }

    /// The error of a doubt, at its column.
    pub(crate) fn doubt(&self, doubt: InputDoubt, inputs: &[RowInput]) -> Error {
        let DoubtLocation::Head(input) = doubt.place else { return doubt.error(ErrorKind::Unit, self.path) };
        match inputs.get(input).map(|it| it.source) {
            Some(InputSource::Column(column)) => self.error(ErrorKind::Unit, column, doubt.message),
            Some(InputSource::Constant(_)) | None => doubt.error(ErrorKind::Unit, self.path),
        }
    }

    /// An error at a line, a character and a column of the table.
    fn error_at(
        &self,
        kind: ErrorKind,
        (line, column, index): (usize, usize, usize),
        message: impl Into<String>,
    ) -> Error {
        match &self.sheet {
            Some(sheet) => sheet.error(self.path, (line, index), kind, &message.into()),
            None => Error::new(kind, message).at_position(self.path, line, column),
        }
    }
}
