//! Guess of the columns of a file that hold joint readings and measurements, and the mapping file for it. A person looks it over and corrects it.

mod choices;
mod fields;
mod names;
mod text;

use std::path::Path;

use serde::Serialize;

use self::fields::{MOST_RADIANS, UNITS, UnitField, choice_error, choose_unit};
pub use self::fields::{MappedChoice, MappedField};
use self::names::HeaderNames;
use super::ReadOptions;
use super::table::FileTable;
use crate::instruments::{MEASURED, OpenedFile, OpeningContext, WORKBOOK, headerless};
use crate::table::column_names::numbered_column;
use crate::table::header::Header;
use crate::table::mapping::{ColumnMap, PositionSpec};
use crate::table::number::NumberReader;
use crate::table::orientation::OrientationForm;
use poecal_arm::lie::angles::Angles;
use poecal_model::robot::{ReadingKind, Robot};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;

/// Rows that are looked at.
const ROWS: usize = 200;
/// Cells of a column that are shown.
const SHOWN: usize = 3;
/// Columns of a file with their guessed meaning, all other choices, and the mapping that states them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ColumnGuess {
    /// The columns of the file, in their order.
    pub columns: Vec<FoundColumn>,
    /// Fields of the mapping, with the present choice.
    pub fields: Vec<MappedField>,
    /// Columns from which nothing is read.
    pub ignored: Vec<String>,
    /// Required inputs for which there is no column.
    pub missing: Vec<String>,
    /// The mapping file (TOML).
    pub mapping: String,
}

/// A column of a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FoundColumn {
    /// Name of the column in a mapping.
    pub name: String,
    /// Its first cells.
    pub cells: Vec<String>,
}

/// A table's first rows.
struct TableSample<'h> {
    header: &'h Header<'h>,
    names: HeaderNames<'h>,
    columns: Vec<FoundColumn>,
    /// The largest number of each column.
    largest: Vec<f64>,
}

/// Guesses which columns of a file are the joint readings and the measurements. Each item of `chosen` is the key of a field, and the column or word
/// for it, empty for none.
///
/// # Errors
/// Those of [`super::read`] for a file that is no table; [`ErrorKind::Option`] for a form that is read without a mapping, and for a field or a
/// column that does not exist.
pub fn guess_columns(path: impl AsRef<Path>, robot: &Robot, chosen: &[(String, String)]) -> Result<ColumnGuess> {
    guess_at(path.as_ref(), robot, chosen)
}

/// Compiled once, and not for each kind of path.
fn guess_at(path: &Path, robot: &Robot, chosen: &[(String, String)]) -> Result<ColumnGuess> {
    let plain = ReadOptions::default();
    if let OpenedFile::Made(made) = (OpeningContext { robot, options: &plain }).open_file(path, MEASURED)?
        && made.title != WORKBOOK
        && made.title != headerless::FORM.title
    {
        let message = format!(
            "found {}, which is read as it is, expected a table with columns of its own: leave the mapping out",
            made.title
        );
        return Err(ErrorKind::Option.error(message).in_file(path));
    }
    // A mapping that names columns reads the table as it is.
    let position = Some(PositionSpec { columns: Some([1, 2, 3].map(numbered_column)), unit: None });
    let mapping = Some(ColumnMap { position, ..ColumnMap::default() });
    let options = ReadOptions { mapping, ..ReadOptions::default() };
    let blocks = OpeningContext { robot, options: &options }.blocks(path, MEASURED)?;
    let mut table = FileTable::open(path, blocks, &ColumnMap::default())?;
    let (cells, largest) = first_rows(&mut table)?;
    let sample = TableSample::new(&table.header, cells, largest);
    let fields = sample.fields(robot, chosen)?;
    let way = chosen.iter().rfind(|it| it.0 == "pose").map(|it| it.1.as_str());
    Ok(sample.guess(fields, way, path))
}

/// The first cells of each column, and its largest number; NaN if it has none.
fn first_rows(table: &mut FileTable<'_>) -> Result<(Vec<Vec<String>>, Vec<f64>)> {
    let count = table.header.cells.len();
    let (mut shown, mut largest) = (vec![Vec::new(); count], vec![f64::NAN; count]);
    let mut numbers = NumberReader::new(None);
    let mut read = 0;
    while read < ROWS
        && let Some(mut rows) = table.next_block()?
    {
        // The reader of the rows reports a broken row.
        while read < ROWS
            && let Ok(Some(row)) = rows.next()
        {
            read += 1;
            for ((cell, shown), largest) in row.cells.iter().zip(&mut shown).zip(&mut largest) {
                let text = cell.text();
                if let Ok(value) = numbers.parse(&text, row.line) {
                    *largest = largest.max(value.abs());
                }
                if shown.len() < SHOWN {
                    shown.push(text.into_owned());
                }
            }
        }
    }
    Ok((shown, largest))
}

impl<'h> TableSample<'h> {
    fn new(header: &'h Header<'h>, cells: Vec<Vec<String>>, largest: Vec<f64>) -> Self {
        let name = |(at, cell): (usize, &crate::table::header_cells::HeaderCell)| {
            let is_own = !cell.text.is_empty() && header.second_index(&cell.text).is_none();
            if is_own { cell.text.clone() } else { numbered_column(at + 1) }
        };
        let names = header.cells.iter().enumerate().map(name);
        let columns = names.zip(cells).map(|(name, cells)| FoundColumn { name, cells }).collect();
        let numeric = largest.iter().map(|it| !it.is_nan()).collect();
        TableSample { header, names: HeaderNames::new(header, numeric), columns, largest }
    }

    fn name(&self, column: usize) -> Option<String> {
        self.columns.get(column).map(|it| it.name.clone())
    }

    fn index(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|it| it.name == name)
    }

    /// The guessed fields, with the choices of a person in their place.
    fn fields(&self, robot: &Robot, chosen: &[(String, String)]) -> Result<Vec<MappedField>> {
        let names = robot.joint_reading_names();
        let columns = self.names.joints(robot, &names);
        let unit = |name: &String| match robot.reading_kind(name) {
            ReadingKind::Length => "unit.length",
            ReadingKind::Angle | ReadingKind::Factor => "unit.angle",
        };
        let joint = |(name, column): (&String, Option<usize>)| {
            MappedField::column("joints", name, name, column.and_then(|it| self.name(it))).of_number(unit(name))
        };
        let mut fields: Vec<MappedField> = names.iter().zip(columns).map(joint).collect();
        for (key, label) in [("unit.angle", "unit of the angles"), ("unit.length", "unit of the slides")] {
            if names.iter().any(|name| unit(name) == key) {
                fields.push(MappedField::unit("joints", key, label));
            }
        }
        let (near, place) = self.names.position().unzip();
        for (at, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let column = place.as_ref().and_then(|it| self.name(*it.get(at)?));
            fields.push(MappedField::column("position", axis, axis, column).of_number("unit.position"));
        }
        fields.push(MappedField::unit("position", "unit.position", "unit"));
        fields.extend(self.orientation(near.as_deref(), chosen)?);
        for (key, label) in [("target", "name of the target"), ("id", "name of the row")] {
            let column = self.names.find_exact(key).and_then(|it| self.name(it));
            fields.push(MappedField::column("rows", key, label, column));
        }
        let (units, others): (Vec<_>, Vec<_>) = chosen.iter().partition(|it| it.0.starts_with("unit."));
        for (key, value) in others.into_iter().filter(|it| it.0 != "orientation") {
            self.choose(&mut fields, key, value)?;
        }
        self.guess_units(&mut fields);
        for (key, value) in units {
            choose_unit(&mut fields, key, value)?;
        }
        Ok(fields)
    }

    /// The fields of the orientation, beside a position whose columns begin with `near`.
    fn orientation(&self, near: Option<&str>, chosen: &[(String, String)]) -> Result<Vec<MappedField>> {
        let mut found = self.names.orientation(near).map(|(form, columns)| {
            // Nobody writes a rotation vector in degrees.
            let is_large = self.largest_of(&columns) > MOST_RADIANS;
            let is_turned = is_large && form == OrientationForm::ROTATION_VECTOR;
            let form = if is_turned { OrientationForm::Angles(Angles::XYZ) } else { form };
            (form, columns.into_iter().map(Some).collect())
        });
        for (_, word) in chosen.iter().filter(|it| it.0 == "orientation") {
            let form: Option<OrientationForm> =
                if word.is_empty() { None } else { Some(word.parse().map_err(choice_error)?) };
            found = form.map(|form| match found {
                // Angles in another order are in the same columns.
                Some((known, parts)) if known.len() == 3 && form.len() == 3 => (form, parts),
                _ => (form, self.names.parts(form, near)),
            });
        }
        let mut fields = vec![MappedField::form(found.as_ref().map(|it| it.0))];
        let Some((form, parts)) = found else { return Ok(fields) };
        let are_angles = form.quantity() == Unit::Radian;
        let unit = if are_angles { "unit.orientation" } else { "" };
        for (at, (name, column)) in (1..).zip(form.part_names().iter().zip(parts)) {
            let (key, column) = (format!("orientation.{at}"), column.and_then(|it| self.name(it)));
            fields.push(MappedField::column("orientation", &key, name, column).of_number(unit));
        }
        if are_angles {
            fields.push(MappedField::unit("orientation", unit, "unit"));
        }
        fields.push(MappedField::way());
        Ok(fields)
    }

    /// The largest number in some columns.
    fn largest_of(&self, columns: &[usize]) -> f64 {
        columns.iter().filter_map(|it| self.largest.get(*it)).fold(0.0, |most: f64, it| most.max(*it))
    }

    /// Units of columns that state none.
    fn guess_units(&self, fields: &mut [MappedField]) {
        for unit in UNITS {
            let own = fields.iter().filter(|it| it.unit == unit.key).filter_map(|it| self.index(it.chosen_column()?));
            let chosen = self.guess_unit(&own.collect::<Vec<_>>(), &unit);
            let field = fields.iter_mut().find(|it| it.key == unit.key);
            field.into_iter().for_each(|it| it.chosen = chosen.map_or("", NamedUnit::symbol).to_owned());
        }
    }

    /// The unit of some columns: that in the name of the first one, else by the size of the numbers. None if all state theirs.
    fn guess_unit(&self, columns: &[usize], UnitField { of, most, usual, .. }: &UnitField) -> Option<NamedUnit> {
        let mut cells = columns.iter().filter_map(|it| self.header.cells.get(*it));
        if cells.all(|cell| cell.units().next().is_some()) {
            return None;
        }
        let named = columns.first().and_then(|it| self.names.unit(*it)).filter(|it| it.si_unit() == *of);
        let symbol = usual[usize::from(self.largest_of(columns) > *most)];
        named.or_else(|| NamedUnit::parse(symbol, *of).ok())
    }

    /// Columns with a name of our form that would be read without being chosen.
    fn left_out(&self, fields: &[MappedField]) -> Vec<String> {
        let is_chosen = |key: &str| {
            let is_it = |it: &&MappedField| it.group != "joints" && it.key == key;
            fields.iter().find(is_it).is_some_and(|it| !it.chosen.is_empty())
        };
        let mut names: Vec<&str> = Vec::new();
        if !is_chosen("orientation") {
            names.extend(OrientationForm::BY_NAME.iter().flat_map(|it| it.part_names()));
        }
        names.extend(["target", "id"].into_iter().filter(|it| !is_chosen(it)));
        let columns = names.into_iter().filter_map(|it| self.name(self.names.find_exact(it)?));
        columns.filter(|it| !fields.iter().any(|field| field.chosen_column() == Some(it))).collect()
    }

    fn guess(self, fields: Vec<MappedField>, way: Option<&str>, path: &Path) -> ColumnGuess {
        let is_missing = |it: &&MappedField| it.required && it.chosen.is_empty();
        let missing = fields.iter().filter(is_missing).map(|it| it.label.clone()).collect();
        let names = self.columns.iter().map(|it| &it.name);
        let is_ignored = |name: &&String| !fields.iter().any(|it| it.chosen_column() == Some(*name));
        let ignored = names.filter(is_ignored).cloned().collect();
        let file = path.file_name().map_or_else(String::new, |it| it.to_string_lossy().into_owned());
        let mapping = text::mapping(&fields, way, &self.left_out(&fields), &file);
        ColumnGuess { mapping, columns: self.columns, fields, ignored, missing }
    }
}
