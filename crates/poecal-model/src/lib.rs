//! A robot as a tree of joints, its measurements and instruments, cameras and boards, joint offsets, and simulated sessions.
//!
//! A part of [poecal](https://docs.rs/poecal), for the other parts, the program and the package: its interface follows their needs and promises
//! nothing by itself.
//!
//! - [`robot`] has no unknowns and no measured data: names, limits and readings never change in a fit.
//! - [`measurement`] is given the pose of a target, and sees no joints, screws or parameters.
//! - [`camera`] gets corners and returns poses; it has no robots and no rows of a session.
//! - [`forms`] returns frames and rows of tables from a robot, and writes no files.
//! - [`offsets`] compares two robots, without measurements.
//!
//! Not here: unknowns, fits, files.

#![forbid(unsafe_code)]

pub mod camera;
pub mod forms;
pub mod measurement;
pub mod offsets;
pub mod robot;
pub mod simulate;
