//! Specification of a board, in one line of text.

use std::fmt;
use std::str::FromStr;

use crate::dictionary::Dictionary;
use crate::error::{Error, Result};

/// A board: `chessboard:COLSxROWS:SQUARE`, `charuco:COLSxROWS:SQUARE:MARKER:DICT[:legacy]`, `circles:COLSxROWS:PITCH[:asymmetric]`,
/// `tags:FAMILY:SIZE` or `aprilgrid:COLSxROWS:SIZE:SPACING[:FAMILY]`. Columns and rows count squares, dots or tags; lengths have a unit (mm, cm, m,
/// in).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum BoardSpec {
    /// A plain chessboard.
    Chessboard(Chessboard),
    /// A chessboard with markers in its light squares.
    Charuco(Charuco),
    /// A grid of dark dots on light ground.
    Circles(Circles),
    /// Loose tags, each with its corners.
    Tags(Tags),
    /// A grid of tags with dark squares at their corners, as of Kalibr.
    AprilGrid(AprilGrid),
}

/// A plain chessboard.
#[derive(Clone, Debug, PartialEq)]
pub struct Chessboard {
    /// Squares along x.
    pub columns: usize,
    /// Squares along y.
    pub rows: usize,
    /// Side of a square, metres.
    pub square_m: f64,
}

/// A chessboard with ArUco markers in its light squares.
#[derive(Clone, Debug, PartialEq)]
pub struct Charuco {
    /// Squares along x.
    pub columns: usize,
    /// Squares along y.
    pub rows: usize,
    /// Side of a square, metres.
    pub square_m: f64,
    /// Side of a marker with its black border, metres.
    pub marker_m: f64,
    /// The markers.
    pub dictionary: Dictionary,
    /// The pattern of OpenCV before 4.6, which begins with a light square if the number of rows is even.
    pub legacy: bool,
}

/// A grid of dark dots, in the layouts of OpenCV's `findCirclesGrid`.
#[derive(Clone, Debug, PartialEq)]
pub struct Circles {
    /// Dots in a row.
    pub columns: usize,
    /// Rows of dots.
    pub rows: usize,
    /// Distance from row to row, metres. In a row the dots have this distance, or twice as much if the grid is asymmetric.
    pub pitch_m: f64,
    /// True if every second row is moved by a pitch: dot `j` of row `i` is at `(2 j + i % 2, i)` pitches.
    pub asymmetric: bool,
}

/// Loose tags of one family and size.
#[derive(Clone, Debug, PartialEq)]
pub struct Tags {
    /// The tags.
    pub dictionary: Dictionary,
    /// Side of a tag with its black border of one cell, metres.
    pub size_m: f64,
}

/// The grid of tags of Kalibr: tag 0 is at the lower left, with a border of two cells and dark squares in the corners between tags.
#[derive(Clone, Debug, PartialEq)]
pub struct AprilGrid {
    /// Tags in a row.
    pub columns: usize,
    /// Rows of tags.
    pub rows: usize,
    /// Side of a tag with its black border, metres.
    pub size_m: f64,
    /// Gap from tag to tag, as a part of the side of a tag.
    pub spacing: f64,
    /// The tags.
    pub dictionary: Dictionary,
}

/// Most squares along a side, as for `poecal`'s boards.
const MOST_SQUARES: usize = 250;
/// Forms of a specification.
const CHESSBOARD: &str = "chessboard:COLSxROWS:SQUARE, such as chessboard:10x7:28mm";
const CIRCLES: &str = "circles:COLSxROWS:PITCH, such as circles:9x6:30mm or circles:4x11:20mm:asymmetric";
const TAGS: &str = "tags:FAMILY:SIZE, such as tags:36h11:50mm";
const APRILGRID: &str = "aprilgrid:COLSxROWS:SIZE:SPACING, such as aprilgrid:6x6:88mm:0.3";
const CHARUCO: &str = "charuco:COLSxROWS:SQUARE:MARKER:DICT, such as charuco:5x7:36mm:18mm:DICT_6X6_250";

impl BoardSpec {
    /// Squares along x and y. For a grid of dots those that have its dots at their inner corners; for tags the extent of the drawn ones, in sides of
    /// a tag.
    #[must_use]
    pub fn squares(&self) -> [usize; 2] {
        match self {
            BoardSpec::Chessboard(board) => [board.columns, board.rows],
            BoardSpec::Charuco(board) => [board.columns, board.rows],
            BoardSpec::Circles(Circles { columns, rows, asymmetric, .. }) => {
                [columns * (1 + usize::from(*asymmetric)) + 1, rows + 1]
            }
            BoardSpec::Tags(_) => [10, 7],
            BoardSpec::AprilGrid(AprilGrid { columns, rows, spacing, .. }) => {
                [columns, rows].map(|it| (*it as f64 + it.saturating_sub(1) as f64 * spacing + 2.0).ceil() as usize)
            }
        }
    }

    /// Side of a square or a tag, or the pitch of dots, metres.
    #[must_use]
    pub fn square_m(&self) -> f64 {
        match self {
            BoardSpec::Chessboard(board) => board.square_m,
            BoardSpec::Charuco(board) => board.square_m,
            BoardSpec::Circles(board) => board.pitch_m,
            BoardSpec::Tags(board) => board.size_m,
            BoardSpec::AprilGrid(board) => board.size_m,
        }
    }

    /// Lengths that a ruler measures on a print along x and y, metres: all squares, or all tags of a grid, between their outer edges; dots between
    /// the middles of the outer ones; a single one of loose tags.
    #[must_use]
    pub fn ruled_m(&self) -> [f64; 2] {
        match self {
            BoardSpec::Chessboard(_) | BoardSpec::Charuco(_) => self.squares().map(|it| it as f64 * self.square_m()),
            BoardSpec::Circles(board) => self.squares().map(|it| it.saturating_sub(2) as f64 * board.pitch_m),
            BoardSpec::Tags(board) => [board.size_m; 2],
            BoardSpec::AprilGrid(AprilGrid { columns, rows, size_m, spacing, .. }) => {
                [columns, rows].map(|it| (*it as f64 + it.saturating_sub(1) as f64 * spacing) * size_m)
            }
        }
    }

    /// The board scaled by this factor, with squares and markers to a micrometre.
    pub(crate) fn scale(&self, factor: f64) -> Self {
        let scaled = |length_m: f64| (length_m * factor * 1e6).round() / 1e6;
        let mut board = self.clone();
        match &mut board {
            BoardSpec::Chessboard(board) => board.square_m = scaled(board.square_m),
            BoardSpec::Charuco(board) => {
                (board.square_m, board.marker_m) = (scaled(board.square_m), scaled(board.marker_m));
            }
            BoardSpec::Circles(board) => board.pitch_m = scaled(board.pitch_m),
            BoardSpec::Tags(board) => board.size_m = scaled(board.size_m),
            BoardSpec::AprilGrid(board) => board.size_m = scaled(board.size_m),
        }
        board
    }
}

impl FromStr for BoardSpec {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let parts: Vec<&str> = text.trim().split(':').collect();
        match parts.as_slice() {
            ["chessboard", size, square] => {
                let [columns, rows] = size_of("squares", size, 3)?;
                Ok(BoardSpec::Chessboard(Chessboard { columns, rows, square_m: length_m("side of a square", square)? }))
            }
            ["chessboard", ..] => Err(spec_error(text, CHESSBOARD)),
            ["circles", size, pitch] => circles(size, pitch, false),
            ["circles", size, pitch, "asymmetric"] => circles(size, pitch, true),
            ["circles", _, _, last] => {
                Err(Error::new(format!("found {last:?} at the end of a board, expected asymmetric or nothing")))
            }
            ["circles", ..] => Err(spec_error(text, CIRCLES)),
            ["tags", family, size] => {
                let dictionary = Dictionary::from_name(family)?;
                Ok(BoardSpec::Tags(Tags { dictionary, size_m: length_m("side of a tag", size)? }))
            }
            ["tags", ..] => Err(spec_error(text, TAGS)),
            ["aprilgrid", size, tag, spacing] => aprilgrid(size, tag, spacing, "DICT_APRILTAG_36h11"),
            ["aprilgrid", size, tag, spacing, family] => aprilgrid(size, tag, spacing, family),
            ["aprilgrid", ..] => Err(spec_error(text, APRILGRID)),
            ["charuco", size, square, marker, name] => charuco(size, [square, marker], name, false),
            ["charuco", size, square, marker, name, "legacy"] => charuco(size, [square, marker], name, true),
            ["charuco", _, _, _, _, last] => {
                Err(Error::new(format!("found {last:?} at the end of a board, expected legacy or nothing")))
            }
            ["charuco", ..] => Err(spec_error(text, CHARUCO)),
            _ => Err(spec_error(text, &format!("{CHESSBOARD}, {CHARUCO}, {CIRCLES}, {TAGS}, or {APRILGRID}"))),
        }
    }
}

fn spec_error(text: &str, expected: &str) -> Error {
    Error::new(format!("found the board {text:?}, expected {expected}"))
}

fn charuco(size: &str, [square, marker]: [&str; 2], name: &str, legacy: bool) -> Result<BoardSpec> {
    let [columns, rows] = size_of("squares", size, 3)?;
    let (square_m, marker_m) = (length_m("side of a square", square)?, length_m("side of a marker", marker)?);
    if marker_m >= square_m {
        let message = format!("found markers of {marker} in squares of {square}, expected markers that are smaller");
        return Err(Error::new(message));
    }
    let dictionary = Dictionary::from_name(name)?;
    let (needed, most) = (columns * rows / 2, dictionary.len());
    if needed > most {
        let message = format!(
            "found a board of {columns}x{rows} squares, expected one with at most the {most} markers of {}, not {needed}",
            dictionary.name()
        );
        return Err(Error::new(message));
    }
    Ok(BoardSpec::Charuco(Charuco { columns, rows, square_m, marker_m, dictionary, legacy }))
}

fn circles(size: &str, pitch: &str, asymmetric: bool) -> Result<BoardSpec> {
    let [columns, rows] = size_of("dots", size, if asymmetric { 2 } else { 3 })?;
    Ok(BoardSpec::Circles(Circles { columns, rows, pitch_m: length_m("pitch", pitch)?, asymmetric }))
}

fn aprilgrid(size: &str, tag: &str, spacing: &str, family: &str) -> Result<BoardSpec> {
    let [columns, rows] = size_of("tags", size, 1)?;
    let size_m = length_m("side of a tag", tag)?;
    let part = spacing.parse().ok().filter(|it| (0.05..=1.0).contains(it)).ok_or_else(|| {
        Error::new(format!(
            "found {spacing:?} for the spacing of tags, expected a part of their side from 0.05 to 1, such as 0.3"
        ))
    })?;
    let dictionary = Dictionary::from_name(family)?;
    if columns * rows > dictionary.len() {
        return Err(Error::new(format!(
            "found a board of {columns}x{rows} tags, expected one with at most the {} of {}",
            dictionary.len(),
            dictionary.name()
        )));
    }
    Ok(BoardSpec::AprilGrid(AprilGrid { columns, rows, size_m, spacing: part, dictionary }))
}

fn size_of(what: &str, text: &str, least: usize) -> Result<[usize; 2]> {
    let wrong = || {
        Error::new(format!(
            "found {text:?} for the {what} of a board, expected columns x rows such as 10x7, each {least} to {MOST_SQUARES}"
        ))
    };
    let (columns, rows) = text.split_once(['x', 'X', '×']).ok_or_else(wrong)?;
    let number = |part: &str| part.parse().ok().filter(|it| (least..=MOST_SQUARES).contains(it)).ok_or_else(wrong);
    Ok([number(columns)?, number(rows)?])
}

fn length_m(what: &str, text: &str) -> Result<f64> {
    length(text).ok_or_else(|| {
        Error::new(format!(
            "found {text:?} for the {what}, expected a length above 0 with its unit (mm, cm, m, in), such as 28mm"
        ))
    })
}

/// A length above 0 with its unit, metres.
pub(crate) fn length(text: &str) -> Option<f64> {
    const UNITS: [(&str, f64); 4] = [("mm", 1e-3), ("cm", 1e-2), ("in", 25.4e-3), ("m", 1.0)];
    let (number, metres) =
        UNITS.iter().find_map(|(unit, metres)| text.strip_suffix(unit).map(|number| (number, *metres)))?;
    let value: f64 = number.trim_end().parse().ok()?;
    Some(value * metres).filter(|it| *it > 0.0 && it.is_finite())
}

impl fmt::Display for BoardSpec {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mm = |length_m: f64| (length_m * 1e9).round() / 1e6;
        match self {
            BoardSpec::Chessboard(Chessboard { columns, rows, square_m }) => {
                write!(formatter, "chessboard:{columns}x{rows}:{}mm", mm(*square_m))
            }
            BoardSpec::Circles(Circles { columns, rows, pitch_m, asymmetric }) => {
                let end = if *asymmetric { ":asymmetric" } else { "" };
                write!(formatter, "circles:{columns}x{rows}:{}mm{end}", mm(*pitch_m))
            }
            BoardSpec::Tags(Tags { dictionary, size_m }) => {
                write!(formatter, "tags:{}:{}mm", dictionary.name(), mm(*size_m))
            }
            BoardSpec::AprilGrid(board) => {
                let AprilGrid { columns, rows, size_m, spacing, dictionary } = board;
                write!(formatter, "aprilgrid:{columns}x{rows}:{}mm:{spacing}:{}", mm(*size_m), dictionary.name())
            }
            BoardSpec::Charuco(board) => {
                let Charuco { columns, rows, square_m, marker_m, dictionary, legacy } = board;
                let (square, marker, name) = (mm(*square_m), mm(*marker_m), dictionary.name());
                write!(formatter, "charuco:{columns}x{rows}:{square}mm:{marker}mm:{name}")?;
                if *legacy { formatter.write_str(":legacy") } else { Ok(()) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_board_reads_back_as_it_is_written() {
        for text in [
            "charuco:5x7:36.195mm:18.256mm:DICT_6X6_250",
            "charuco:8x6:30mm:22mm:DICT_4X4_50:legacy",
            "chessboard:10x7:28mm",
            "circles:9x6:30mm",
            "circles:4x11:20mm:asymmetric",
            "tags:DICT_APRILTAG_36h11:50mm",
            "aprilgrid:6x6:88mm:0.3:DICT_APRILTAG_36h11",
        ] {
            assert_eq!(text.parse::<BoardSpec>().unwrap().to_string(), text);
        }
        assert_eq!("chessboard:10x7:2.8cm".parse::<BoardSpec>().unwrap().to_string(), "chessboard:10x7:28mm");
        assert_eq!("chessboard:10x7:1in".parse::<BoardSpec>().unwrap().square_m(), 0.0254);
        assert_eq!("charuco:5x7:36mm:18mm:6x6_250".parse::<BoardSpec>().unwrap().squares(), [5, 7]);
    }

    #[test]
    fn a_wrong_board_is_told_in_one_sentence() {
        for (text, part) in [
            ("checkers", "expected chessboard:COLSxROWS:SQUARE"),
            ("chessboard:10x7", "expected chessboard:COLSxROWS:SQUARE"),
            ("chessboard:10:28mm", "expected columns x rows"),
            ("chessboard:2x7:28mm", "each 3 to 250"),
            ("chessboard:10x7:28", "with its unit"),
            ("chessboard:10x7:-28mm", "above 0"),
            ("chessboard:10x7:infm", "above 0"),
            ("tags:36h11", "expected tags:FAMILY:SIZE"),
            ("aprilgrid:6x6:88mm:30", "expected a part of their side"),
            ("aprilgrid:30x30:88mm:0.3", "at most the 587"),
            ("circles:9x6", "expected circles:COLSxROWS:PITCH"),
            ("circles:2x6:30mm", "each 3 to 250"),
            ("circles:4x11:30mm:odd", "expected asymmetric"),
            ("charuco:5x7:36mm:18mm", "expected charuco:COLSxROWS:SQUARE:MARKER:DICT"),
            ("charuco:5x7:18mm:36mm:DICT_6X6_250", "smaller"),
            ("charuco:5x7:36mm:18mm:DICT_6X6_251", "found the dictionary \"DICT_6X6_251\""),
            ("charuco:15x17:36mm:18mm:DICT_6X6_50", "at most the 50 markers"),
            ("charuco:5x7:36mm:18mm:DICT_6X6_250:old", "expected legacy"),
        ] {
            let message = text.parse::<BoardSpec>().unwrap_err().to_string();
            assert!(message.contains(part) && message.starts_with("found"), "{text}: {message}");
        }
    }
}
