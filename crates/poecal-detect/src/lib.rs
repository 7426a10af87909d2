//! Points of calibration boards in pictures: corners of chessboards, ChArUco boards, tags and grids of tags, and dots of circle grids, each with its
//! name, its position and its standard deviation.
//!
//! A [`BoardSpec`] describes the board, [`GrayPicture::open`] reads a picture, and [`Detector::detect`] returns its corners or the reason why there are none.
//! Pixels are OpenCV's: the centre of the first pixel is (0, 0). Corners have the names of `poecal`'s `Board::chessboard`: `corner0`, `corner1`, …
//! along x first, from the first inner corner; on a ChArUco board these are OpenCV's ids. Dots are `dot0`, `dot1`, … in OpenCV's order. Corners of
//! tags are `tag12.0` to `tag12.3`: upper left, upper right, lower right and lower left of the printed tag. Upright is the orientation in a
//! dictionary of OpenCV; Kalibr prints AprilTags upside down, and on its grid they are named as they stand there. [`BoardLayout::points`] has the
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
mod board_completeness;
mod charuco;
mod chessboard;
mod circles;
mod dark_regions;
mod detection;
mod detector;
mod ellipse;
mod error;
mod gray;
mod grid;
mod growth;
mod homography;
mod lattice;
mod layout;
mod light;
mod median;
mod normal;
mod numbered_dots;
mod picture;
pub mod print;
pub mod render;
mod saddle;
mod spec;
mod suggest;
mod tags;
mod vector;

use tags::{dictionary, markers, patch, quads, tagfit, tagmodel};

use picture::{decoding, exif, preview};

pub use detection::{DetectedBoard, DetectedCorner, PointKind, RejectionReason};
pub use detector::{Detector, MOST_DOTS};
pub use error::{Error, Result};
pub use gray::Gray;
pub use layout::{BoardLayout, BoardPattern, BoardPoint, TagGrid};
pub use picture::{GrayPicture, MOST_PIXELS, PictureError, PictureOrientation};
pub use preview::{png, preview};
pub use spec::{AprilGrid, BoardSpec, Charuco, Chessboard, Circles, Tags};
pub use suggest::Suggestion;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
