//! Which configurations to measure, rows judged while they are measured, and the capability of many robots.
//!
//! A part of [poecal](https://docs.rs/poecal), for the other parts, the program and the package: its interface follows their needs and promises
//! nothing by itself.
//!
//! [`plan`] has no fits of its own beside the one while rows arrive: its unknowns, priors and terms are those of `poecal-fit` and `poecal-calibrate`.
//! [`fleet`] gets figures of robots with their deviations, no robots.
//!
//! Not here: files; tables and reports.

#![forbid(unsafe_code)]

pub mod fleet;
pub mod plan;
