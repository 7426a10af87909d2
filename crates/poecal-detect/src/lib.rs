//! Corners of calibration boards in pictures: chessboards and ChArUco boards, each corner with its name, its place and the standard deviation of
//! it.
//!
//! A [`Spec`] says what the board is, [`Picture::open`] reads a picture, and [`Detector::detect`] gives its corners or the reason why there are
//! none. Pixels are OpenCV's: the centre of the first pixel is (0, 0). Corners have the names of `poecal`'s `Board::chessboard`: `corner0`,
//! `corner1`, … along x first, from the first inner corner; of a ChArUco board these are OpenCV's ids.
//!
//! A corner is never guessed: each is where two edges cross, with dark and light as the board has them, and agrees with its neighbours. What is
//! hidden is left out.

#![forbid(unsafe_code)]

mod charuco;
mod chessboard;
mod detector;
mod dictionary;
mod error;
mod found;
mod gray;
mod grid;
mod growth;
mod homography;
mod layout;
mod light;
mod markers;
mod picture;
mod preview;
pub mod print;
mod quads;
pub mod render;
mod saddle;
mod spec;
mod suggest;

pub use detector::Detector;
pub use error::{Error, Result};
pub use found::{Corner, Found, Rejected};
pub use gray::Gray;
pub use layout::Layout;
pub use picture::{Picture, Turned};
pub use preview::{png, preview};
pub use spec::{Charuco, Chessboard, Spec};
pub use suggest::Suggestion;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
