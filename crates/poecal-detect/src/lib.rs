//! Points of calibration boards in pictures: corners of chessboards, ChArUco boards, tags and grids of tags, and dots of circle grids, each with its
//! name, its position and its standard deviation.
//!
//! A [`Spec`] describes the board, [`Picture::open`] reads a picture, and [`Detector::detect`] returns its corners or the reason why there are none.
//! Pixels are OpenCV's: the centre of the first pixel is (0, 0). Corners have the names of `poecal`'s `Board::chessboard`: `corner0`, `corner1`, …
//! along x first, from the first inner corner; on a ChArUco board these are OpenCV's ids. Dots are `dot0`, `dot1`, … in OpenCV's order. Corners of
//! tags are `tag12.0` to `tag12.3`: upper left, upper right, lower right and lower left of the printed tag. Upright is the orientation in a
//! dictionary of OpenCV; Kalibr prints AprilTags upside down, and on its grid they are named as they stand there. [`Layout::points`] has the
//! positions on the board.
//!
//! A corner is never guessed: each is a crossing of two edges, with dark and light as on the board, and agrees with its neighbours. Hidden corners
//! are left out.
//!
//! For programs that take pictures of boards; public items follow semantic versioning. Markers are found and read by `quads.rs` and `markers.rs`,
//! crossings joined to a board by `grid.rs` and `growth.rs` and refined by `saddle.rs`; `suggest.rs` names another board that fits. This crate
//! contains no robots, no lens calibration, and no other crates of the workspace.

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
