//! Makes tables in our form.

use std::collections::BTreeMap;
use std::path::Path;

use crate::table::places::{Places, Sheet};
use crate::table::text::{Blocks, Said};
use poecal_numerics::error::{Error, ErrorKind};
use poecal_storage::csv_text::cell;
use poecal_storage::numbers::push_number;

/// A table in our form, made of a file in another one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Made {
    text: String,
    lines: Vec<usize>,
    sheet: Option<Sheet>,
    /// The frame that the file says its measurements are in.
    pub(crate) frame: Option<String>,
    /// What was understood, in a few words each.
    pub(crate) said: Vec<String>,
    /// What should be looked at, a sentence each.
    pub(crate) warned: Vec<String>,
    /// Of columns what they were made of, where that has another name in the file.
    pub(crate) sources: BTreeMap<String, String>,
    /// Of a file with two sets of coordinates, what this one is called, and the other one.
    pub(crate) called: Option<Called>,
    pub(crate) other: Option<Box<Made>>,
}

/// What a set of coordinates is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Called {
    Nominal,
    Measured,
    /// The first or the second of two with the same names.
    Unnamed,
}

/// Why a file of a known form is not read, and in which line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Refused {
    line: Option<usize>,
    message: String,
}

/// A cell.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Value<'a> {
    /// As it is in the file.
    Text(&'a str),
    Number(f64),
    Empty,
}

impl Made {
    /// A table with these columns, named in a line of the file.
    pub(crate) fn new<'c>(line: usize, columns: impl IntoIterator<Item = &'c str>) -> Self {
        let mut made = Made::default();
        made.row(line, columns.into_iter().map(Value::Text));
        made
    }

    /// Adds a row of a line.
    pub(crate) fn row<'c>(&mut self, line: usize, cells: impl IntoIterator<Item = Value<'c>>) {
        for (at, value) in cells.into_iter().enumerate() {
            if at > 0 {
                self.text.push(',');
            }
            match value {
                Value::Text(text) => self.text.push_str(&cell(text)),
                Value::Number(number) => push_number(&mut self.text, number),
                Value::Empty => {}
            }
        }
        self.text.push('\n');
        self.lines.push(line);
    }

    /// The same with a text in every row.
    pub(crate) fn with_column(self, name: &str, text: &str) -> Self {
        let (name, text) = (cell(name), cell(text));
        let texts = std::iter::once(name).chain(std::iter::repeat(text));
        let text = self.text.lines().zip(texts).map(|(line, more)| format!("{line},{more}\n")).collect();
        Made { text, ..self }
    }

    /// The same as the first of two sets of coordinates, with the other one.
    pub(crate) fn with_other(self, [own, called]: [Called; 2], other: Made) -> Self {
        let other = Made { called: Some(called), ..other };
        Made { called: Some(own), other: Some(Box::new(other)), ..self }
    }

    /// The same without another set.
    pub(crate) fn alone(&self) -> Self {
        Made { other: None, ..self.clone() }
    }

    /// The same of a sheet of a workbook.
    #[cfg(feature = "workbooks")]
    pub(crate) fn in_sheet(self, sheet: Sheet) -> Self {
        Made { sheet: Some(sheet), ..self }
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.lines.len().saturating_sub(1)
    }

    /// Its blocks.
    pub(crate) fn blocks<'p>(
        self,
        path: &'p Path,
        expected: &'p str,
        sha256: Option<String>,
        title: &'static str,
    ) -> Blocks<'p> {
        let words = self.said.join("; ");
        let said = format!(
            "{}: took it for {title}{}{words}",
            path.display(),
            if words.is_empty() { "" } else { ": " }
        );
        let places = Places {
            lines: self.lines,
            sheet: self.sheet,
            form: title,
            understood: words,
            sources: self.sources,
        };
        let warnings = self.warned.into_iter().map(|it| format!("{}: {it}", path.display())).collect();
        let said = Said { notes: vec![said], warnings };
        Blocks::made(path, expected, self.text, sha256).with_places(places, said)
    }
}

impl Refused {
    /// A file that is not read as a whole.
    pub(crate) fn whole<T>(message: impl Into<String>) -> Result<T, Self> {
        Err(Refused { line: None, message: message.into() })
    }

    /// One that is not read because of a line.
    pub(crate) fn at<T>(line: usize, message: impl Into<String>) -> Result<T, Self> {
        Err(Refused { line: Some(line), message: message.into() })
    }

    /// Of an error without a file.
    pub(crate) fn of(error: &Error) -> Self {
        Refused { line: error.place().and_then(|it| it.line), message: error.message().to_owned() }
    }

    /// The error.
    pub(crate) fn error(self, path: &Path) -> Error {
        let error = ErrorKind::Measurement.error(self.message);
        match self.line {
            Some(line) => error.at_line(path, line),
            None => error.in_file(path),
        }
    }
}
