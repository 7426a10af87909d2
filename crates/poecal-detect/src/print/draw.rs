//! The page of a board, to scale.

use super::black::{discs, rectangles};
use super::board_description::unit;
use super::furniture::{labels, rulers, texts};
use super::page::PaperSize;
use super::sheet::{PrintSheet, Rectangle};
use super::{decimal, pdf, svg};
use crate::error::{Error, Result};
use crate::layout::{BoardLayout, BoardPattern};
use crate::spec::BoardSpec;

/// White margin around the board for rulers and words, millimetres.
const MARGIN_MM: f64 = 10.0;
/// Smallest squares that a printer can draw, millimetres.
const LEAST_MM: f64 = 1.0;
/// White between loose tags, sides of a tag and millimetres: it contains their names, and a cell of white on each side if they are cut out.
const APART: f64 = 0.4;
const APART_MM: f64 = 8.0;

impl PrintSheet {
    /// The page of a board, which is in its middle; of loose tags as many as fit, from the first one on.
    ///
    /// # Errors
    /// If the board is larger than the space on the page, or has squares below 1 mm.
    pub fn new(spec: &BoardSpec, page: &PaperSize) -> Result<Self> {
        let square_mm = spec.square_m() * 1e3;
        if square_mm < LEAST_MM {
            let unit = unit(spec);
            let message = format!("found {unit} of {square_mm} mm, expected at least {LEAST_MM} mm on paper");
            return Err(Error::new(message));
        }
        let ways = page.ways().into_iter().map(|size| (layout(spec, size), size));
        let ways = ways.map(|(layout, size)| (rank(&layout, size), layout, size));
        // The first of two equal ones wins: upright.
        let best = ways.reduce(|best, other| if other.0 > best.0 { other } else { best });
        let Some((_, layout, size_mm)) = best.filter(|((_, margin), ..)| *margin >= MARGIN_MM - 1e-6) else {
            return Err(too_large(spec, page));
        };
        let [from, to] = extent(&layout).map(|it| it.map(|it| it * square_mm));
        let from_mm = [0, 1].map(|axis| (size_mm[axis] - (to[axis] - from[axis])) / 2.0);
        let origin_mm = [0, 1].map(|axis| from_mm[axis] - from[axis]);
        let board = Rectangle { from_mm, to_mm: [0, 1].map(|axis| origin_mm[axis] + to[axis]) };
        let mut rectangles = rectangles(&layout, origin_mm);
        let discs = discs(&layout, origin_mm);
        let (lines, mut words) = rulers(size_mm, &board, square_mm);
        rectangles.extend(lines);
        words.extend(texts(spec, size_mm, &board, square_mm));
        words.extend(labels(&layout, origin_mm));
        Ok(PrintSheet { size_mm, title: spec.to_string(), board, rectangles, discs, words, layout, origin_mm })
    }

    /// The page as SVG, in millimetres.
    #[must_use]
    pub fn svg(&self) -> String {
        svg::write_svg(self)
    }

    /// The page as PDF, which requests unscaled printing. It is ASCII.
    #[must_use]
    pub fn pdf(&self) -> String {
        pdf::write_pdf(self)
    }
}

/// Layout that is drawn on a page of this size.
fn layout(spec: &BoardSpec, size_mm: [f64; 2]) -> BoardLayout {
    let mut layout = BoardLayout::new(spec);
    let square_mm = layout.square_m * 1e3;
    let BoardPattern::Tags(tags) = &mut layout.pattern else { return layout };
    if tags.kalibr {
        return layout;
    }
    tags.gap = APART.max(APART_MM / square_mm);
    let room = size_mm.map(|it| (it - 2.0 * MARGIN_MM + 1e-6) / square_mm);
    // A tag and the space below it; beside the last one there is none.
    let fit = |room: f64| (room / (1.0 + tags.gap)).floor().max(1.0) as usize;
    tags.columns = fit(room[0] + tags.gap).min(tags.dictionary.len());
    tags.rows = fit(room[1]).min(tags.dictionary.len() / tags.columns);
    layout
}

/// Extent of a layout, in its squares: the upper left and the lower right corner.
fn extent(layout: &BoardLayout) -> [[f64; 2]; 2] {
    let BoardPattern::Tags(tags) = &layout.pattern else {
        return [[0.0; 2], layout.squares.map(|it| it as f64)];
    };
    let pitch = 1.0 + tags.gap;
    let last = [tags.columns, tags.rows].map(|it| 1.0 + it as f64 * pitch);
    if tags.kalibr { [[1.0 - tags.gap; 2], last] } else { [[1.0; 2], [last[0] - tags.gap, last[1]]] }
}

/// Rank of a layout on a page: number of its points there, and the white around it, millimetres.
fn rank(layout: &BoardLayout, size_mm: [f64; 2]) -> (usize, f64) {
    let [from, to] = extent(layout);
    let white = |axis: usize| (size_mm[axis] - (to[axis] - from[axis]) * layout.square_m * 1e3) / 2.0;
    (layout.corners(), white(0).min(white(1)))
}

fn too_large(spec: &BoardSpec, page: &PaperSize) -> Error {
    let mm = |value: f64| decimal(value, 2);
    // A single tag for loose tags.
    let [from, to] = extent(&layout(spec, [0.0; 2]));
    let squares = [0, 1].map(|axis| to[axis] - from[axis]);
    let sides = squares.map(|it| it * spec.square_m() * 1e3);
    let room =
        |size: [f64; 2]| ((size[0] - 2.0 * MARGIN_MM) / squares[0]).min((size[1] - 2.0 * MARGIN_MM) / squares[1]);
    let most = page.ways().into_iter().map(room).fold(0.0, f64::max);
    // A tenth of a millimetre, or exactly the space that a page of a stated size leaves.
    let most = ((most * 10.0 + 1e-6).floor() / 10.0).max(0.0);
    let smaller =
        if most >= LEAST_MM { format!(", or {} of at most {} mm", unit(spec), mm(most)) } else { String::new() };
    let [width, height] = sides.map(mm);
    let [wide, high] = sides.map(|it| mm(it + 2.0 * MARGIN_MM));
    Error::new(format!(
        "found a board of {width} x {height} mm on a page of {page}, expected a page of at least {wide} x {high} mm, which leaves {MARGIN_MM} mm on each side for rulers and words{smaller}"
    ))
}
