//! Which configurations to measure, rows judged while they are measured, and the capability of many robots.
//!
//! A part of [poecal](https://docs.rs/poecal): its interface follows the needs of the other parts and promises nothing by itself.

#![forbid(unsafe_code)]

pub mod fleet;
pub mod plan;
