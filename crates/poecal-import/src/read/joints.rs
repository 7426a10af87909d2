//! Tables with joint readings only, for predictions.

use std::path::Path;

use crate::ReadOptions;
use crate::instruments::OpeningContext;
use crate::pictures::append_row::set_of;
use crate::table::FileTable;
use crate::table::configurations::in_its_file;
use crate::table::cursor::Cursor;
use crate::table::layout::{ColumnLayout, SetRule};
use crate::table::mapping::ColumnMap;
use poecal_model::measurement::Set;
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;
use poecal_numerics::text::escape_invisible;
use poecal_plan::plan::{PlannedRow, RowPurpose};
use poecal_storage::document;

/// Configurations from a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointsTable {
    /// Readings of all rows, in the order of [`Robot::reading_names`] (radians, metres).
    pub readings: Vec<f64>,
    /// Number of rows.
    pub rows: usize,
    /// The rows' `id`, empty if there is no such column.
    pub ids: Vec<String>,
    /// The rows' `set`, empty if there is no such column.
    pub sets: Vec<Option<Set>>,
    /// The rows' line numbers, from 1.
    pub lines: Vec<usize>,
    /// The rows' times, seconds; empty if there is no such column.
    pub times: Vec<f64>,
    /// Warnings, a sentence each.
    pub warnings: Vec<String>,
}

impl JointsTable {
    /// The rows as those of a planned list; a row that states no set is a training row.
    #[must_use]
    pub fn planned_rows(&self) -> Vec<PlannedRow> {
        let part = |row: usize| match self.sets.get(row) {
            Some(Some(Set::HeldOut)) => RowPurpose::Judge,
            _ => RowPurpose::Fit,
        };
        let parts: Vec<RowPurpose> = (0..self.rows).map(part).collect();
        PlannedRow::of_list(&self.readings, self.readings.len() / self.rows.max(1), &parts)
    }
}

/// Reads the joint columns of a file, and `id` if there is one; other columns are ignored.
///
/// # Errors
/// Those of [`crate::read`] that concern joints.
pub fn read_joints(path: impl AsRef<Path>, robot: &Robot, options: &ReadOptions) -> Result<JointsTable> {
    let path = path.as_ref();
    let no_map = ColumnMap::default();
    let map = options.mapping.as_ref().unwrap_or(&no_map);
    let rows = |blocks| {
        let mut table = FileTable::open(path, blocks, map)?;
        let layout = ColumnLayout::joints(&table.header, robot, options, map)?;
        rows_of(&mut table, &mut Cursor::new(layout, robot, map.decimal))
    };
    let joints = document::reading(|| {
        let blocks = OpeningContext { robot, options }.joint_blocks(path, "a file of joint readings (CSV)")?;
        rows(blocks).map_err(|error| in_its_file(error, path))
    })?;
    let warnings = joints.warnings.iter().map(|warning| escape_invisible(warning).into_owned()).collect();
    Ok(JointsTable { warnings, ..joints })
}

/// Reads the text of such a file; `path` is its name in messages.
///
/// # Errors
/// Those of [`crate::read`] that concern joints.
pub fn parse_joints(text: &str, path: impl AsRef<Path>, robot: &Robot, options: &ReadOptions) -> Result<JointsTable> {
    let path = path.as_ref();
    document::reading_text(path, text, || read_joints(path, robot, options))
}

/// All rows of a table of joint readings.
pub(crate) fn rows_of(table: &mut FileTable<'_>, cursor: &mut Cursor<'_>) -> Result<JointsTable> {
    let mut joints = JointsTable::default();
    joints.rows = table.some_rows("at least one row of joint readings", |row| {
        joints.readings.extend_from_slice(cursor.read_joints(row)?);
        joints.lines.push(row.line);
        let layout = &cursor.layout;
        if layout.time.is_some() {
            joints.times.push(cursor.time_s(row));
        }
        if let SetRule::Words(index) = layout.set {
            joints.sets.push(set_of(row, index)?);
        }
        if let Some(cell) = layout.id.and_then(|id| row.cells.get(id)) {
            joints.ids.push(cell.text().into_owned());
        }
        Ok(())
    })?;
    joints.warnings = cursor.joint_warnings(&table.header)?;
    let own = |words: String| format!("{}: {words}", table.header.path.display());
    joints.warnings.extend(cursor.layout.joint_words().into_iter().map(own));
    Ok(joints)
}
