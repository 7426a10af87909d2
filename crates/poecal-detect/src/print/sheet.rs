//! What is on a page.

/// A rectangle, millimetres from the upper left corner of the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Its upper left corner.
    pub from_mm: [f64; 2],
    /// Its lower right corner.
    pub to_mm: [f64; 2],
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
    /// The squares of the board together.
    pub board: Rectangle,
    /// What is black.
    pub rectangles: Vec<Rectangle>,
    /// What is written.
    pub words: Vec<Words>,
}
