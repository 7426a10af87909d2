//! Boards and solids whose points cameras see: from CSV, or in words.

use std::path::Path;

use nalgebra::Vector3;

use super::board_files::board_of_file;
use super::board_words::{BOARD, in_words};
use super::stored_pictures::stored_boards;
use crate::table::header::Header;
use crate::table::header_cells::unit_in_name;
use crate::table::mapping::ColumnMap;
use crate::table::number::NumberReader;
use crate::table::text::LineBlocks;
use crate::table::{FileRow, FileTable};
use poecal_model::camera::Board;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;

/// The boards of a file of points, or of a specification such as `chessboard:10x7:27mm` (squares along x and y, and their side). Other
/// specifications are `charuco:…`, `circles:…`, `aprilgrid:…` and `tags:…`, in the words of `poecal detect`. Files of Kalibr,
/// industrial_calibration and OpenCV's settings (YAML, XML) are accepted too, and a `calibration.json` with its calibrated boards.
///
/// # Errors
/// A file cannot be read or has no points, or a specification is not valid.
pub fn read_boards(typed: &str) -> Result<Vec<Board>> {
    let of_file = board_of_file(typed)?;
    match in_words(of_file.as_ref().map_or(typed, |it| &it.words)) {
        Some(board) => Ok(vec![match of_file {
            Some(_) => board.map_err(|error| error.in_file(Path::new(typed)))?,
            None => board?,
        }]),
        None if Path::new(typed).extension().is_some_and(|it| it.eq_ignore_ascii_case("json")) => {
            stored_boards(Path::new(typed))
        }
        None => of_table(Path::new(typed)),
    }
}

/// A column of a coordinate on a board, with its unit.
pub(crate) type Coordinate = (usize, NamedUnit);

/// A column of a coordinate, with its unit: `x[mm]`, `x_mm`.
fn coordinate(header: &Header<'_>, name: &str) -> Result<Coordinate> {
    if let Some(at) = header.find(name)? {
        let unit = header.unit(at, Unit::Metre, "for a point")?;
        return Ok((at, unit.map_or(Unit::Metre.into(), |(unit, _)| unit)));
    }
    let mut cells = header.cells.iter().enumerate();
    let found = cells.find_map(|(at, cell)| Some((at, unit_in_name(&cell.name, name)?)));
    match found.filter(|(_, unit)| unit.si_unit() == Unit::Metre) {
        Some(found) => Ok(found),
        None => Ok((header.require(name, "for a point of the board", |_| false, "")?, Unit::Metre.into())),
    }
}

fn of_table(path: &Path) -> Result<Vec<Board>> {
    let map = ColumnMap::default();
    let mut table = FileTable::open(path, LineBlocks::open(path, "points of a board (CSV)")?, &map)?;
    let header = &table.header;
    let name = ["target", "marker", "corner", "name"].iter().find(|name| header.count(name) > 0);
    let Some(name) = name else {
        let message = "found no column `target`, expected one with the names of the points";
        return Err(ErrorKind::Measurement.error(message).at_line(path, header.line));
    };
    let (name_at, of_board) = (header.find(name)?.unwrap_or(0), header.find("board")?);
    let columns = [coordinate(header, "x")?, coordinate(header, "y")?, coordinate(header, "z")?];
    let mut numbers = NumberReader::new(None);
    let mut boards: Vec<Board> = Vec::new();
    table.some_rows("the points of a board", |row| {
        let mut point = Vector3::zeros();
        for ((value, column), axis) in point.iter_mut().zip(columns).zip(["x", "y", "z"]) {
            *value = length_on_board(row, column, &mut numbers, (&format!("`{axis}`"), axis))?;
        }
        let own = Some(row.word(of_board)).filter(|it| !it.is_empty()).unwrap_or_else(|| BOARD.to_owned());
        let at = boards.iter().position(|it| it.name == own).unwrap_or_else(|| {
            boards.push(Board { name: own, ..Board::default() });
            boards.len() - 1
        });
        let Some(board) = boards.get_mut(at) else { return Ok(()) };
        // Points that only have numbers are named by their column too.
        let word = row.word(Some(name_at));
        let is_number = word.bytes().all(|it| it.is_ascii_digit());
        let point_name = if is_number { format!("{name}{word}") } else { word };
        if board.find(&point_name).is_some() {
            let message = format!("found the point `{point_name}` a second time, expected it once");
            return Err(row.error(name_at, message));
        }
        board.names.push(point_name);
        board.points.push(point);
        Ok(())
    })?;
    Ok(boards)
}

/// Largest coordinate of a point of a board, metres.
pub(crate) const FARTHEST_M: f64 = 10.0;

/// A coordinate of a point of a board in a cell, metres. In errors, `of` is the owner of the point, and `axis` the name of its column.
pub(crate) fn length_on_board(
    row: &FileRow<'_>,
    (at, unit): Coordinate,
    numbers: &mut NumberReader,
    (of, axis): (&str, &str),
) -> Result<f64> {
    let value = unit.to_si(row.number(at, numbers, format_args!(" for {of}"))?);
    if value.abs() > FARTHEST_M {
        let raw = row.raw_text(at);
        let message = format!(
            "found `{raw}` for {of}, {value} m, expected a point of a board: state the unit of the column, as {axis}[mm]"
        );
        return Err(row.error(at, message));
    }
    Ok(value)
}
