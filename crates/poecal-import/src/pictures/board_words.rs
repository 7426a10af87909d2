//! Boards in words, as `poecal detect` has them: what moves the points of a board. Which markers it has, or in which pattern, does not.

use poecal_model::camera::Board;
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_numerics::named_unit::positive_length_m;

/// The board of all corners where no column names it.
pub(crate) const BOARD: &str = "board";

/// A kind of board: its name, what is expected, and its reader.
struct Kind {
    name: &'static str,
    expected: &'static str,
    read: fn(&[&str]) -> Result<Option<Board>>,
}

const SQUARES: &str =
    "squares along x and y and their side, as chessboard:10x7:27mm or charuco:5x7:36mm:18mm:DICT_6X6_250";

const KINDS: [Kind; 5] = [
    Kind { name: "chessboard", expected: SQUARES, read: chessboard },
    Kind { name: "charuco", expected: SQUARES, read: charuco },
    Kind {
        name: "circles",
        expected: "dots along x and y and the pitch of the rows, as circles:9x6:30mm or circles:4x11:20mm:asymmetric",
        read: circles,
    },
    Kind {
        name: "aprilgrid",
        expected: "tags along x and y, their side, and what is between them as a part of it, as aprilgrid:6x6:88mm:0.3",
        read: april_grid,
    },
    Kind {
        name: "tags",
        expected: "a family and the side of a tag with its black border, as tags:36h11:50mm",
        read: tags,
    },
];

/// The board of a specification; `None` of what is none, such as the name of a file.
pub(crate) fn in_words(typed: &str) -> Option<Result<Board>> {
    let mut parts = typed.trim().split(':');
    let name = parts.next()?;
    let rest: Vec<&str> = parts.collect();
    let kind = KINDS.iter().find(|it| it.name == name && !rest.is_empty())?;
    let refuse = || {
        let message = format!("found the board `{typed}`, expected {}", kind.expected);
        Error::new(ErrorKind::Option, message)
    };
    Some((kind.read)(&rest).and_then(|board| board.ok_or_else(refuse)))
}

/// `COLSxROWS`.
fn size(text: &str) -> Option<[usize; 2]> {
    let (columns, rows) = text.split_once(['x', 'X', '×'])?;
    Some([columns.trim().parse().ok()?, rows.trim().parse().ok()?])
}

/// Two things that may be missing, both of which a board needs.
fn both<T>(one: Option<T>, length: &str) -> Result<Option<(T, f64)>> {
    Ok(one.zip(positive_length_m(length)?))
}

fn chessboard(parts: &[&str]) -> Result<Option<Board>> {
    let [squares, side] = parts else { return Ok(None) };
    let Some((squares, side_m)) = both(size(squares), side)? else { return Ok(None) };
    Board::chessboard(BOARD, squares, side_m).map(Some)
}

/// As a chessboard: its markers do not move the corners.
fn charuco(parts: &[&str]) -> Result<Option<Board>> {
    chessboard(parts.get(..2).unwrap_or_default())
}

fn circles(parts: &[&str]) -> Result<Option<Board>> {
    let (dots, pitch, is_asymmetric) = match parts {
        [dots, pitch] => (dots, pitch, false),
        [dots, pitch, "asymmetric"] => (dots, pitch, true),
        _ => return Ok(None),
    };
    let Some((dots, pitch_m)) = both(size(dots), pitch)? else { return Ok(None) };
    Board::circles(BOARD, dots, pitch_m, is_asymmetric).map(Some)
}

/// The family of its tags does not move them.
fn april_grid(parts: &[&str]) -> Result<Option<Board>> {
    let ([tags, side, spacing] | [tags, side, spacing, _]) = parts else { return Ok(None) };
    let wanted = size(tags).zip(spacing.trim().parse().ok());
    let Some(((tags, spacing), side_m)) = both(wanted, side)? else { return Ok(None) };
    Board::april_grid(BOARD, tags, side_m, spacing).map(Some)
}

/// One tag, of which there are as many as the corners name: each is a board at a place of its own.
fn tags(parts: &[&str]) -> Result<Option<Board>> {
    let [_, side] = parts else { return Ok(None) };
    let Some(side_m) = positive_length_m(side)? else { return Ok(None) };
    Board::tag(BOARD, side_m).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boards_in_words_have_their_points() {
        for (typed, points, last) in [
            ("chessboard:10x7:27mm", 54, "corner53"),
            ("charuco:5x7:36mm:18mm:DICT_6X6_250:legacy", 24, "corner23"),
            ("circles:9x6:30mm", 54, "dot53"),
            ("circles:4x11:20mm:asymmetric", 44, "dot43"),
            ("aprilgrid:6x6:88mm:0.3", 144, "tag35.3"),
            ("aprilgrid:6x5:88mm:0.3:25h9", 120, "tag29.3"),
            ("tags:36h11:50mm", 4, "3"),
        ] {
            let board = in_words(typed).unwrap().unwrap();
            assert_eq!((board.names.len(), board.names.last().unwrap().as_str()), (points, last), "{typed}");
        }
    }

    #[test]
    fn what_is_no_board_is_told_with_what_one_is() {
        for (typed, part) in [
            ("chessboard:10x7:27mm:18mm", "as chessboard:10x7:27mm"),
            ("charuco:10x7", "as chessboard:10x7:27mm"),
            ("circles:9x6:30mm:odd", "as circles:9x6:30mm"),
            ("circles:2x6:30mm", "3 to 250 along each side"),
            ("circles:9x6:-30mm", "as circles:9x6:30mm"),
            ("aprilgrid:6x6:88mm", "as aprilgrid:6x6:88mm:0.3"),
            ("aprilgrid:6x6:88mm:3", "at most 1"),
            ("aprilgrid:6:88mm:0.3", "as aprilgrid:6x6:88mm:0.3"),
            ("tags:36h11", "as tags:36h11:50mm"),
            ("tags:36h11:50kg", "found"),
        ] {
            let message = in_words(typed).unwrap().unwrap_err().to_string();
            assert!(message.contains(part), "{typed}: {message}");
        }
        assert!(in_words("board.csv").is_none() && in_words("circles").is_none());
    }
}
