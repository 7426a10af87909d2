//! What a board is, in one line of text.

use std::fmt;
use std::str::FromStr;

use crate::dictionary::Dictionary;
use crate::error::{Error, Result};

/// A board: `chessboard:COLSxROWS:SQUARE` or `charuco:COLSxROWS:SQUARE:MARKER:DICT[:legacy]`. Columns and rows count squares; lengths have a unit
/// (mm, cm, m, in).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Spec {
    /// A plain chessboard.
    Chessboard(Chessboard),
    /// A chessboard with markers in its light squares.
    Charuco(Charuco),
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

/// Most squares along a side, as of `poecal`'s boards.
const MOST_SQUARES: usize = 250;
/// What a specification looks like.
const CHESSBOARD: &str = "chessboard:COLSxROWS:SQUARE, such as chessboard:10x7:28mm";
const CHARUCO: &str = "charuco:COLSxROWS:SQUARE:MARKER:DICT, such as charuco:5x7:36mm:18mm:DICT_6X6_250";

impl Spec {
    /// Squares along x and y.
    #[must_use]
    pub fn squares(&self) -> [usize; 2] {
        match self {
            Spec::Chessboard(board) => [board.columns, board.rows],
            Spec::Charuco(board) => [board.columns, board.rows],
        }
    }

    /// Side of a square, metres.
    #[must_use]
    pub fn square_m(&self) -> f64 {
        match self {
            Spec::Chessboard(board) => board.square_m,
            Spec::Charuco(board) => board.square_m,
        }
    }

    /// The board so many times as large, with squares and markers to a micrometre.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let scaled = |length_m: f64| (length_m * factor * 1e6).round() / 1e6;
        let mut board = self.clone();
        match &mut board {
            Spec::Chessboard(board) => board.square_m = scaled(board.square_m),
            Spec::Charuco(board) => {
                (board.square_m, board.marker_m) = (scaled(board.square_m), scaled(board.marker_m));
            }
        }
        board
    }
}

impl FromStr for Spec {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let parts: Vec<&str> = text.trim().split(':').collect();
        match parts.as_slice() {
            ["chessboard", size, square] => {
                let [columns, rows] = size_of(size)?;
                Ok(Spec::Chessboard(Chessboard { columns, rows, square_m: length_m("square", square)? }))
            }
            ["chessboard", ..] => Err(wrong(text, CHESSBOARD)),
            ["charuco", size, square, marker, name] => charuco(size, [square, marker], name, false),
            ["charuco", size, square, marker, name, "legacy"] => charuco(size, [square, marker], name, true),
            ["charuco", _, _, _, _, last] => {
                Err(Error::new(format!("found {last:?} at the end of a board, expected legacy or nothing")))
            }
            ["charuco", ..] => Err(wrong(text, CHARUCO)),
            _ => Err(wrong(text, &format!("{CHESSBOARD}, or {CHARUCO}"))),
        }
    }
}

fn wrong(text: &str, expected: &str) -> Error {
    Error::new(format!("found the board {text:?}, expected {expected}"))
}

fn charuco(size: &str, [square, marker]: [&str; 2], name: &str, legacy: bool) -> Result<Spec> {
    let [columns, rows] = size_of(size)?;
    let (square_m, marker_m) = (length_m("square", square)?, length_m("marker", marker)?);
    if marker_m >= square_m {
        let message =
            format!("found markers of {marker} in squares of {square}, expected markers that are smaller");
        return Err(Error::new(message));
    }
    let dictionary = Dictionary::named(name)?;
    let (needed, most) = (columns * rows / 2, dictionary.len());
    if needed > most {
        let message = format!(
            "found a board of {columns}x{rows} squares, expected one with at most the {most} markers of {}, not {needed}",
            dictionary.name()
        );
        return Err(Error::new(message));
    }
    Ok(Spec::Charuco(Charuco { columns, rows, square_m, marker_m, dictionary, legacy }))
}

fn size_of(text: &str) -> Result<[usize; 2]> {
    let wrong = || {
        Error::new(format!(
            "found {text:?} for the squares of a board, expected columns x rows such as 10x7, each 3 to {MOST_SQUARES}"
        ))
    };
    let (columns, rows) = text.split_once(['x', 'X', '×']).ok_or_else(wrong)?;
    let number =
        |part: &str| part.parse().ok().filter(|it| (3..=MOST_SQUARES).contains(it)).ok_or_else(wrong);
    Ok([number(columns)?, number(rows)?])
}

fn length_m(what: &str, text: &str) -> Result<f64> {
    length(text).ok_or_else(|| {
        Error::new(format!(
            "found {text:?} for the side of a {what}, expected a length above 0 with its unit (mm, cm, m, in), such as 28mm"
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

impl fmt::Display for Spec {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mm = |length_m: f64| (length_m * 1e9).round() / 1e6;
        match self {
            Spec::Chessboard(Chessboard { columns, rows, square_m }) => {
                write!(formatter, "chessboard:{columns}x{rows}:{}mm", mm(*square_m))
            }
            Spec::Charuco(board) => {
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
        ] {
            assert_eq!(text.parse::<Spec>().unwrap().to_string(), text);
        }
        assert_eq!("chessboard:10x7:2.8cm".parse::<Spec>().unwrap().to_string(), "chessboard:10x7:28mm");
        assert_eq!("chessboard:10x7:1in".parse::<Spec>().unwrap().square_m(), 0.0254);
        assert_eq!("charuco:5x7:36mm:18mm:6x6_250".parse::<Spec>().unwrap().squares(), [5, 7]);
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
            ("charuco:5x7:36mm:18mm", "expected charuco:COLSxROWS:SQUARE:MARKER:DICT"),
            ("charuco:5x7:18mm:36mm:DICT_6X6_250", "smaller"),
            ("charuco:5x7:36mm:18mm:DICT_6X6_251", "found the dictionary \"DICT_6X6_251\""),
            ("charuco:15x17:36mm:18mm:DICT_6X6_50", "at most the 50 markers"),
            ("charuco:5x7:36mm:18mm:DICT_6X6_250:old", "expected legacy"),
        ] {
            let message = text.parse::<Spec>().unwrap_err().to_string();
            assert!(message.contains(part) && message.starts_with("found"), "{text}: {message}");
        }
    }
}
