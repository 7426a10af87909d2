//! What is on a page.

use crate::layout::Layout;

/// A rectangle, millimetres from the upper left corner of the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Its upper left corner.
    pub from_mm: [f64; 2],
    /// Its lower right corner.
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
pub struct Words {
    /// The words, in ASCII.
    pub text: String,
    /// Where their base line begins.
    pub at_mm: [f64; 2],
    /// Size of the type.
    pub size_mm: f64,
    /// How long the line is.
    pub length_mm: f64,
    /// Whether they run downwards, read from the right.
    pub downwards: bool,
}

/// A page with a board, rulers and words, to scale.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Width and height of the page, millimetres.
    pub size_mm: [f64; 2],
    /// What is drawn.
    pub title: String,
    /// The squares of the board together; of dots with a pitch of white around them, of tags with what is between them and below.
    pub board: Rectangle,
    /// What is black.
    pub rectangles: Vec<Rectangle>,
    /// What is black, too.
    pub discs: Vec<Disc>,
    /// What is written.
    pub words: Vec<Words>,
    /// What is drawn: of loose tags as many as there is room for.
    pub(super) layout: Layout,
    /// Where the origin of the layout is.
    pub(super) origin_mm: [f64; 2],
}

impl Sheet {
    /// Where a point of the board is on the page, millimetres from its upper left corner: by its number, as of a [`Corner`](crate::Corner).
    #[must_use]
    pub fn place_mm(&self, id: usize) -> [f64; 2] {
        placed(&self.layout, self.origin_mm, self.layout.corner(id).into())
    }

    /// How many points there are on the page.
    #[must_use]
    pub fn points(&self) -> usize {
        self.layout.corners()
    }
}

/// A place of a layout, in squares, on a page.
pub(super) fn placed(layout: &Layout, origin_mm: [f64; 2], place: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|axis| origin_mm[axis] + place[axis] * layout.square_m * 1e3)
}
