//! Numbers without robots: vector kernels, least squares on a manifold, matrices, distributions, threads, units and the one error type.
//!
//! A part of [poecal](https://docs.rs/poecal): its interface follows the needs of the other parts and promises nothing by itself.

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
