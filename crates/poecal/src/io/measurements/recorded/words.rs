//! Lines and cells of texts in other forms.

use super::super::cells::{Separator, split};
use crate::error::first_few;

/// A finite number of a cell, with a decimal point or, where there is no other, a decimal comma.
pub(super) fn number(text: &str) -> Option<f64> {
    let text = text.trim();
    let is_plain = text.bytes().all(|it| it.is_ascii_digit() || b"+-.eE,".contains(&it));
    if !is_plain || text.is_empty() {
        return None;
    }
    let is_comma = text.contains(',') && !text.contains('.');
    let found = if is_comma { text.replacen(',', ".", 1).parse() } else { text.parse() };
    found.ok().filter(|it: &f64| it.is_finite())
}

/// Lines with text, with their numbers from 1.
pub(super) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty())
}

/// Cells of a line, without quotes; empty ones at the end are left out. A line with a broken quote is one cell.
pub(super) fn cells(line: &str, separator: Separator) -> Vec<&str> {
    let mut found = Vec::new();
    if split(line, separator, &mut found).is_err() {
        return vec![line.trim()];
    }
    let filled = found.iter().rposition(|it| !it.raw.is_empty()).map_or(0, |it| it + 1);
    found.into_iter().take(filled).map(|it| it.raw).collect()
}

/// Names in backticks, the first few.
pub(super) fn quoted<T: std::fmt::Display>(names: impl IntoIterator<Item = T>) -> String {
    first_few(&names.into_iter().map(|it| format!("`{it}`")).collect::<Vec<_>>())
}
