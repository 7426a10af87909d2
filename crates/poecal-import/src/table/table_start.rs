//! The line in which a table begins, and the separator that a line states.

use std::path::Path;

use super::cells::{Separator, split};
use super::header_cells::is_number;
use super::mapping::ColumnMap;
use super::text::LineBlocks;
use poecal_numerics::error::{ErrorKind, Result};

/// Largest number of lines in which the header is sought.
const LINES_ABOVE: usize = 40;

/// Number of lines above the header of a table that begins with other lines, which are no table. The header is the first line that names columns
/// and has rows of numbers below it, or below a line of units.
pub(super) fn lines_above(blocks: &LineBlocks<'_>, map: &ColumnMap) -> usize {
    let some: Vec<(usize, &str)> = blocks.lines(0).take(LINES_ABOVE).collect();
    let separator = |text: &str| map.separator.unwrap_or_else(|| Separator::recognise(text));
    // Numbers of cells with a text and with a number, without empty ones.
    let counts = |text: &str, by: Separator| {
        let mut cells = Vec::new();
        if split(text, by, &mut cells).is_err() {
            return (0, 0);
        }
        let numbers = cells.iter().filter(|cell| is_number(cell.raw)).count();
        (cells.iter().filter(|cell| !cell.raw.is_empty()).count() - numbers, numbers)
    };
    let is_header = |at: usize| {
        let Some((_, text)) = some.get(at) else { return false };
        let by = separator(text);
        let (names, numbers) = counts(text, by);
        let is_row = |row: usize| some.get(row).is_some_and(|it| 2 * counts(it.1, by).1 >= names);
        let is_units = |row: usize| some.get(row).is_some_and(|it| counts(it.1, by).1 == 0);
        let first = if is_units(at + 1) { at + 2 } else { at + 1 };
        let is_second = some.get(first + 1).is_none() || is_row(first + 1);
        names >= 3 && numbers == 0 && is_row(first) && is_second
    };
    let is_stated = some.first().is_some_and(|it| it.1.trim_start_matches('"').to_lowercase().starts_with("sep="));
    if is_stated || is_header(0) {
        return 0;
    }
    // Lines with equally many cells belong to one table.
    let width = |at: usize| some.get(at).map(|it| counts(it.1, separator(it.1))).map_or(0, |it| it.0 + it.1);
    (1..some.len())
        .find(|at| is_header(*at) && width(*at) != width(0))
        .and_then(|at| some.get(at))
        .map_or(0, |it| it.0 - 1)
}

/// The first line after line `skip` that is neither blank nor a comment.
pub(super) fn next_line(blocks: &mut LineBlocks<'_>, skip: usize) -> Result<Option<(usize, String)>> {
    loop {
        if let Some((line, text)) = blocks.lines(skip).next() {
            return Ok(Some((line, text.to_owned())));
        }
        if !blocks.advance()? {
            return Ok(None);
        }
    }
}

/// The separator stated by a line `sep=;`, as written by spreadsheets.
pub(super) fn stated_separator(path: &Path, line: usize, text: &str) -> Result<Option<Separator>> {
    let text = text.strip_prefix('"').and_then(|text| text.trim_end().strip_suffix('"')).unwrap_or(text);
    let Some(stated) = text.get(..4).filter(|start| start.eq_ignore_ascii_case("sep=")) else {
        return Ok(None);
    };
    let stated = text.get(stated.len()..).unwrap_or_default();
    let mut characters = stated.chars();
    let separator = characters.next().and_then(Separator::from_char);
    match separator {
        Some(separator) if characters.all(|c| separator.matches(c) || c == ' ') => Ok(Some(separator)),
        _ => Err(ErrorKind::Syntax
            .error(format!("found the separator `{stated}`, expected `,`, `;`, a tab or a blank"))
            .at_position(path, line, 1)),
    }
}
