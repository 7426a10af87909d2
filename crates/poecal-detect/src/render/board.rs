//! Dark and light on the plane of a board.

use nalgebra::Vector2;

use crate::layout::{BoardLayout, BoardPattern, TagGrid};

/// Background beside the board.
pub(super) const BEHIND: i8 = 0;
/// Ink.
pub(super) const DARK: i8 = 1;
/// Paper.
pub(super) const LIGHT: i8 = 2;

/// White paper around the squares, squares.
const PAPER: f64 = 0.5;

/// The shades of a board at positions in squares.
pub(super) struct BoardShades {
    squares: [usize; 2],
    first_dark: bool,
    /// Side of a marker in squares, and cells along it.
    marker: f64,
    cells: usize,
    /// Marks of the dark cells of the markers of all squares.
    dark: Vec<Option<Vec<bool>>>,
    /// Radius of dots, squares, and true if they are on every second corner.
    dots: Option<(f64, bool)>,
    tags: Option<TagGrid>,
}

impl BoardShades {
    pub(super) fn new(layout: &BoardLayout) -> Self {
        let [columns, rows] = layout.squares;
        let mut shades = BoardShades {
            squares: layout.squares,
            first_dark: layout.first_dark,
            marker: 0.0,
            cells: 1,
            dark: vec![None; columns * rows],
            dots: match layout.pattern {
                BoardPattern::Squares | BoardPattern::Tags(_) => None,
                BoardPattern::Dots { asymmetric, diameter } => Some((0.5 * diameter, asymmetric)),
            },
            tags: match &layout.pattern {
                BoardPattern::Tags(tags) => Some(tags.clone()),
                BoardPattern::Squares | BoardPattern::Dots { .. } => None,
            },
        };
        let Some((dictionary, side)) = &layout.markers else { return shades };
        (shades.marker, shades.cells) = (*side, dictionary.bits() + 2);
        for id in 0..layout.marker_count() {
            let Some([column, row]) = layout.square_of(id) else { continue };
            let cell = |at: usize| {
                let (x, y) = (at % shades.cells, at / shades.cells);
                // Cell 0 is border: `is_black` is true for cells outside.
                dictionary.is_black(id, x.wrapping_sub(1), y.wrapping_sub(1))
            };
            shades.dark[row * columns + column] = Some((0..shades.cells * shades.cells).map(cell).collect());
        }
        shades
    }

    /// The shade at a position.
    pub(super) fn shade_at(&self, place: Vector2<f64>) -> i8 {
        let [width, height] = self.squares.map(|it| it as f64);
        let off = |value: f64, size: f64| (-value).max(value - size);
        let outside = off(place.x, width).max(off(place.y, height));
        if outside >= 0.0 {
            return if outside < PAPER { LIGHT } else { BEHIND };
        }
        if let Some((radius, asymmetric)) = self.dots {
            return if self.is_dot(place, radius, asymmetric) { DARK } else { LIGHT };
        }
        if let Some(tags) = &self.tags {
            return if is_tag(tags, place - Vector2::new(1.0, 1.0)) { DARK } else { LIGHT };
        }
        let (column, row) = (place.x as usize, place.y as usize);
        if ((column + row) % 2 == 0) == self.first_dark {
            return DARK;
        }
        let Some(Some(cells)) = self.dark.get(row * self.squares[0] + column) else { return LIGHT };
        let in_marker = |value: f64| ((value.fract() - 0.5) / self.marker + 0.5) * self.cells as f64;
        let (x, y) = (in_marker(place.x), in_marker(place.y));
        if x < 0.0 || y < 0.0 || x >= self.cells as f64 || y >= self.cells as f64 {
            return LIGHT;
        }
        if cells[y as usize * self.cells + x as usize] { DARK } else { LIGHT }
    }

    /// True if a point is within a dot.
    fn is_dot(&self, place: Vector2<f64>, radius: f64, asymmetric: bool) -> bool {
        let [columns, rows] = self.squares.map(|it| it as f64 - 1.0);
        [place.y.floor(), place.y.ceil()].into_iter().filter(|row| (1.0..=rows).contains(row)).any(|row| {
            // Distance of the first dot of the row, and step from dot to dot.
            let (first, step) = if asymmetric { (1.0 + (row - 1.0) % 2.0, 2.0) } else { (1.0, 1.0) };
            let last = first + columns - step;
            let column = (first + ((place.x - first) / step).round() * step).clamp(first, last);
            (place - Vector2::new(column, row)).norm() < radius
        })
    }
}

/// True if a point is dark, in sides of a tag from the upper left one.
fn is_tag(tags: &TagGrid, place: Vector2<f64>) -> bool {
    let pitch = 1.0 + tags.gap;
    let at = |value: f64, count: usize| {
        // Number of the tag, and position on it or in the gap after it.
        let number = (value / pitch).floor().clamp(-1.0, count as f64);
        (number, value - number * pitch)
    };
    let ((column, x), (row, y)) = (at(place.x, tags.columns), at(place.y, tags.rows));
    let inside = |number: f64, count: usize| number >= 0.0 && number < count as f64;
    if x >= 1.0 && y >= 1.0 {
        // Dark between four tags, and outside the last ones.
        let near = |number: f64, own: f64, count: usize| number < count as f64 && own < pitch;
        return tags.kalibr && near(column, x, tags.columns) && near(row, y, tags.rows);
    }
    if x >= 1.0 || y >= 1.0 || !inside(column, tags.columns) || !inside(row, tags.rows) {
        return false;
    }
    let row = if tags.kalibr { tags.rows - 1 - row as usize } else { row as usize };
    let id = row * tags.columns + column as usize;
    let cells = tags.cells();
    let cell = |value: f64| ((value * cells as f64) as usize).min(cells - 1);
    tags.is_black(id, cell(x), cell(y))
}
