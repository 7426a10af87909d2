//! The board and the point of a row of corners, by its names.

use nalgebra::Vector3;

use super::board_words::BOARD;
use super::boards::{Coordinate, length_on_board};
use super::corner_columns::CornerColumns;
use super::gathering::{PictureGathering, not_a_point};
use crate::read::MeasurementReader;
use crate::table::FileRow;
use crate::table::number::NumberReader;
use poecal_model::camera::Board;
use poecal_numerics::error::{Error, Result, first_few};

/// Distance up to which two positions are one point of a board, metres.
const SAME_M: f64 = 1e-6;

/// The point of a board by its name, or with the board's name before it, as `tag12.0` of the board `tag12`.
fn point_of(board: &Board, name: &str) -> Option<usize> {
    let own = || name.strip_prefix(board.name.as_str())?.strip_prefix('.');
    board.find(name).or_else(|| board.find(own()?))
}

/// The board before a point in its name, if the point alone is one of these.
fn board_before<'a>(board: &Board, name: &'a str) -> Option<&'a str> {
    let (before, point) = name.rsplit_once('.')?;
    (board.find(name).is_none() && board.find(point).is_some()).then_some(before)
}

impl MeasurementReader<'_> {
    /// Index of the row's board, by the columns of its name and of the corner's.
    pub(crate) fn board(&mut self, row: &FileRow<'_>, columns: &CornerColumns) -> Result<usize> {
        let only = self.options.boards.first().filter(|_| self.options.boards.len() == 1);
        let stated = Some(row.word(columns.board)).filter(|name| !name.is_empty());
        let name = stated.or_else(|| Some(board_before(only?, &row.word(columns.name))?.to_owned()));
        // Boards from the rows themselves are named, or there is only one.
        let is_of_file = self.options.boards.is_empty() && columns.place.is_some();
        let Some(name) = name.or_else(|| is_of_file.then(|| BOARD.to_owned())) else { return Ok(0) };
        if let Some(at) = self.boards.iter().position(|it| it.name == name) {
            return Ok(at);
        }
        // One board with several poses, by its names there.
        let Some(again) = only.cloned().or_else(|| is_of_file.then(Board::default)) else {
            let names: Vec<&str> = self.boards.iter().map(|it| it.name.as_str()).collect();
            let message = format!("found the board `{name}`, expected one of {}", first_few(&names));
            return Err(row.error(columns.board.unwrap_or(columns.corner()), message));
        };
        self.boards.push(Board { name, ..again });
        Ok(self.boards.len() - 1)
    }

    /// Index of the row's corner on its board; its number if it is numbered.
    pub(crate) fn point(
        &mut self,
        row: &FileRow<'_>,
        columns: &CornerColumns,
        (board, gathering): (usize, &mut PictureGathering),
    ) -> Result<u32> {
        if let Some(place) = columns.place {
            return self.point_at(row, columns.name, (board, place));
        }
        let (name, column) = (row.word(columns.name), columns.corner());
        let Some(own) = self.boards.get(board) else { return Ok(0) };
        let place = row.place(column);
        if let Some(at) = point_of(own, &name) {
            gathering.named.entry(board).or_insert((name, place));
            return Ok(u32::try_from(at).unwrap_or(u32::MAX));
        }
        let has_numbers = gathering.numbers.contains_key(&board) || !own.point_numbers().is_empty();
        let is_number = name.bytes().all(|it| it.is_ascii_digit());
        match name.parse::<u32>() {
            Ok(number) if is_number && has_numbers => {
                gathering.numbers.entry(board).or_default().entry(number).or_insert(place);
                Ok(number)
            }
            _ => Err(row.error(column, not_a_point(&name, own).message())),
        }
    }

    /// Index of the point at the row's position on its board; a board from the file gets a new point if it has none there.
    fn point_at(
        &mut self,
        row: &FileRow<'_>,
        name: Option<usize>,
        (board, columns): (usize, [Coordinate; 3]),
    ) -> Result<u32> {
        let (mut numbers, mut place) = (NumberReader::new(self.map.decimal), Vector3::zeros());
        for (value, column) in place.iter_mut().zip(columns) {
            *value = length_on_board(row, column, &mut numbers, ("a place on the board", "X"))?;
        }
        let at = columns[0].0;
        let is_stated = !self.options.boards.is_empty();
        let Some(own) = self.boards.get_mut(board) else { return Ok(0) };
        // The position names a point without a name; this stays its name if a calibration bends the board.
        let [x, y, z] = [place.x, place.y, place.z].map(|it| (1e6 * it).round() / 1e3 + 0.0);
        let called = if name.is_some() { row.word(name) } else { format!("{x}/{y}/{z}") };
        let near = |at: &usize| own.points.get(*at).is_some_and(|it| (it - place).norm() <= SAME_M);
        let named = own.find(&called);
        let apart = |it: &&Vector3<f64>| name.is_some() && (*it - place).norm() > SAME_M;
        if let Some(point) = named.and_then(|at| own.points.get(at)).filter(apart) {
            let message = format!(
                "found the corner `{called}` at {}, expected {} as in the row before: a point of a board stays where it is",
                millimetres(&place),
                millimetres(point)
            );
            return Err(row.error(at, message));
        }
        let found = named.or_else(|| (0..own.points.len()).find(near));
        if found.is_none() && is_stated {
            return Err(far_from(row, at, &place, own));
        }
        let found = found.unwrap_or_else(|| {
            own.names.push(called);
            own.points.push(place);
            own.points.len() - 1
        });
        Ok(u32::try_from(found).unwrap_or(u32::MAX))
    }

    /// Boards that a file stated by the positions of its corners, in words.
    pub(crate) fn board_of_file(&self, columns: &CornerColumns, has_boards: bool) -> Option<String> {
        if has_boards || columns.place.is_none() {
            return None;
        }
        let size = |board: &Board| {
            let along = |axis: usize| {
                let all = board.points.iter().map(|point| point[axis]);
                all.clone().fold(f64::MIN, f64::max) - all.fold(f64::MAX, f64::min)
            };
            let [x, y, z] = [0, 1, 2].map(|axis| 1e3 * along(axis));
            format!("`{}` of {} points, {x:.1} x {y:.1} x {z:.1} mm", board.name, board.names.len())
        };
        let all: Vec<String> = self.boards.iter().map(size).collect();
        Some(format!("took the places of the corners for the board {}", first_few(&all)))
    }
}

fn millimetres(point: &Vector3<f64>) -> String {
    let [x, y, z] = [point.x, point.y, point.z].map(|it| (1e6 * it).round() / 1e3);
    format!("({x}, {y}, {z}) mm")
}

/// The error of a position at which a board has no point.
fn far_from(row: &FileRow<'_>, at: usize, place: &Vector3<f64>, board: &Board) -> Error {
    let distance = |index: &usize| board.points.get(*index).map_or(f64::MAX, |it| (it - place).norm());
    let nearest = (0..board.points.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
    let name = board.names.get(nearest).map_or("", String::as_str);
    let message = format!(
        "found a corner at {} on its board, where the board of --markers has no point (the nearest is `{name}` at {}), expected the same points in its \
         frame: leave --markers out to take the board from this file",
        millimetres(place),
        board.points.get(nearest).map(millimetres).unwrap_or_default()
    );
    row.error(at, message)
}
