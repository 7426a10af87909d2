//! A robot as a tree of joints, what is measured of it and by whom, cameras and boards, joint offsets, and simulated sessions.
//!
//! A part of [poecal](https://docs.rs/poecal): its interface follows the needs of the other parts and promises nothing by itself.

#![forbid(unsafe_code)]

pub mod camera;
pub mod forms;
pub mod measurement;
pub mod offsets;
pub mod robot;
pub mod simulate;
