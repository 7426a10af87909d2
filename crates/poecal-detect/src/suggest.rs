//! Another board that fits, where the stated one does not.

use std::fmt;

use crate::detector::{Detector, Found};
use crate::dictionary::Dictionary;
use crate::gray::Gray;
use crate::spec::{Charuco, Chessboard, Spec};

/// A board that pictures show in place of the stated one.
#[derive(Clone, Debug, PartialEq)]
pub struct Suggestion {
    /// The board.
    pub spec: Spec,
    /// In how many of the pictures it was found.
    pub pictures: usize,
    /// Corners that it has there.
    pub corners: usize,
}

impl fmt::Display for Suggestion {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Suggestion { spec, pictures, corners } = self;
        write!(formatter, "{spec} has {corners} corners in {pictures} of the pictures")
    }
}

/// The board that has most corners, if any has some.
pub(crate) fn suggest(detector: &Detector, pictures: &[&Gray]) -> Option<Suggestion> {
    let tried = |spec: Spec| {
        let other = Detector::new(&spec);
        let found: Vec<Found> = pictures.iter().filter_map(|it| other.detect(it).ok()).collect();
        let corners = found.iter().map(|it| it.corners.len()).sum();
        Suggestion { spec, pictures: found.len(), corners }
    };
    let all = alternatives(detector.spec()).into_iter().map(tried);
    all.filter(|it| it.corners > 0).max_by_key(|it| it.corners)
}

/// Boards that are taken for one another.
fn alternatives(spec: &Spec) -> Vec<Spec> {
    match spec {
        Spec::Chessboard(board) => chessboards(board),
        Spec::Charuco(board) => charucos(board),
    }
}

/// Corners counted in place of squares, and the other way round.
fn chessboards(board: &Chessboard) -> Vec<Spec> {
    let Chessboard { columns, rows, square_m } = *board;
    let others = [(columns + 1, rows + 1), (columns - 1, rows - 1)];
    let sound = others.into_iter().filter(|(columns, rows)| *columns >= 3 && *rows >= 3);
    sound.map(|(columns, rows)| Spec::Chessboard(Chessboard { columns, rows, square_m })).collect()
}

fn charucos(board: &Charuco) -> Vec<Spec> {
    let mut all = Vec::new();
    let own = board.dictionary;
    let others = Dictionary::all().into_iter().filter(|it| !it.name().starts_with(family(own.name())));
    for dictionary in std::iter::once(own).chain(others) {
        for [columns, rows] in [[board.columns, board.rows], [board.rows, board.columns]] {
            for legacy in [board.legacy, !board.legacy] {
                let other = Charuco { columns, rows, dictionary, legacy, ..board.clone() };
                let alike = legacy != board.legacy && rows % 2 == 1;
                if other != *board && !alike && columns * rows / 2 <= dictionary.len() {
                    all.push(Spec::Charuco(other));
                }
            }
        }
    }
    all
}

/// The part of a name that dictionaries with the same first markers share.
fn family(name: &str) -> &str {
    let ends = ["_1000", "_250", "_100", "_50"];
    ends.iter().find_map(|end| name.strip_suffix(end)).unwrap_or(name)
}
