//! A robot as a tree of joints, its measurements and instruments, cameras and boards, joint offsets, and simulated sessions.
//!
//! A part of [poecal](https://docs.rs/poecal), for its other crates, the program and the package. Its interface follows their needs and is not
//! stable by itself.
//!
//! - [`robot`] has no unknowns and no measured data: names, limits and readings never change in a fit.
//! - [`measurement`] takes the pose of a target, and knows no joints, screws or parameters.
//! - [`camera`] takes corners and returns poses; it has no robots and no rows of a session.
//! - [`forms`] returns frames and rows of tables from a robot, and writes no files.
//! - [`offsets`] compares two robots, without measurements.
//!
//! Unknowns, fits and files are not here.

#![forbid(unsafe_code)]

pub mod camera;
pub mod forms;
pub mod measurement;
pub mod offsets;
pub mod robot;
pub mod simulate;
