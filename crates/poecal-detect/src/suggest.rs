//! Another board that fits, where the stated one does not.

use std::fmt;

use crate::aprilgrid;
use crate::charuco;
use crate::chessboard;
use crate::circles;
use crate::dictionary::Dictionary;
use crate::ellipse::Dot;
use crate::found::{Found, Rejected};
use crate::gray::Gray;
use crate::layout::Layout;
use crate::light::noise;
use crate::markers::Reader;
use crate::quads::{Quad, quads, quads_apart};
use crate::spec::{AprilGrid, Charuco, Chessboard, Circles, Spec, Tags};
use crate::tags;

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

/// The board that has most corners, if any has some: of several the first that is tried.
pub(crate) fn suggest(spec: &Spec, pictures: &[&Gray]) -> Option<Suggestion> {
    let seen: Vec<(&Gray, f64)> = pictures.iter().map(|gray| (*gray, noise(gray))).collect();
    let all: Vec<Suggestion> = match spec {
        Spec::Chessboard(board) => {
            let tried =
                |spec| suggestion(spec, &seen, |layout, gray, noise| chessboard::detect(gray, layout, noise));
            chessboards(board).into_iter().map(tried).collect()
        }
        Spec::Circles(board) => {
            let dots: Vec<Vec<Dot>> = seen.iter().map(|(gray, noise)| circles::dots(gray, *noise)).collect();
            let tried = |spec| {
                let mut dots = dots.iter();
                suggestion(spec, &seen, |layout, gray, noise| {
                    circles::of_dots(gray, layout, noise, dots.next().ok_or(Rejected::NoBoard)?)
                })
            };
            grids_of_dots(board).into_iter().map(tried).collect()
        }
        Spec::Tags(board) => {
            let quads: Vec<Vec<Quad>> = seen.iter().map(|(gray, noise)| quads(gray, *noise)).collect();
            let tried = |board: Tags| {
                let (dictionary, reader) = (board.dictionary.clone(), Reader::new(&board.dictionary));
                let mut quads = quads.iter();
                suggestion(Spec::Tags(board), &seen, |_, gray, noise| {
                    let quads = quads.next().ok_or(Rejected::NoBoard)?;
                    tags::of_quads(gray, (&dictionary, &reader), noise, quads)
                })
            };
            families(&board.dictionary, 1).map(|dictionary| Tags { dictionary, ..*board }).map(tried).collect()
        }
        Spec::AprilGrid(board) => {
            let quads: Vec<Vec<Quad>> = seen.iter().map(|(gray, noise)| quads_apart(gray, *noise)).collect();
            let tried = |board: AprilGrid| {
                let reader = Reader::with_border(&board.dictionary, 2);
                let mut quads = quads.iter();
                suggestion(Spec::AprilGrid(board), &seen, |layout, gray, noise| {
                    let quads = quads.next().ok_or(Rejected::NoBoard)?;
                    aprilgrid::of_quads(gray, layout, (&reader, noise), quads)
                })
            };
            april_grids(board).into_iter().map(tried).collect()
        }
        Spec::Charuco(board) => {
            // What is costly does not depend on the board.
            let quads: Vec<Vec<Quad>> = seen.iter().map(|(gray, noise)| quads(gray, *noise)).collect();
            let tried = |board: Charuco| {
                let reader = Reader::new(&board.dictionary);
                let mut quads = quads.iter();
                suggestion(Spec::Charuco(board), &seen, |layout, gray, noise| {
                    let quads = quads.next().ok_or(Rejected::NoBoard)?;
                    charuco::of_quads(gray, layout, &reader, noise, quads)
                })
            };
            charucos(board).into_iter().map(tried).collect()
        }
    };
    all.into_iter().filter(|it| it.corners > 0).rev().max_by_key(|it| it.corners)
}

/// What a board has in pictures.
fn suggestion(
    spec: Spec,
    seen: &[(&Gray, f64)],
    mut detect: impl FnMut(&Layout, &Gray, f64) -> Result<Found, Rejected>,
) -> Suggestion {
    let layout = Layout::new(&spec);
    let found = seen.iter().filter_map(|(gray, noise)| detect(&layout, gray, *noise).ok());
    let (pictures, corners) = found.fold((0, 0), |sum, it| (sum.0 + 1, sum.1 + it.corners.len()));
    Suggestion { spec, pictures, corners }
}

/// Corners counted in place of squares, and the other way round.
fn chessboards(board: &Chessboard) -> Vec<Spec> {
    let Chessboard { columns, rows, square_m } = *board;
    let others = [(columns + 1, rows + 1), (columns - 1, rows - 1)];
    let sound = others.into_iter().filter(|(columns, rows)| *columns >= 3 && *rows >= 3);
    sound.map(|(columns, rows)| Spec::Chessboard(Chessboard { columns, rows, square_m })).collect()
}

/// Rows and columns exchanged, the other kind, and dots counted as the squares between them, or the other way round.
fn grids_of_dots(board: &Circles) -> Vec<Spec> {
    let Circles { columns, rows, pitch_m, asymmetric } = *board;
    let counts = [(columns, rows), (rows, columns), (columns + 1, rows + 1), (columns - 1, rows - 1)];
    let kinds = counts.into_iter().flat_map(|count| [(count, asymmetric), (count, !asymmetric)]);
    let sound = kinds.filter(|((columns, rows), asymmetric)| {
        let least = if *asymmetric { 2 } else { 3 };
        (*columns).min(*rows) >= least
    });
    let circles = |((columns, rows), asymmetric)| Circles { columns, rows, pitch_m, asymmetric };
    sound.map(circles).filter(|it| it != board).map(Spec::Circles).collect()
}

/// The other dictionaries that have so many markers.
fn families(own: &Dictionary, markers: usize) -> impl Iterator<Item = Dictionary> {
    Dictionary::smallest(markers).into_iter().filter(move |it| !it.is_alike(own))
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
                let other =
                    Charuco { columns, rows, dictionary: dictionary.clone(), legacy, ..board.clone() };
                // With an odd number of rows both patterns are one.
                let alike = legacy != board.legacy && rows % 2 == 1;
                if other != *board && !alike {
                    all.push(other);
                }
            }
        }
    }
    all
}
