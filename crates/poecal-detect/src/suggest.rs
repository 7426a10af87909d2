//! Suggestion of another board, if the stated one does not fit.

use std::fmt;

use crate::detection::{DetectedBoard, RejectionReason};
use crate::dictionary::Dictionary;
use crate::ellipse::Dot;
use crate::gray::Gray;
use crate::layout::BoardLayout;
use crate::light::noise;
use crate::markers::MarkerReader;
use crate::quads::{Quad, quads, quads_apart};
use crate::spec::{AprilGrid, BoardSpec, Charuco, Chessboard, Circles, Tags};
use crate::{aprilgrid, charuco, chessboard, circles, tags};

/// A board that pictures show instead of the stated one.
#[derive(Clone, Debug, PartialEq)]
pub struct Suggestion {
    /// The board.
    pub spec: BoardSpec,
    /// Number of the pictures in which it was found.
    pub pictures: usize,
    /// Number of its corners there.
    pub corners: usize,
}

impl fmt::Display for Suggestion {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Suggestion { spec, pictures, corners } = self;
        write!(formatter, "{spec} has {corners} corners in {pictures} of the pictures")
    }
}

/// The board with the most corners, if any has some: of several the first that is tried.
pub(crate) fn suggest(spec: &BoardSpec, pictures: &[&Gray], most_dots: usize) -> Option<Suggestion> {
    let seen: Vec<(&Gray, f64)> = pictures.iter().map(|gray| (*gray, noise(gray))).collect();
    let all: Vec<Suggestion> = match spec {
        BoardSpec::Chessboard(board) => {
            let seen = prepare_pictures(&seen, |_, _| ());
            let detect =
                |layout: &BoardLayout, one: &AnalysedPicture<'_, ()>| chessboard::detect(one.gray, layout, one.noise);
            chessboards(board).into_iter().map(|spec| suggestion(spec, &seen, detect)).collect()
        }
        BoardSpec::Charuco(board) => charucos_in(board, &prepare_pictures(&seen, quads)),
        BoardSpec::Circles(board) => {
            let dots = |gray: &Gray, noise: f64| circles::dots(gray, noise, most_dots).unwrap_or_default();
            let seen = prepare_pictures(&seen, dots);
            let detect = |layout: &BoardLayout, one: &AnalysedPicture<'_, Vec<Dot>>| {
                circles::of_dots(one.gray, layout, one.noise, &one.parts)
            };
            grids_of_dots(board).into_iter().map(|spec| suggestion(spec, &seen, detect)).collect()
        }
        BoardSpec::Tags(board) => tags_in(board, &prepare_pictures(&seen, quads)),
        BoardSpec::AprilGrid(board) => april_grids_in(board, &prepare_pictures(&seen, quads_apart)),
    };
    all.into_iter().filter(|it| it.corners > 0).rev().max_by_key(|it| it.corners)
}

/// A picture, its noise, and detections that are costly and do not depend on the board.
struct AnalysedPicture<'a, P> {
    gray: &'a Gray,
    noise: f64,
    parts: P,
}

fn prepare_pictures<'a, P>(seen: &[(&'a Gray, f64)], parts: impl Fn(&Gray, f64) -> P) -> Vec<AnalysedPicture<'a, P>> {
    let one = |(gray, noise): &(&'a Gray, f64)| AnalysedPicture { gray, noise: *noise, parts: parts(gray, *noise) };
    seen.iter().map(one).collect()
}

fn charucos_in(board: &Charuco, seen: &[AnalysedPicture<'_, Vec<Quad>>]) -> Vec<Suggestion> {
    let tried = |board: Charuco| {
        let reader = MarkerReader::new(&board.dictionary);
        suggestion(BoardSpec::Charuco(board), seen, |layout, one| {
            charuco::of_quads(one.gray, layout, &reader, one.noise, &one.parts)
        })
    };
    charucos(board).into_iter().map(tried).collect()
}

fn tags_in(board: &Tags, seen: &[AnalysedPicture<'_, Vec<Quad>>]) -> Vec<Suggestion> {
    let tried = |dictionary: Dictionary| {
        let reader = MarkerReader::new(&dictionary);
        let spec = BoardSpec::Tags(Tags { dictionary: dictionary.clone(), ..*board });
        suggestion(spec, seen, |_, one| tags::of_quads(one.gray, (&dictionary, &reader), one.noise, &one.parts))
    };
    families(&board.dictionary, 1).map(tried).collect()
}

fn april_grids_in(board: &AprilGrid, seen: &[AnalysedPicture<'_, Vec<Quad>>]) -> Vec<Suggestion> {
    let tried = |board: AprilGrid| {
        let reader = MarkerReader::with_border(&board.dictionary, 2);
        suggestion(BoardSpec::AprilGrid(board), seen, |layout, one| {
            aprilgrid::of_quads(one.gray, layout, (&reader, one.noise), &one.parts)
        })
    };
    april_grids(board).into_iter().map(tried).collect()
}

/// Detections of a board in pictures.
fn suggestion<P>(
    spec: BoardSpec,
    seen: &[AnalysedPicture<'_, P>],
    detect: impl Fn(&BoardLayout, &AnalysedPicture<'_, P>) -> Result<DetectedBoard, RejectionReason>,
) -> Suggestion {
    let layout = BoardLayout::new(&spec);
    let found = seen.iter().filter_map(|one| detect(&layout, one).ok());
    let (pictures, corners) = found.fold((0, 0), |sum, it| (sum.0 + 1, sum.1 + it.corners.len()));
    Suggestion { spec, pictures, corners }
}

/// Corners counted instead of squares, or the reverse.
fn chessboards(board: &Chessboard) -> Vec<BoardSpec> {
    let Chessboard { columns, rows, square_m } = *board;
    let others = [(columns + 1, rows + 1), (columns - 1, rows - 1)];
    let sound = others.into_iter().filter(|(columns, rows)| *columns >= 3 && *rows >= 3);
    sound.map(|(columns, rows)| BoardSpec::Chessboard(Chessboard { columns, rows, square_m })).collect()
}

/// Rows and columns exchanged, the other kind, and dots counted as the squares between them, or the reverse.
fn grids_of_dots(board: &Circles) -> Vec<BoardSpec> {
    let Circles { columns, rows, pitch_m, asymmetric } = *board;
    let counts = [(columns, rows), (rows, columns), (columns + 1, rows + 1), (columns - 1, rows - 1)];
    let kinds = counts.into_iter().flat_map(|count| [(count, asymmetric), (count, !asymmetric)]);
    let sound = kinds.filter(|((columns, rows), asymmetric)| {
        let least = if *asymmetric { 2 } else { 3 };
        (*columns).min(*rows) >= least
    });
    let circles = |((columns, rows), asymmetric)| Circles { columns, rows, pitch_m, asymmetric };
    sound.map(circles).filter(|it| it != board).map(BoardSpec::Circles).collect()
}

/// The other dictionaries with enough markers.
fn families(own: &Dictionary, markers: usize) -> impl Iterator<Item = Dictionary> {
    Dictionary::smallest_with(markers).into_iter().filter(move |it| !it.is_alike(own))
}

fn april_grids(board: &AprilGrid) -> Vec<AprilGrid> {
    let own = &board.dictionary;
    let all = std::iter::once(own.clone()).chain(families(own, board.columns * board.rows));
    let ways = all.flat_map(|dictionary| {
        [[board.columns, board.rows], [board.rows, board.columns]].map(|[columns, rows]| AprilGrid {
            columns,
            rows,
            dictionary: dictionary.clone(),
            ..board.clone()
        })
    });
    ways.filter(|it| it != board).collect()
}

fn charucos(board: &Charuco) -> Vec<Charuco> {
    let own = board.dictionary.clone();
    let markers = board.columns * board.rows / 2;
    let others = families(&own, markers);
    let mut all = Vec::new();
    for dictionary in std::iter::once(own.clone()).chain(others) {
        for [columns, rows] in [[board.columns, board.rows], [board.rows, board.columns]] {
            for legacy in [board.legacy, !board.legacy] {
                let other = Charuco { columns, rows, dictionary: dictionary.clone(), legacy, ..board.clone() };
                // With an odd number of rows both patterns are the same.
                let alike = legacy != board.legacy && rows % 2 == 1;
                if other != *board && !alike {
                    all.push(other);
                }
            }
        }
    }
    all
}
