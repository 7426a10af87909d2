//! Content of a page.

use crate::layout::BoardLayout;

/// A rectangle, millimetres from the upper left corner of the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Upper left corner.
    pub from_mm: [f64; 2],
    /// Lower right corner.
    pub to_mm: [f64; 2],
}

/// A disc, millimetres from the upper left corner of the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Its middle.
    pub middle_mm: [f64; 2],
    /// Its radius.
    pub radius_mm: f64,
}

/// A line of words in Helvetica, millimetres from the upper left corner of the page.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetText {
    /// The words, in ASCII.
    pub text: String,
    /// Start of their base line.
    pub at_mm: [f64; 2],
    /// Size of the type.
    pub size_mm: f64,
    /// Length of the line.
    pub length_mm: f64,
    /// True if they run downwards, to be read from the right.
    pub downwards: bool,
}

/// A page with a board, rulers and words, to scale.
#[derive(Clone, Debug, PartialEq)]
pub struct PrintSheet {
    /// Width and height of the page, millimetres.
    pub size_mm: [f64; 2],
    /// Title: the drawn board.
    pub title: String,
    /// Extent of the squares of the board; for dots with a pitch of white around them, for tags with the space between and below them.
    pub board: Rectangle,
    /// Black rectangles.
    pub rectangles: Vec<Rectangle>,
    /// Black discs.
    pub discs: Vec<Disc>,
    /// Words on the page.
    pub words: Vec<SheetText>,
    /// Drawn layout: of loose tags as many as fit.
    pub(super) layout: BoardLayout,
    /// Origin of the layout on the page.
    pub(super) origin_mm: [f64; 2],
}

impl PrintSheet {
    /// Position of a point of the board on the page, millimetres from its upper left corner: by its number, as of a [`DetectedCorner`](crate::DetectedCorner).
    #[must_use]
    pub fn place_mm(&self, id: usize) -> [f64; 2] {
        place_on_page(&self.layout, self.origin_mm, self.layout.corner(id).into())
    }

    /// Number of points on the page.
    #[must_use]
    pub fn points(&self) -> usize {
        self.layout.corners()
    }
}

/// Position on a page of a point of a layout in squares.
pub(super) fn place_on_page(layout: &BoardLayout, origin_mm: [f64; 2], place: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|axis| origin_mm[axis] + place[axis] * layout.square_m * 1e3)
}
