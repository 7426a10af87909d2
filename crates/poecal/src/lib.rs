//! Kinematic calibration of serial robots by the product of exponentials.

pub mod error;
pub mod io;
pub mod lie;
pub mod measurement;
pub mod robot;

pub use error::{Error, ErrorKind, Result, nearest};
