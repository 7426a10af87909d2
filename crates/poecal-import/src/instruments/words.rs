//! Lines and cells of texts in other forms.

use std::collections::BTreeMap;

use super::made_table::{FileLine, Refusal};
use crate::join::join_words::number_lines;
use crate::table::cells::{Separator, split};
use crate::table::header_cells::split_brackets;
use poecal_numerics::error::first_few;

pub(crate) use crate::table::number::number_of as number;

/// Lines with text, with their numbers from 1.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty())
}

/// Cells of a line, without quotes; empty ones at the end are left out. A line with a broken quote is one cell.
pub(crate) fn cells(line: &str, separator: Separator) -> Vec<&str> {
    let mut found = Vec::new();
    if split(line, separator, &mut found).is_err() {
        return vec![line.trim()];
    }
    let filled = found.iter().rposition(|it| !it.raw.is_empty()).map_or(0, |it| it + 1);
    found.into_iter().take(filled).map(|it| it.raw).collect()
}

/// The name of a column and its unit, which is in one of these pairs of brackets.
pub(crate) fn name_and_unit<'c>(cell: &'c str, brackets: &[[char; 2]]) -> (&'c str, Option<&'c str>) {
    let found = brackets.iter().find_map(|[open, close]| split_brackets(cell, *open, *close));
    found.map_or((cell.trim(), None), |(name, unit)| (name.trim(), Some(unit.trim())))
}

/// A line that names columns.
pub(crate) struct HeadLine<'t> {
    pub(crate) line: usize,
    pub(crate) by: Separator,
    pub(crate) names: Vec<&'t str>,
}

impl<'t> HeadLine<'t> {
    /// A line with the names in it.
    pub(crate) fn from_line((line, text): (usize, &'t str), by: Separator) -> Self {
        HeadLine { line, by, names: cells(text, by) }
    }

    /// The line with its names, by the separator that is recognised.
    pub(crate) fn recognise(line: (usize, &'t str)) -> Self {
        HeadLine::from_line(line, Separator::recognise(line.1))
    }

    /// The column of a name.
    pub(crate) fn column_of(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|it| *it == name)
    }

    /// True if all these are names of columns.
    pub(crate) fn has(&self, names: &[&str]) -> bool {
        names.iter().all(|it| self.names.contains(it))
    }

    /// The lines below with their cells.
    pub(crate) fn rows(&self, text: &'t str) -> impl Iterator<Item = (usize, Vec<&'t str>)> {
        let below = lines(text).filter(|it| it.0 > self.line);
        below.map(|(line, content)| (line, cells(content, self.by)))
    }

    /// Refuses a line with more cells than the header.
    pub(crate) fn refuse_longer(&self, line: usize, found: &[&str], header: &str) -> Result<(), Refusal> {
        match (found.len(), self.names.len()) {
            (found, expected) if found > expected => {
                FileLine(line).refuse(format!("found {found} cells, expected {expected} as in {header}"))
            }
            _ => Ok(()),
        }
    }
}

/// Names in backticks, the first few.
pub(crate) fn quote_names<T: std::fmt::Display>(names: impl IntoIterator<Item = T>) -> String {
    first_few(&names.into_iter().map(|it| format!("`{it}`")).collect::<Vec<_>>())
}

/// True if names are those of targets: each recurs.
pub(crate) fn are_targets(names: &[String]) -> bool {
    names.len() >= 2 * by_name(names).len()
}

/// The warning of names that recur and are not those of targets; `lines` are those of the names.
pub(crate) fn repeats(names: &[String], lines: &[usize]) -> Option<String> {
    let again: Vec<String> = by_name(names)
        .into_iter()
        .filter(|(_, rows)| rows.len() > 1)
        .map(|(name, rows)| {
            let own: Vec<String> = rows.iter().filter_map(|at| lines.get(*at)).map(usize::to_string).collect();
            format!("`{name}` in {}", number_lines(&own))
        })
        .collect();
    (!again.is_empty()).then(|| format!("names come again: {}", first_few(&again)))
}

/// The rows of each name.
fn by_name(names: &[String]) -> BTreeMap<&str, Vec<usize>> {
    let mut found: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (at, name) in names.iter().enumerate() {
        found.entry(name).or_default().push(at);
    }
    found
}

/// True if a cell has a word that means no number, such as `NaN`.
pub(crate) fn is_no_number(text: &str) -> bool {
    ["nan", "-nan", "inf", "-inf", "+inf", "null", "none", "n/a"].contains(&text.trim().to_ascii_lowercase().as_str())
}
