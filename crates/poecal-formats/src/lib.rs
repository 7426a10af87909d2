//! Robot models of files: URDF, MJCF, SDF, TOML and the files of makers, with the proof that a written model is the robot.
//!
//! A part of [poecal](https://docs.rs/poecal): its interface follows the needs of the other parts and promises nothing by itself.

#![forbid(unsafe_code)]

pub mod abb;
pub mod foreign;
pub mod logo;
pub mod mimic;
pub mod proof;
pub mod robot_toml;
pub mod urdf;
