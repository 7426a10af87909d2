//! Makes tables in our form.

use std::path::Path;

use super::words::number;
use crate::table::places::{Places, Sheet};
use crate::table::text::{Blocks, Said};
use poecal_numerics::error::{Error, ErrorKind};
use poecal_storage::csv_text::cell;
use poecal_storage::numbers::push_number;

/// A table in our form, made of a file in another one: columns, and rows of cells.
#[derive(Clone, Debug, Default)]
pub(crate) struct Made {
    /// What the file is, as in "a workbook".
    pub(crate) title: &'static str,
    /// Checksum of the file.
    sha256: Option<String>,
    columns: Vec<Column>,
    /// The line that names the columns.
    head: usize,
    rows: Vec<Row>,
    /// The cells of all rows, one after the other, and the texts of these.
    cells: Vec<Held>,
    texts: String,
    /// The sheet of a workbook.
    pub(crate) sheet: Option<Sheet>,
    /// The frame that the file says its measurements are in.
    pub(crate) frame: Option<String>,
    /// Whether that is an instrument of its own.
    is_by_frame: bool,
    /// What was understood, in a few words each.
    pub(crate) said: Vec<String>,
    /// What should be looked at, a sentence each.
    pub(crate) warned: Vec<String>,
    /// Of a file with two sets of coordinates, what this one is called, and the other one.
    pub(crate) called: Option<Called>,
    other: Option<Box<Made>>,
}

/// A column.
#[derive(Clone, Debug, Default)]
pub(crate) struct Column {
    name: String,
    unit: Option<String>,
    /// What it was made of, where that has another name in the file.
    source: Option<String>,
}

/// The line of a row, and where its cells end.
#[derive(Clone, Copy, Debug)]
struct Row {
    line: usize,
    end: usize,
}

/// A cell that is held: a text by its end, behind that of the text before.
#[derive(Clone, Copy, Debug)]
enum Held {
    Text(usize),
    Number(f64),
    Empty,
}

/// What a set of coordinates is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Called {
    Nominal,
    Measured,
    /// The first or the second of two with the same names.
    Unnamed,
}

/// A cell.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Value<'a> {
    /// As it is in the file.
    Text(&'a str),
    Number(f64),
    Empty,
}

impl<'a> Value<'a> {
    /// A cell of a line; empty if the line is shorter.
    pub(crate) fn at(cells: &[&'a str], at: usize) -> Self {
        cells.get(at).map_or(Value::Empty, |it| Value::Text(it))
    }

    /// Its number, if it is one.
    pub(crate) fn number(self) -> Option<f64> {
        match self {
            Value::Text(text) => number(text),
            Value::Number(number) => Some(number),
            Value::Empty => None,
        }
    }
}

impl Column {
    /// The same with its unit.
    pub(crate) fn in_unit(self, unit: &str) -> Self {
        Column { unit: Some(unit.to_owned()), ..self }
    }

    /// The same with what it was made of.
    pub(crate) fn made_of(self, source: String) -> Self {
        Column { source: Some(source), ..self }
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// As it stands in a header.
    fn title(&self) -> String {
        self.unit.as_ref().map_or_else(|| self.name.clone(), |unit| format!("{}[{unit}]", self.name))
    }
}

impl<T: Into<String>> From<T> for Column {
    fn from(name: T) -> Self {
        Column { name: name.into(), ..Column::default() }
    }
}

/// Columns x, y, z in a unit.
pub(crate) fn place(unit: &str) -> impl Iterator<Item = Column> {
    ["x", "y", "z"].into_iter().map(move |it| Column::from(it).in_unit(unit))
}

/// Columns of a quaternion, its real part last.
pub(crate) fn quaternion() -> impl Iterator<Item = Column> {
    ["qx", "qy", "qz", "qw"].into_iter().map(Column::from)
}

impl Made {
    /// A table with these columns, named in a line of the file.
    pub(crate) fn new(head: usize, columns: impl IntoIterator<Item = impl Into<Column>>) -> Self {
        Made { head, columns: columns.into_iter().map(Into::into).collect(), ..Made::default() }
    }

    /// The same with what the file is, and its checksum.
    pub(crate) fn of_file(self, title: &'static str, sha256: Option<String>) -> Self {
        Made { title, sha256, ..self }
    }

    /// Adds a row of a line.
    pub(crate) fn row<'c>(&mut self, line: usize, cells: impl IntoIterator<Item = Value<'c>>) {
        for value in cells {
            self.cells.push(match value {
                Value::Text(text) => {
                    self.texts.push_str(text);
                    Held::Text(self.texts.len())
                }
                Value::Number(number) => Held::Number(number),
                Value::Empty => Held::Empty,
            });
        }
        self.rows.push(Row { line, end: self.cells.len() });
    }

    /// The same with its frame as that of an instrument of this name.
    pub(crate) fn by_frame(self) -> Self {
        Made { is_by_frame: self.frame.is_some(), ..self }
    }

    /// The same as the first of two sets of coordinates, with the other one.
    pub(crate) fn with_other(self, [own, called]: [Called; 2], other: Made) -> Self {
        let other = Made { called: Some(called), ..other };
        Made { called: Some(own), other: Some(Box::new(other)), ..self }
    }

    /// The tables of two sets of coordinates, of a file that has them.
    pub(crate) fn sets(&self) -> Option<[Made; 2]> {
        let other = self.other.as_deref()?;
        let other = other.clone().of_file(self.title, self.sha256.clone());
        Some([Made { other: None, ..self.clone() }, other])
    }

    /// Number of columns.
    pub(crate) fn width(&self) -> usize {
        self.columns.len()
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.rows.len()
    }

    /// The columns and rows as a text in our form.
    pub(crate) fn text(&self) -> String {
        let instrument = self.frame.as_deref().filter(|_| self.is_by_frame).map(cell);
        let titles: Vec<String> = self.columns.iter().map(|it| cell(&it.title()).into_owned()).collect();
        let mut text = titles.join(",");
        text.push_str(if instrument.is_some() { ",instrument\n" } else { "\n" });
        let (mut at, mut start) = (0, 0);
        for row in &self.rows {
            for (column, held) in self.cells.get(at..row.end).unwrap_or_default().iter().enumerate() {
                if column > 0 {
                    text.push(',');
                }
                match *held {
                    Held::Text(end) => {
                        text.push_str(&cell(self.texts.get(start..end).unwrap_or_default()));
                        start = end;
                    }
                    Held::Number(number) => push_number(&mut text, number),
                    Held::Empty => {}
                }
            }
            at = row.end;
            if let Some(instrument) = &instrument {
                text.push(',');
                text.push_str(instrument);
            }
            text.push('\n');
        }
        text
    }

    /// Where its lines are in the file.
    pub(crate) fn places(&self) -> Places {
        let sources = self.columns.iter().filter_map(|it| Some((it.title(), it.source.clone()?)));
        Places {
            lines: std::iter::once(self.head).chain(self.rows.iter().map(|it| it.line)).collect(),
            sheet: self.sheet.clone(),
            form: self.title,
            understood: self.said.join("; "),
            sources: sources.collect(),
        }
    }

    /// Its blocks.
    pub(crate) fn blocks<'p>(&self, path: &'p Path, expected: &'p str) -> Blocks<'p> {
        let places = self.places();
        let colon = if places.understood.is_empty() { "" } else { ": " };
        let note = format!("{}: took it for {}{colon}{}", path.display(), self.title, places.understood);
        let warnings = self.warned.iter().map(|it| format!("{}: {it}", path.display())).collect();
        Blocks::made(path, expected, self.text(), self.sha256.clone())
            .with_places(places, Said { notes: vec![note], warnings })
    }
}

/// Why a file of a known form is not read, and in which line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Refused {
    line: Option<usize>,
    message: String,
}

impl<T: Into<String>> From<T> for Refused {
    fn from(message: T) -> Self {
        Refused { line: None, message: message.into() }
    }
}

impl Refused {
    /// A file that is not read as a whole.
    pub(crate) fn whole<T>(message: impl Into<String>) -> Result<T, Self> {
        Err(message.into().into())
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
