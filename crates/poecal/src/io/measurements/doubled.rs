//! Rows that are in a file twice.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::Path;

use super::lost::named_lines;
use super::table::Row;

/// Most rows that are compared.
const MOST: usize = 100_000;

/// Rows of a file that are the same as another one, letter for letter.
#[derive(Debug, Default)]
pub(super) struct DoubledRows {
    /// The line of each row, by its hash.
    seen: HashMap<u64, usize>,
    lines: Vec<usize>,
}

impl DoubledRows {
    /// Adds a row.
    pub(super) fn observe(&mut self, row: &Row<'_>) {
        if self.seen.len() >= MOST {
            return;
        }
        let mut hasher = DefaultHasher::new();
        row.text.trim().hash(&mut hasher);
        if *self.seen.entry(hasher.finish()).or_insert(row.line) != row.line {
            self.lines.push(row.line);
        }
    }

    /// The warning of a file.
    pub(super) fn warning(&self, path: &Path) -> Option<String> {
        let count = self.lines.len();
        // Where many are, numbers have few digits.
        (count > 0 && 10 * count <= self.seen.len()).then(|| {
            let words = if count == 1 { "one row that is another one" } else { "rows that are others" };
            format!(
                "{}: found {words} again, letter for letter ({}): the same row twice is not more data",
                path.display(),
                named_lines(count, self.lines.get(..count.min(super::lost::NAMED_LINES)).unwrap_or_default())
            )
        })
    }
}
