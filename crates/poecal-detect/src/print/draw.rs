//! The page of a board, to scale.

use super::furniture::{rulers, texts};
use super::page::Page;
use super::sheet::{Rectangle, Sheet};
use super::{decimal, pdf, svg};
use crate::error::{Error, Result};
use crate::layout::Layout;
use crate::spec::Spec;

/// White around the board, in which rulers and words are, millimetres.
const MARGIN_MM: f64 = 10.0;
/// Squares that a printer can draw, millimetres.
const LEAST_MM: f64 = 1.0;

impl Sheet {
    /// The page of a board, which stands in its middle.
    ///
    /// # Errors
    /// If the board is larger than the page leaves room for, or has squares below 1 mm.
    pub fn new(spec: &Spec, page: &Page) -> Result<Self> {
        let square_mm = spec.square_m() * 1e3;
        if square_mm < LEAST_MM {
            let message =
                format!("found squares of {square_mm} mm, expected at least {LEAST_MM} mm on paper");
            return Err(Error::new(message));
        }
        let sides = spec.squares().map(|it| it as f64 * square_mm);
        let least = |size: [f64; 2]| (size[0] - sides[0]).min(size[1] - sides[1]) / 2.0;
        let ways = page.ways().into_iter().map(|size| (least(size), size));
        // Of two that are alike the first: upright.
        let best = ways.reduce(|best, other| if other.0 > best.0 { other } else { best });
        let Some((_, size_mm)) = best.filter(|(margin, _)| *margin >= MARGIN_MM - 1e-6) else {
            return Err(too_large(spec, sides, page));
        };
        let from_mm = [0, 1].map(|axis| (size_mm[axis] - sides[axis]) / 2.0);
        let board = Rectangle { from_mm, to_mm: [0, 1].map(|axis| from_mm[axis] + sides[axis]) };
        let mut rectangles = dark(&Layout::new(spec), board.from_mm, square_mm);
        let (lines, mut words) = rulers(size_mm, &board, square_mm);
        rectangles.extend(lines);
        words.extend(texts(spec, size_mm, &board, square_mm));
        Ok(Sheet { size_mm, title: spec.to_string(), board, rectangles, words })
    }

    /// The page as SVG, in millimetres.
    #[must_use]
    pub fn svg(&self) -> String {
        svg::written(self)
    }

    /// The page as PDF, which asks viewers to print it unscaled. It is ASCII.
    #[must_use]
    pub fn pdf(&self) -> String {
        pdf::written(self)
    }
}

fn too_large(spec: &Spec, sides: [f64; 2], page: &Page) -> Error {
    let mm = |value: f64| decimal(value, 2);
    let squares = spec.squares().map(|it| it as f64);
    let room = |size: [f64; 2]| {
        ((size[0] - 2.0 * MARGIN_MM) / squares[0]).min((size[1] - 2.0 * MARGIN_MM) / squares[1])
    };
    let most = page.ways().into_iter().map(room).fold(0.0, f64::max);
    // A tenth of a millimetre, or what a page of a given size leaves to the hair.
    let most = ((most * 10.0 + 1e-6).floor() / 10.0).max(0.0);
    let smaller =
        if most >= LEAST_MM { format!(", or squares of at most {} mm", mm(most)) } else { String::new() };
    let [width, height] = sides.map(mm);
    let [wide, high] = sides.map(|it| mm(it + 2.0 * MARGIN_MM));
    Error::new(format!(
        "found a board of {width} x {height} mm on a page of {page}, expected a page of at least {wide} x {high} mm, which leaves {MARGIN_MM} mm on each side for rulers and words{smaller}"
    ))
}

/// What is black of a board.
fn dark(layout: &Layout, origin: [f64; 2], square_mm: f64) -> Vec<Rectangle> {
    let [columns, rows] = layout.squares;
    let square = |column: usize, row: usize| {
        let corner = |column: usize, row: usize| {
            [origin[0] + column as f64 * square_mm, origin[1] + row as f64 * square_mm]
        };
        Rectangle { from_mm: corner(column, row), to_mm: corner(column + 1, row + 1) }
    };
    let all = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let mut black: Vec<Rectangle> = all
        .filter(|(column, row)| layout.is_dark(*column, *row))
        .map(|(column, row)| square(column, row))
        .collect();
    for id in 0..layout.marker_count() {
        black.extend(marker(layout, id, origin, square_mm));
    }
    black
}

/// What is black of a marker: runs of cells, row by row.
fn marker(layout: &Layout, id: usize, origin: [f64; 2], square_mm: f64) -> Vec<Rectangle> {
    let (Some((dictionary, _)), Some([first, _, last, _])) = (&layout.markers, layout.marker_corners(id))
    else {
        return Vec::new();
    };
    let cells = dictionary.bits() + 2;
    let place = |column: usize, row: usize| {
        let [x, y] = [(column, 0), (row, 1)].map(|(cell, axis)| {
            let part = cell as f64 / cells as f64;
            origin[axis] + (first[axis] * (1.0 - part) + last[axis] * part) * square_mm
        });
        [x, y]
    };
    // Cell 0 is border: `is_black` of what is outside is black.
    let black = |column: usize, row: usize| {
        column < cells && dictionary.is_black(id, column.wrapping_sub(1), row.wrapping_sub(1))
    };
    let mut runs = Vec::new();
    for row in 0..cells {
        let mut begin = None;
        for column in 0..=cells {
            match (begin, black(column, row)) {
                (None, true) => begin = Some(column),
                (Some(from), false) => {
                    runs.push(Rectangle { from_mm: place(from, row), to_mm: place(column, row + 1) });
                    begin = None;
                }
                _ => {}
            }
        }
    }
    runs
}
