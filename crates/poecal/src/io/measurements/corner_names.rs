//! Which board and which of its points a row of corners means.

use super::pixels::text;
use super::read::Reader;
use super::table::Row;
use crate::camera::Board;
use crate::error::{Result, first_few};

/// The point of a board that a name means: its own, or with the board's name before it, as `tag12.0` of the board `tag12`.
fn point_of(board: &Board, name: &str) -> Option<usize> {
    let own = || name.strip_prefix(board.name.as_str())?.strip_prefix('.');
    board.find(name).or_else(|| board.find(own()?))
}

/// The board that stands before a point in its name, if the point alone is one of these.
fn board_before<'a>(board: &Board, name: &'a str) -> Option<&'a str> {
    let (before, point) = name.rsplit_once('.')?;
    (board.find(name).is_none() && board.find(point).is_some()).then_some(before)
}

impl Reader<'_> {
    /// Index of the row's board, by the columns of its name and of the corner's.
    pub(super) fn board(&mut self, row: &Row<'_>, (column, target): (Option<usize>, usize)) -> Result<usize> {
        let only = self.options.boards.first().filter(|_| self.options.boards.len() == 1);
        let corner = text(row, Some(target)).unwrap_or_default();
        let name = text(row, column)
            .filter(|name| !name.is_empty())
            .or_else(|| Some(board_before(only?, &corner)?.to_owned()));
        let Some(name) = name else { return Ok(0) };
        if let Some(at) = self.boards.iter().position(|it| it.name == name) {
            return Ok(at);
        }
        // One board that is at several places, by its names there.
        if let Some(again) = only {
            self.boards.push(Board { name, ..again.clone() });
            return Ok(self.boards.len() - 1);
        }
        let names: Vec<&str> = self.boards.iter().map(|it| it.name.as_str()).collect();
        let message = format!("found the board `{name}`, expected one of {}", first_few(&names));
        Err(row.error(column.unwrap_or(target), message))
    }

    /// Index of the row's corner on its board.
    pub(super) fn point(&self, row: &Row<'_>, column: usize, board: usize) -> Result<u32> {
        let name = text(row, Some(column)).unwrap_or_default();
        let Some(own) = self.boards.get(board) else { return Ok(0) };
        let Some(at) = point_of(own, &name) else {
            let message = format!(
                "found the corner `{name}`, expected one of the board's {}: {}",
                own.names.len(),
                first_few(&own.names)
            );
            return Err(row.error(column, message));
        };
        Ok(u32::try_from(at).unwrap_or(u32::MAX))
    }
}
