//! Points of calibration boards in pictures: corners of chessboards, ChArUco boards, tags and grids of tags, and dots of circle grids, each with its
//! name, its place and the standard deviation of it.
//!
//! A [`Spec`] says what the board is, [`Picture::open`] reads a picture, and [`Detector::detect`] gives its corners or the reason why there are
//! none. Pixels are OpenCV's: the centre of the first pixel is (0, 0). Corners have the names of `poecal`'s `Board::chessboard`: `corner0`,
//! `corner1`, … along x first, from the first inner corner; of a ChArUco board these are OpenCV's ids. Dots are `dot0`, `dot1`, … in
//! OpenCV's order, and corners of tags `tag12.0` to `tag12.3`: upper left, upper right, lower right and lower left of the tag as it is printed. What a
//! dictionary of OpenCV calls upright is meant; Kalibr prints AprilTags the other way up, and on its grid they are named as they stand there.
//! [`Layout::points`] has the places on the board.
//!
//! A corner is never guessed: each is where two edges cross, with dark and light as the board has them, and agrees with its neighbours. What is
//! hidden is left out.
//!
//! For programs that take pictures of boards; public items follow semantic versioning. Markers are found and read by `quads.rs` and `markers.rs`,
//! crossings joined to a board by `grid.rs` and `growth.rs` and refined by `saddle.rs`; `suggest.rs` names another board that fits. Not here: robots,
//! lenses' calibration, and other crates of the workspace.

#![forbid(unsafe_code)]

mod aprilgrid;
mod bias;
mod charuco;
mod chessboard;
mod circles;
mod detector;
mod ellipse;
mod error;
mod found;
mod gray;
mod grid;
mod growth;
mod homography;
mod lattice;
mod layout;
mod light;
mod median;
mod named;
mod normal;
mod parts;
mod picture;
pub mod print;
pub mod render;
mod saddle;
mod spec;
mod suggest;
mod tags;
mod vector;
mod whole;

use tags::{dictionary, markers, patch, quads, tagfit, tagmodel};

use picture::{decoded, exif, preview};

pub use detector::{Detector, MOST_DOTS};
pub use error::{Error, Result};
pub use found::{Corner, Found, Kind, Rejected};
pub use gray::Gray;
pub use layout::{Layout, Pattern, Point, Tagged};
pub use picture::{MOST_PIXELS, Picture, Turned, Undecodable};
pub use preview::{png, preview};
pub use spec::{AprilGrid, Charuco, Chessboard, Circles, Spec, Tags};
pub use suggest::Suggestion;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
