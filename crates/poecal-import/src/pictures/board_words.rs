//! Boards in the words of `poecal detect`, as far as they determine the points of a board. The markers and their pattern do not.

use poecal_model::camera::Board;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::named_unit::positive_length_m;

/// Name of the board of all corners if no column names it.
pub(crate) const BOARD: &str = "board";

const SQUARES: &str =
    "squares along x and y and their side, as chessboard:10x7:27mm or charuco:5x7:36mm:18mm:DICT_6X6_250";

/// Kinds of boards, and the expected form of each.
const KINDS: [(&str, &str); 5] = [
    ("chessboard", SQUARES),
    ("charuco", SQUARES),
    ("circles", "dots along x and y and the pitch of the rows, as circles:9x6:30mm or circles:4x11:20mm:asymmetric"),
    (
        "aprilgrid",
        "tags along x and y, their side, and what is between them as a part of it, as aprilgrid:6x6:88mm:0.3",
    ),
    ("tags", "a family and the side of a tag with its black border, as tags:36h11:50mm"),
];

/// The board of a specification; `None` if the words are none, such as the name of a file.
pub(crate) fn in_words(typed: &str) -> Option<Result<Board>> {
    let (name, rest) = typed.trim().split_once(':')?;
    let (_, expected) = KINDS.iter().find(|it| it.0 == name)?;
    let refuse = || ErrorKind::Option.error(format!("found the board `{typed}`, expected {expected}"));
    let parts: Vec<&str> = rest.split(':').collect();
    Some(board(name, &parts).and_then(|board| board.ok_or_else(refuse)))
}

/// Parses `COLSxROWS`.
fn size(text: &str) -> Option<[usize; 2]> {
    let (columns, rows) = text.split_once(['x', 'X', '×'])?;
    Some([columns.trim().parse().ok()?, rows.trim().parse().ok()?])
}

/// The board of a kind; `None` if the parts do not belong to it.
fn board(kind: &str, parts: &[&str]) -> Result<Option<Board>> {
    let sized = |counts: &str, length: &str| Ok(size(counts).zip(positive_length_m(length)?));
    let circles = |dots: &str, pitch: &str, is_asymmetric| match sized(dots, pitch)? {
        Some((dots, pitch_m)) => Board::circles(BOARD, dots, pitch_m, is_asymmetric).map(Some),
        None => Ok(None),
    };
    match (kind, parts) {
        // Markers do not move the corners.
        ("chessboard", [squares, side]) | ("charuco", [squares, side, ..]) => match sized(squares, side)? {
            Some((squares, side_m)) => Board::chessboard(BOARD, squares, side_m).map(Some),
            None => Ok(None),
        },
        ("circles", [dots, pitch]) => circles(dots, pitch, false),
        ("circles", [dots, pitch, "asymmetric"]) => circles(dots, pitch, true),
        // The family of tags does not either.
        ("aprilgrid", [tags, side, spacing] | [tags, side, spacing, _]) => {
            match (sized(tags, side)?, spacing.trim().parse()) {
                (Some((tags, side_m)), Ok(spacing)) => Board::april_grid(BOARD, tags, side_m, spacing).map(Some),
                _ => Ok(None),
            }
        }
        // One tag; there are as many as the corners name, and each is a board with a pose of its own.
        ("tags", [_, side]) => positive_length_m(side)?.map(|side_m| Board::tag(BOARD, side_m)).transpose(),
        _ => Ok(None),
    }
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
