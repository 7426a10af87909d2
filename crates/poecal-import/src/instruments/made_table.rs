//! Construction of tables in our form.

use std::io;
use std::path::Path;
use std::sync::Arc;

pub(crate) use super::refusal::{FileLine, Refusal};
use crate::table::number::number_of;
use crate::table::source_cells::{SourceCells, WorkbookSheet};
use crate::table::text::{FileRemarks, LineBlocks};
use poecal_storage::csv_text::cell;
use poecal_storage::numbers::push_number;

/// A table in our form, made of a file in another one: columns, and rows of cells.
#[derive(Clone, Debug, Default)]
pub(crate) struct MadeTable {
    /// Title of the file, as in "a workbook".
    pub(crate) title: &'static str,
    /// Checksum of the file.
    sha256: Option<String>,
    columns: Vec<TableColumn>,
    /// The line that names the columns.
    head: usize,
    rows: Arc<CellRows>,
    /// The sheet of a workbook.
    pub(crate) sheet: Option<WorkbookSheet>,
    /// The frame in which the measurements are, as the file states it.
    pub(crate) frame: Option<String>,
    /// True if that frame is an instrument of its own.
    is_by_frame: bool,
    /// Notes on the interpretation, in a few words each.
    pub(crate) said: Vec<String>,
    /// Warnings, a sentence each.
    pub(crate) warned: Vec<String>,
    /// The name of this set of coordinates and the other set; for a file with two.
    pub(crate) called: Option<CoordinateName>,
    other: Option<Box<MadeTable>>,
}

/// Rows of cells.
#[derive(Clone, Debug, Default)]
struct CellRows {
    /// The line of each row, and the end of its cells.
    ends: Vec<(usize, usize)>,
    /// The cells of all rows, one after the other.
    cells: Vec<HeldCell>,
    texts: String,
}

/// A cell that is held: a text by its end, behind that of the previous text.
#[derive(Clone, Copy, Debug)]
enum HeldCell {
    Text(usize),
    Number(f64),
    Empty,
}

/// The text of rows in our form, which is written while being read.
struct Text {
    rows: Arc<CellRows>,
    /// Text behind the cells of each row.
    behind: String,
    /// Indices of the next row, cell and text.
    next: [usize; 3],
    /// The written text, and the number of its bytes that were read.
    written: String,
    read: usize,
}

/// A column.
#[derive(Clone, Debug, Default)]
pub(crate) struct TableColumn {
    name: String,
    unit: Option<String>,
    /// The name of its source in the file, if that is another.
    source: Option<String>,
}

/// Name of a set of coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CoordinateName {
    Nominal,
    Measured,
    /// The first or the second of two with the same names.
    Unnamed,
}

/// A cell.
#[derive(Clone, Copy, Debug)]
pub(crate) enum CellValue<'a> {
    /// Text as in the file.
    Text(&'a str),
    Number(f64),
    Empty,
}

impl<'a> CellValue<'a> {
    /// A cell of a line; empty if the line is shorter.
    pub(crate) fn cell_at(cells: &[&'a str], at: usize) -> Self {
        cells.get(at).map_or(CellValue::Empty, |it| CellValue::Text(it))
    }

    /// Its number, if it is one.
    pub(crate) fn number(self) -> Option<f64> {
        match self {
            CellValue::Text(text) => number_of(text),
            CellValue::Number(number) => Some(number),
            CellValue::Empty => None,
        }
    }
}

impl TableColumn {
    /// Sets the unit.
    pub(crate) fn in_unit(self, unit: &str) -> Self {
        TableColumn { unit: Some(unit.to_owned()), ..self }
    }

    /// Sets the source, made from its name.
    pub(crate) fn made_of(self, source: impl FnOnce(&str) -> String) -> Self {
        TableColumn { source: Some(source(&self.name)), ..self }
    }

    /// The column's title in a header.
    fn title(&self) -> String {
        self.unit.as_ref().map_or_else(|| self.name.clone(), |unit| format!("{}[{unit}]", self.name))
    }
}

impl<T: Into<String>> From<T> for TableColumn {
    fn from(name: T) -> Self {
        TableColumn { name: name.into(), ..TableColumn::default() }
    }
}

/// Columns x, y, z in a unit.
pub(crate) fn place(unit: &str) -> impl Iterator<Item = TableColumn> {
    ["x", "y", "z"].into_iter().map(move |it| TableColumn::from(it).in_unit(unit))
}

/// Columns of a quaternion, its real part last.
pub(crate) fn quaternion() -> impl Iterator<Item = TableColumn> {
    ["qx", "qy", "qz", "qw"].into_iter().map(TableColumn::from)
}

impl MadeTable {
    /// A table with these columns, named in a line of the file.
    pub(crate) fn new(head: usize, columns: impl IntoIterator<Item = impl Into<TableColumn>>) -> Self {
        MadeTable { head, columns: columns.into_iter().map(Into::into).collect(), ..MadeTable::default() }
    }

    /// Sets the title of the file and its checksum.
    pub(crate) fn of_file(self, title: &'static str, sha256: Option<String>) -> Self {
        MadeTable { title, sha256, ..self }
    }

    /// Adds a row of a line.
    pub(crate) fn row<'c>(&mut self, line: usize, cells: impl IntoIterator<Item = CellValue<'c>>) {
        let CellRows { ends, cells: all, texts } = Arc::make_mut(&mut self.rows);
        all.extend(cells.into_iter().map(|value| match value {
            CellValue::Text(text) => {
                texts.push_str(text);
                HeldCell::Text(texts.len())
            }
            CellValue::Number(number) => HeldCell::Number(number),
            CellValue::Empty => HeldCell::Empty,
        }));
        ends.push((line, all.len()));
    }

    /// Makes its frame that of an instrument of this name.
    pub(crate) fn by_frame(self) -> Self {
        MadeTable { is_by_frame: self.frame.is_some(), ..self }
    }

    /// Makes this the first of two sets of coordinates, with the other one.
    pub(crate) fn with_other(self, [own, called]: [CoordinateName; 2], other: MadeTable) -> Self {
        let other = MadeTable { called: Some(called), ..other };
        MadeTable { called: Some(own), other: Some(Box::new(other)), ..self }
    }

    /// The tables of two sets of coordinates, of a file that has them.
    pub(crate) fn sets(&self) -> Option<[MadeTable; 2]> {
        let other = self.other.as_deref()?;
        let other = other.clone().of_file(self.title, self.sha256.clone());
        Some([MadeTable { other: None, ..self.clone() }, other])
    }

    /// Adds a note on the interpretation, in a few words.
    pub(crate) fn say(&mut self, words: impl Into<String>) {
        self.said.push(words.into());
    }

    /// Adds a warning, a sentence.
    pub(crate) fn warn(&mut self, sentence: impl Into<String>) {
        self.warned.push(sentence.into());
    }

    /// Number of columns.
    pub(crate) fn width(&self) -> usize {
        self.columns.len()
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.rows.ends.len()
    }

    /// Its text from the header on.
    fn reader(&self) -> Text {
        let instrument = self.frame.as_deref().filter(|_| self.is_by_frame).map(cell);
        let titles: Vec<String> = self.columns.iter().map(TableColumn::title).collect();
        let names = titles.iter().map(String::as_str).chain(instrument.iter().map(|_| "instrument"));
        let names: Vec<_> = names.map(cell).collect();
        Text {
            rows: Arc::clone(&self.rows),
            behind: instrument.map_or_else(String::new, |it| format!(",{it}")) + "\n",
            next: [0; 3],
            written: names.join(",") + "\n",
            read: 0,
        }
    }

    /// Its blocks, with the numbers of their lines in the file, and with the notes and warnings.
    pub(crate) fn blocks<'p>(&self, path: &'p Path, expected: &'p str) -> LineBlocks<'p> {
        let sources = self.columns.iter().filter_map(|it| Some((it.title(), it.source.clone()?)));
        let places = SourceCells {
            lines: std::iter::once(self.head).chain(self.rows.ends.iter().map(|it| it.0)).collect(),
            sheet: self.sheet.clone(),
            form: self.title,
            understood: self.said.join("; "),
            sources: sources.collect(),
        };
        let colon = if places.understood.is_empty() { "" } else { ": " };
        let note = format!("{}: took it for {}{colon}{}", path.display(), self.title, places.understood);
        let warnings = self.warned.iter().map(|it| format!("{}: {it}", path.display())).collect();
        let said = FileRemarks { notes: vec![note], warnings };
        LineBlocks::from_made_text(path, expected, Box::new(self.reader()), self.sha256.clone())
            .with_places(places, said)
    }
}

impl Text {
    /// Writes the next row; false behind the last one.
    fn advance(&mut self) -> bool {
        let [row, start, mut text] = self.next;
        let Some((_, end)) = self.rows.ends.get(row) else { return false };
        for (column, held) in self.rows.cells.get(start..*end).unwrap_or_default().iter().enumerate() {
            if column > 0 {
                self.written.push(',');
            }
            match *held {
                HeldCell::Text(end) => {
                    self.written.push_str(&cell(self.rows.texts.get(text..end).unwrap_or_default()));
                    text = end;
                }
                HeldCell::Number(number) => push_number(&mut self.written, number),
                HeldCell::Empty => {}
            }
        }
        self.next = [row + 1, *end, text];
        self.written.push_str(&self.behind);
        true
    }
}

impl io::Read for Text {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if self.read == self.written.len() {
            self.written.clear();
            self.read = 0;
        }
        while self.written.len() < into.len() && self.advance() {}
        let mut rest = self.written.as_bytes().get(self.read..).unwrap_or_default();
        let count = rest.read(into)?;
        self.read += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The text of a table, read in pieces of `size` bytes, with the line of the file for each line.
    fn text(made: &MadeTable, size: usize) -> (String, Vec<usize>) {
        let mut blocks = made.blocks(Path::new("x.txt"), "a table");
        blocks.begin().unwrap();
        let places = blocks.places().unwrap().lines.clone();
        let rows = Text { written: String::new(), ..made.reader() };
        let mut reader = io::BufReader::with_capacity(size, rows);
        let mut found = String::new();
        io::Read::read_to_string(&mut reader, &mut found).unwrap();
        assert!(blocks.text().ends_with(&found));
        (blocks.text().to_owned(), places)
    }

    #[test]
    fn typed_cells_become_a_text_that_reads_back_the_same() {
        let columns = [TableColumn::from("a,b"), TableColumn::from("x").in_unit("mm"), TableColumn::from("=c")];
        let mut made = MadeTable::new(3, columns).of_file("a form", None);
        made.row(5, [CellValue::Text("=1+1"), CellValue::Number(0.1 + 0.2), CellValue::Empty]);
        made.row(9, [CellValue::Text("-1.5"), CellValue::Number(-0.0), CellValue::Text("say \"hi\"")]);
        made.row(7, []);
        for size in [1, 3, 1 << 16] {
            let (found, lines) = text(&made, size);
            let expected = "\"a,b\",x[mm],'=c\n'=1+1,0.30000000000000004,\n-1.5,0,\"say \"\"hi\"\"\"\n\n";
            assert_eq!((found.as_str(), lines), (expected, vec![3, 5, 9, 7]), "{size}");
        }
        made.frame = Some("A, B".to_owned());
        let (found, _) = text(&made.by_frame(), 1);
        assert!(found.starts_with("\"a,b\",x[mm],'=c,instrument\n'=1+1,0.30000000000000004,,\"A, B\"\n"), "{found}");
    }
}
