//! Black areas of a board on its page.

use super::sheet::{Disc, Rectangle, place_on_page};
use crate::layout::{BoardLayout, BoardPattern, TagGrid};

/// A layout on a page: millimetres of its squares.
struct PageLayout<'a> {
    layout: &'a BoardLayout,
    origin_mm: [f64; 2],
}

impl PageLayout<'_> {
    fn rectangle(&self, from: [f64; 2], to: [f64; 2]) -> Rectangle {
        let [from_mm, to_mm] = [from, to].map(|it| place_on_page(self.layout, self.origin_mm, it));
        Rectangle { from_mm, to_mm }
    }
}

/// Squares, and the cells of markers and tags.
pub(super) fn rectangles(layout: &BoardLayout, origin_mm: [f64; 2]) -> Vec<Rectangle> {
    let page = PageLayout { layout, origin_mm };
    match &layout.pattern {
        BoardPattern::Squares => squares(&page),
        BoardPattern::Dots { .. } => Vec::new(),
        BoardPattern::Tags(tags) => tag_rectangles(&page, tags),
    }
}

/// Dots.
pub(super) fn discs(layout: &BoardLayout, origin_mm: [f64; 2]) -> Vec<Disc> {
    let BoardPattern::Dots { diameter, .. } = layout.pattern else { return Vec::new() };
    let radius_mm = 0.5 * diameter * layout.square_m * 1e3;
    let middle_mm = |id: usize| place_on_page(layout, origin_mm, layout.corner(id).into());
    (0..layout.corners()).map(|id| Disc { middle_mm: middle_mm(id), radius_mm }).collect()
}

fn squares(page: &PageLayout<'_>) -> Vec<Rectangle> {
    let layout = page.layout;
    let [columns, rows] = layout.squares;
    let all = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let corner = |column: usize, row: usize| [column as f64, row as f64];
    let mut black: Vec<Rectangle> = all
        .filter(|(column, row)| layout.is_dark(*column, *row))
        .map(|(column, row)| page.rectangle(corner(column, row), corner(column + 1, row + 1)))
        .collect();
    let Some((dictionary, _)) = &layout.markers else { return black };
    for id in 0..layout.marker_count() {
        // Cell 0 is border: `is_black` is true for cells outside.
        let is_black = |column: usize, row: usize| dictionary.is_black(id, column.wrapping_sub(1), row.wrapping_sub(1));
        black.extend(marker(page, id, dictionary.bits() + 2, is_black));
    }
    black
}

/// Tags, and on Kalibr's boards the squares at their corners.
fn tag_rectangles(page: &PageLayout<'_>, tags: &TagGrid) -> Vec<Rectangle> {
    let mut black = Vec::new();
    for id in 0..tags.columns * tags.rows {
        black.extend(marker(page, id, tags.cells(), |column, row| tags.is_black(id, column, row)));
    }
    if tags.kalibr {
        let at = |number: usize| 1.0 - tags.gap + number as f64 * (1.0 + tags.gap);
        for row in 0..=tags.rows {
            for column in 0..=tags.columns {
                let from = [at(column), at(row)];
                black.push(page.rectangle(from, from.map(|it| it + tags.gap)));
            }
        }
    }
    black
}

/// Black areas of a marker: runs of cells, row by row.
fn marker(page: &PageLayout<'_>, id: usize, cells: usize, is_black: impl Fn(usize, usize) -> bool) -> Vec<Rectangle> {
    let Some([first, _, last, _]) = page.layout.marker_corners(id) else { return Vec::new() };
    let place = |column: usize, row: usize| {
        [(column, 0), (row, 1)].map(|(cell, axis)| {
            let part = cell as f64 / cells as f64;
            first[axis] * (1.0 - part) + last[axis] * part
        })
    };
    let black = |column: usize, row: usize| column < cells && is_black(column, row);
    let mut runs = Vec::new();
    for row in 0..cells {
        let mut begin = None;
        for column in 0..=cells {
            match (begin, black(column, row)) {
                (None, true) => begin = Some(column),
                (Some(from), false) => {
                    runs.push(page.rectangle(place(from, row), place(column, row + 1)));
                    begin = None;
                }
                _ => {}
            }
        }
    }
    runs
}
