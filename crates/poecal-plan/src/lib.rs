//! Choice of the configurations to measure, judgement of rows during measurement, and the capability of many robots.
//!
//! A part of [poecal](https://docs.rs/poecal), for the other parts, the program and the package: its interface follows their needs and is not stable
//! by itself.
//!
//! [`plan`] has no fits of its own except the one while rows arrive: its unknowns, priors and terms are those of `poecal-fit` and `poecal-calibrate`.
//! [`fleet`] uses figures of robots with their deviations, no robots.
//!
//! This crate has no files, tables or reports.

#![forbid(unsafe_code)]

pub mod fleet;
pub mod plan;
