//! Words in columns of a measurement file that are no measurements, such as the number of a cycle.

use std::collections::BTreeMap;
use std::path::Path;

use crate::ReadOptions;
use crate::instruments::OpeningContext;
use crate::table::FileTable;
use crate::table::mapping::ColumnMap;
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;
use poecal_storage::document;

/// Words of some columns.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LabelColumns {
    /// True for each of the columns that the file has.
    pub has: Vec<bool>,
    /// Words of each line, from 1; empty for a column that the file does not have.
    pub lines: BTreeMap<usize, Vec<String>>,
}

/// Reads columns of these names, without their units, from a file in our form.
///
/// # Errors
/// Those of [`crate::read()`] that concern the table.
pub fn read_labels(path: &Path, names: &[&str], robot: &Robot, options: &ReadOptions) -> Result<LabelColumns> {
    let no_map = ColumnMap::default();
    document::reading(|| {
        let blocks = OpeningContext { robot, options }.blocks(path, "a file of measurements (CSV)")?;
        let mut table = FileTable::open(path, blocks, options.mapping.as_ref().unwrap_or(&no_map))?;
        let at = |name: &&str| table.header.cells.iter().position(|it| it.name.eq_ignore_ascii_case(name));
        let columns: Vec<Option<usize>> = names.iter().map(at).collect();
        let mut labels = LabelColumns { has: columns.iter().map(Option::is_some).collect(), ..LabelColumns::default() };
        table.some_rows("at least one measurement", |row| {
            labels.lines.insert(row.line, columns.iter().map(|column| row.word(*column)).collect());
            Ok(())
        })?;
        Ok(labels)
    })
}
