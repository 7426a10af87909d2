//! Numerics without robots: vector kernels, least squares on a manifold, matrices, distributions, threads, units and the one error type.
//!
//! A part of [poecal](https://docs.rs/poecal), for its other crates, the program and the package. Its interface follows their needs and is not
//! stable by itself.
//!
//! - [`kernels`] takes frames, columns and numbers, and is the only place that uses vectors of the processor.
//! - [`solve`] minimises over any manifold; neither poses nor units occur in it.
//! - [`linalg`] handles matrices without meaning, and is the only file that names nalgebra's factorisations.
//! - [`distributions`] handles squares and degrees of freedom, no residuals.
//! - [`text`] decides which characters are visible, whatever the text means.
//!
//! Robots, measurements, parameters and files are not here.

#![forbid(unsafe_code)]

pub mod distributions;
pub mod error;
pub mod kernels;
pub mod linalg;
pub mod named_unit;
pub mod solve;
pub mod text;
pub mod threads;
pub mod unit;
