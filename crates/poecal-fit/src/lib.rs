//! The state of a fit and what is unknown in it, the least-squares problem, its start, what the rows determine, uncertainty, diagnosis, hand-eye.
//!
//! A part of [poecal](https://docs.rs/poecal): its interface follows the needs of the other parts and promises nothing by itself.

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
pub mod parameters;
pub mod problem;
pub mod start;
pub mod state;
pub mod uncertainty;
