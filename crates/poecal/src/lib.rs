//! Kinematic calibration of serial robots by the product of exponentials.

pub mod analysis;
pub mod calibration;
pub mod error;
pub mod estimate;
pub mod gauge;
pub mod io;
pub mod lie;

mod linalg;
pub mod measurement;
pub mod parameters;
pub mod problem;
pub mod report;
pub mod robot;
pub mod simulate;
pub mod solve;
pub mod start;

pub use error::{Error, ErrorKind, Result, nearest};
