//! Names that all rows have or none: targets and instruments.

use std::path::PathBuf;

use super::table::Row;
use crate::error::Result;

/// Whether the first row has a name, and its place.
#[derive(Default)]
pub(super) struct Naming {
    first: Option<(bool, PathBuf, usize)>,
}

impl Naming {
    /// Refuses a row that differs from the first in having a name. `what` is the named thing, with advice for rows without one.
    pub(super) fn check(
        &mut self,
        row: &Row<'_>,
        column: Option<usize>,
        (what, unnamed): (&str, &str),
        name: Option<&str>,
    ) -> Result<()> {
        let (named, path, line) =
            self.first.get_or_insert_with(|| (name.is_some(), row.path.to_path_buf(), row.line));
        if *named == name.is_some() {
            return Ok(());
        }
        let (found, expected) = match name {
            Some(name) => (format!("the {what} `{name}`"), "no name"),
            None => (format!("no {what} name"), "one"),
        };
        let message = format!(
            "found {found}, expected {expected} as in {}:{line}; all rows name their {what} or none does{unnamed}",
            path.display()
        );
        Err(row.error(column.unwrap_or(0), message))
    }
}
