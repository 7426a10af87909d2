//! Names that all rows have or none: targets and instruments.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::table::FileRow;
use poecal_numerics::error::Result;

/// The names so far. `first` states for each kind of name whether the first row has one, and its position.
#[derive(Default)]
pub(crate) struct RowNames {
    first: BTreeMap<&'static str, (bool, PathBuf, usize)>,
    indices: BTreeMap<String, usize>,
    /// The last name with its index, since most rows have that of the row before.
    last: Option<(&'static str, Option<String>, usize)>,
}

impl RowNames {
    /// Index of a row's name; a new name gets the next one. `what` is the kind of name.
    pub(crate) fn index(
        &mut self,
        row: &FileRow<'_>,
        column: Option<usize>,
        what: &'static str,
        name: Option<&str>,
    ) -> Result<usize> {
        if let Some((last_what, last, index)) = &self.last
            && *last_what == what
            && last.as_deref() == name
        {
            return Ok(*index);
        }
        self.check(row, column, what, name)?;
        let (key, next) = (name.unwrap_or_default(), self.indices.len());
        let index = self.indices.get(key).copied().unwrap_or_else(|| {
            self.indices.insert(key.to_owned(), next);
            next
        });
        self.last = Some((what, name.map(str::to_owned), index));
        Ok(index)
    }

    /// Refuses a row with a name if the first row has none, or the reverse.
    fn check(
        &mut self,
        row: &FileRow<'_>,
        column: Option<usize>,
        what: &'static str,
        name: Option<&str>,
    ) -> Result<()> {
        let (named, path, line) =
            self.first.entry(what).or_insert_with(|| (name.is_some(), row.path.to_path_buf(), row.line));
        if *named == name.is_some() {
            return Ok(());
        }
        let (found, expected) = match name {
            Some(name) => (format!("the {what} `{name}`"), "no name"),
            None => (format!("no {what} name"), "one"),
        };
        let message = format!(
            "found {found}, expected {expected} as in {}:{line}; all rows name their {what} or none does",
            path.display()
        );
        Err(row.error(column.unwrap_or(0), message))
    }
}
