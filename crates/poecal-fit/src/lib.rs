//! Estimation: the state and the unknowns of a fit, the least-squares problem, its start, identifiability, uncertainty, diagnosis, hand-eye.
//!
//! A part of [poecal](https://docs.rs/poecal), for its other crates, the program and the package. Its interface follows their needs and is not
//! stable by itself.
//!
//! - [`state`] has all quantities that may change in a fit, and its prediction of each row.
//! - [`parameters`] are unknowns with columns; they see no measured functions, weights or solver.
//! - [`problem`] is the only place where rows and columns meet, and has no algorithms.
//! - [`forensics`] names mistakes, and changes nothing but its own copies; [`input_doubts`] judges rows as they are read.
//! - [`hand_eye`] takes lists of poses, no robot.
//!
//! The order of a calibration's steps, files and tables are not here.

#![forbid(unsafe_code)]

// The reference of the kernels is one file for the tests beside the code and those in `tests/`.
#[cfg(test)]
extern crate self as poecal_fit;
#[cfg(test)]
#[allow(dead_code)]
#[path = "../tests/reference/mod.rs"]
mod reference;

pub mod analysis;
pub mod forensics;
pub mod gauge;
pub mod hand_eye;
pub mod input_doubts;
pub mod parameters;
pub mod problem;
pub mod start;
pub mod state;
pub mod uncertainty;
