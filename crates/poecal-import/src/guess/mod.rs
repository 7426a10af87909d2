//! Which columns of a file are the joints' readings and what was measured: a guess for a person to look over and correct, and the mapping file
//! that it makes.

mod draft;
mod fields;
mod names;
mod text;

use std::path::Path;

use serde::Serialize;

use self::draft::Draft;
use self::fields::fields;
pub use self::fields::{MappedChoice, MappedField};
use self::names::Names;
use super::ReadOptions;
use super::table::Table;
use crate::instruments::{MEASURED, Opened, Opening, WORKBOOK, headerless};
use crate::table::cells::Cell;
use crate::table::column_names::numbered_column;
use crate::table::header::Header;
use crate::table::mapping::{ColumnMap, PositionSpec};
use crate::table::number::Numbers;
use crate::table::orientation::OrientationForm;
use poecal_arm::lie::angles::Angles;
use poecal_model::robot::{ReadingKind, Robot};
use poecal_numerics::error::{ErrorKind, Result, nearest_or_all};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;

/// Rows that are looked at.
const ROWS: usize = 200;
/// Cells of a column that are shown.
const SHOWN: usize = 3;
/// Beyond this an angle is in degrees: joints turn once to either side.
const MOST_RADIANS: f64 = 7.0;
/// Beyond these a slide and a position are in millimetres.
const MOST_METRES: [f64; 2] = [10.0, 20.0];

/// Which columns of a file are taken for what, with all that can be chosen instead, and the mapping that says so.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ColumnGuess {
    /// The columns of the file, in their order.
    pub columns: Vec<FoundColumn>,
    /// What a mapping says, with what is chosen.
    pub fields: Vec<MappedField>,
    /// Columns that nothing is read from.
    pub ignored: Vec<String>,
    /// What has no column, and nothing can be read without.
    pub missing: Vec<String>,
    /// The mapping file (TOML).
    pub mapping: String,
}

/// A column of a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FoundColumn {
    /// What a mapping calls it.
    pub name: String,
    /// Its first cells.
    pub cells: Vec<String>,
}

/// A table's first rows.
struct Sample<'h> {
    header: &'h Header<'h>,
    names: Names<'h>,
    columns: Vec<FoundColumn>,
    /// The largest number of each column.
    largest: Vec<f64>,
}

/// Guesses which columns of a file are the joints' readings and what was measured. Each of `chosen` is what a field is called and the column
/// or word for it, empty for none.
///
/// # Errors
/// As [`super::read`] of a file that is no table; [`ErrorKind::Option`] of a form that is read without a mapping, and of a field or a column
/// that is not there.
pub fn guess_columns(
    path: impl AsRef<Path>,
    robot: &Robot,
    chosen: &[(String, String)],
) -> Result<ColumnGuess> {
    guess_at(path.as_ref(), robot, chosen)
}

/// Compiled once, and not for each kind of path.
fn guess_at(path: &Path, robot: &Robot, chosen: &[(String, String)]) -> Result<ColumnGuess> {
    let plain = ReadOptions::default();
    if let Opened::Made(made) = (Opening { robot, options: &plain }).opened(path, MEASURED)?
        && made.title != WORKBOOK
        && made.title != headerless::FORM.title
    {
        let message = format!(
            "found {}, which is read as it is, expected a table with columns of its own: leave the mapping out",
            made.title
        );
        return Err(ErrorKind::Option.error(message).in_file(path));
    }
    // As a mapping that names columns reads it.
    let position = Some(PositionSpec { columns: Some([1, 2, 3].map(numbered_column)), unit: None });
    let mapping = Some(ColumnMap { position, ..ColumnMap::default() });
    let options = ReadOptions { mapping, ..ReadOptions::default() };
    let blocks = Opening { robot, options: &options }.blocks(path, MEASURED)?;
    let mut table = Table::open(path, blocks, &ColumnMap::default())?;
    let (cells, largest) = first_rows(&mut table)?;
    let sample = Sample::new(&table.header, cells, largest);
    let draft = sample.draft(robot, chosen)?;
    Ok(sample.guess(&draft, path))
}

/// The first cells of each column, and its largest number; NaN where it has none.
fn first_rows(table: &mut Table<'_>) -> Result<(Vec<Vec<String>>, Vec<f64>)> {
    let count = table.header.cells.len();
    let (mut shown, mut largest) = (vec![Vec::new(); count], vec![f64::NAN; count]);
    let mut numbers = Numbers::new(None);
    let mut read = 0;
    while read < ROWS
        && let Some(mut rows) = table.next_block()?
    {
        // A broken row is told by who reads it.
        while read < ROWS
            && let Ok(Some(row)) = rows.next()
        {
            read += 1;
            for ((cell, shown), largest) in row.cells.iter().zip(&mut shown).zip(&mut largest) {
                take(*cell, row.line, (shown, largest), &mut numbers);
            }
        }
    }
    Ok((shown, largest))
}

fn take(cell: Cell<'_>, line: usize, (shown, largest): (&mut Vec<String>, &mut f64), numbers: &mut Numbers) {
    let text = cell.text();
    if let Ok(value) = numbers.parse(&text, line) {
        *largest = largest.max(value.abs());
    }
    if shown.len() < SHOWN {
        shown.push(text.into_owned());
    }
}

impl<'h> Sample<'h> {
    fn new(header: &'h Header<'h>, cells: Vec<Vec<String>>, largest: Vec<f64>) -> Self {
        let name = |(at, cell): (usize, &crate::table::header::HeaderCell)| {
            let is_own = !cell.text.is_empty() && header.second(&cell.text).is_none();
            if is_own { cell.text.clone() } else { numbered_column(at + 1) }
        };
        let names = header.cells.iter().enumerate().map(name);
        let columns = names.zip(cells).map(|(name, cells)| FoundColumn { name, cells }).collect();
        let numeric = largest.iter().map(|it| !it.is_nan()).collect();
        Sample { header, names: Names::new(header, numeric), columns, largest }
    }

    fn name(&self, column: usize) -> Option<String> {
        self.columns.get(column).map(|it| it.name.clone())
    }

    fn index(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|it| it.name == name)
    }

    /// What poecal guesses, with what was chosen in its place.
    fn draft(&self, robot: &Robot, chosen: &[(String, String)]) -> Result<Draft> {
        let names = robot.joint_reading_names();
        let columns = self.names.joints(robot, &names).into_iter().map(|it| self.name(it?));
        let quantity = |name: &String| match robot.reading_kind(name) {
            ReadingKind::Length => Unit::Metre,
            ReadingKind::Angle | ReadingKind::Factor => Unit::Radian,
        };
        let joints = names.iter().zip(columns).map(|(name, it)| (name.clone(), quantity(name), it)).collect();
        let mut draft = Draft { joints, ..Draft::default() };
        let position = self.names.position();
        let near = position.as_ref().map(|it| it.0.clone());
        for (place, column) in draft.position.iter_mut().zip(position.iter().flat_map(|it| &it.1)) {
            *place = self.name(*column);
        }
        if let Some((form, columns)) = self.names.orientation(near.as_deref()) {
            let is_large = self.largest_of(columns.iter().copied()) > MOST_RADIANS;
            // Nobody writes a rotation vector in degrees.
            let is_vector = form == Angles::RotationVector.to_string();
            draft.form = Some(if is_vector && is_large { Angles::XYZ.to_string() } else { form });
            draft.parts = columns.into_iter().map(|it| self.name(it)).collect();
        }
        draft.target = self.names.named("target").and_then(|it| self.name(it));
        draft.id = self.names.named("id").and_then(|it| self.name(it));
        let (units, others): (Vec<_>, Vec<_>) = chosen.iter().partition(|it| it.0.starts_with("unit."));
        for (key, value) in others {
            self.choose(&mut draft, key, value, near.as_deref())?;
        }
        self.guess_units(&mut draft);
        for (key, value) in units {
            choose_unit(&mut draft, key, value)?;
        }
        self.leave_out(&mut draft);
        Ok(draft)
    }

    /// The largest number in some columns.
    fn largest_of(&self, columns: impl Iterator<Item = usize>) -> f64 {
        columns.filter_map(|it| self.largest.get(it)).fold(0.0, |most: f64, it| most.max(*it))
    }

    /// Takes a column or a word in place of what was guessed.
    fn choose(&self, draft: &mut Draft, key: &str, value: &str, near: Option<&str>) -> Result<()> {
        if key == "orientation" {
            let form: Option<OrientationForm> =
                if value.is_empty() { None } else { Some(value.parse().map_err(refused)?) };
            let parts = form.map_or_else(Vec::new, |form| {
                // Angles in another order are in the same columns.
                let kept = draft.orientation().is_some_and(|it| it.len() == form.len() && form.len() == 3);
                if kept { draft.parts.clone() } else { self.named_parts(form, near) }
            });
            (draft.form, draft.parts) = (form.map(|_| value.to_owned()), parts);
            return Ok(());
        }
        if key == "pose" {
            draft.is_inverted = match value {
                "target_from_device" => true,
                "device_from_target" => false,
                _ => {
                    return ErrorKind::Option.refuse(format!(
                        "--column: found `{value}` for the way of the poses, expected device_from_target or target_from_device"
                    ));
                }
            };
            return Ok(());
        }
        let column = if value.is_empty() { None } else { Some(self.known(value, key)?) };
        let keys: Vec<String> = fields(draft).into_iter().map(|it| it.key).collect();
        let part = key.strip_prefix("orientation.").and_then(|it| it.parse::<usize>().ok()?.checked_sub(1));
        let axis = ["x", "y", "z"].iter().position(|it| *it == key);
        let place = if let Some(joint) = draft.joints.iter_mut().find(|it| it.0 == key) {
            Some(&mut joint.2)
        } else if let Some(axis) = axis {
            draft.position.get_mut(axis)
        } else if let Some(part) = part {
            draft.parts.get_mut(part)
        } else if key == "target" {
            Some(&mut draft.target)
        } else {
            Some(&mut draft.id).filter(|_| key == "id")
        };
        match place {
            Some(place) => *place = column,
            None => {
                let keys: Vec<&str> = keys.iter().map(String::as_str).collect();
                let hint = nearest_or_all(key, &keys);
                return ErrorKind::Option
                    .refuse(format!("--column: found `{key}`, expected what a column is for, {hint}"));
            }
        }
        Ok(())
    }

    /// A column of the file by its name, with or without its unit.
    fn known(&self, name: &str, key: &str) -> Result<String> {
        let known: Vec<&str> = self.columns.iter().map(|it| it.name.as_str()).collect();
        let found = self.index(name).or_else(|| self.names.named(name)).and_then(|it| self.name(it));
        found.ok_or_else(|| {
            ErrorKind::Option.error(format!(
                "--column: found no column `{name}` for `{key}`, expected one of the file, {}",
                nearest_or_all(name, &known)
            ))
        })
    }

    fn named_parts(&self, form: OrientationForm, near: Option<&str>) -> Vec<Option<String>> {
        self.names.parts(form, near).into_iter().map(|it| self.name(it?)).collect()
    }

    /// Units of columns that state none.
    fn guess_units(&self, draft: &mut Draft) {
        let index = |name: &String| self.index(name);
        let of_joints = |quantity: Unit| {
            let joints = draft.joints.iter().filter(move |it| it.1 == quantity);
            joints.filter_map(|it| it.2.as_ref()).filter_map(index).collect()
        };
        let position = draft.position.iter().flatten().filter_map(index).collect();
        let turns = draft.orientation().is_some_and(|it| it.quantity() == Unit::Radian);
        let parts = draft.parts.iter().flatten().filter(|_| turns).filter_map(index).collect();
        let units = [
            ("angle", self.guess_unit(of_joints(Unit::Radian), Unit::Radian, MOST_RADIANS)),
            ("length", self.guess_unit(of_joints(Unit::Metre), Unit::Metre, MOST_METRES[0])),
            ("position", self.guess_unit(position, Unit::Metre, MOST_METRES[1])),
            ("orientation", self.guess_unit(parts, Unit::Radian, MOST_RADIANS)),
        ];
        draft.units = units.into();
    }

    /// The unit of some columns, unless all state theirs: that in the first one's name, or by the size of the numbers.
    fn guess_unit(&self, columns: Vec<usize>, quantity: Unit, most: f64) -> Option<NamedUnit> {
        let is_stated =
            |column: &usize| self.header.cells.get(*column).is_some_and(|it| it.units().next().is_some());
        if columns.iter().all(is_stated) {
            return None;
        }
        let named = columns.first().and_then(|it| self.names.unit(*it)).filter(|it| it.of() == quantity);
        let is_large = self.largest_of(columns.into_iter()) > most;
        let symbol = match (quantity, is_large) {
            (Unit::Metre, true) => "mm",
            (Unit::Metre, false) => "m",
            (_, true) => "deg",
            (_, false) => "rad",
        };
        named.or_else(|| NamedUnit::parse(symbol, quantity).ok())
    }

    /// Columns with a name of ours that would be read without being chosen.
    fn leave_out(&self, draft: &mut Draft) {
        let own = ["qx", "qy", "qz", "qw", "rx", "ry", "rz", "roll", "pitch", "yaw"];
        let orientation = own.iter().filter(|_| draft.form.is_none());
        let names = orientation.chain(Some(&"target").filter(|_| draft.target.is_none()));
        let names = names.chain(Some(&"id").filter(|_| draft.id.is_none()));
        let columns = names.filter_map(|it| self.names.named(it)).filter_map(|it| self.name(it));
        let left_out: Vec<String> = columns.filter(|it| !draft.used().any(|used| used == it)).collect();
        draft.left_out = left_out;
    }

    fn guess(self, draft: &Draft, path: &Path) -> ColumnGuess {
        let fields = fields(draft);
        let is_missing = |it: &&MappedField| it.required && it.choices.is_empty() && it.chosen.is_empty();
        let missing = fields.iter().filter(is_missing).map(|it| it.label.clone()).collect();
        let names = self.columns.iter().map(|it| &it.name);
        let ignored = names.filter(|name| !draft.used().any(|used| used == *name)).cloned().collect();
        let file = path.file_name().map_or_else(String::new, |it| it.to_string_lossy().into_owned());
        ColumnGuess { mapping: text::mapping(draft, &file), columns: self.columns, fields, ignored, missing }
    }
}

fn choose_unit(draft: &mut Draft, key: &str, value: &str) -> Result<()> {
    let group = key.strip_prefix("unit.").unwrap_or(key);
    let quantity = if matches!(group, "length" | "position") { Unit::Metre } else { Unit::Radian };
    let unit =
        if value.is_empty() { None } else { Some(NamedUnit::parse(value, quantity).map_err(refused)?) };
    match draft.units.iter_mut().find(|it| *it.0 == group) {
        Some((_, place)) => *place = unit,
        None => {
            return ErrorKind::Option.refuse(format!(
                "--column: found `{key}`, expected unit.angle, unit.length, unit.position or unit.orientation"
            ));
        }
    }
    Ok(())
}

/// An error of a value that was chosen.
fn refused(error: poecal_numerics::error::Error) -> poecal_numerics::error::Error {
    ErrorKind::Option.error(format!("--column: {}", error.message()))
}
