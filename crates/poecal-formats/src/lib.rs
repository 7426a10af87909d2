//! Robot models in files: URDF, MJCF, SDF, TOML and files of makers, with the proof that a written model is the robot.
//!
//! A part of [poecal](https://docs.rs/poecal), for the other parts, the program and the package: its interface follows their needs and promises
//! nothing by itself.
//!
//! A URDF is patched in place, never written anew where there is one. A form of [`foreign`] becomes links and joints, and the URDF that is equal to
//! them is then read and written as any other. [`proof`] compares what was written with the robot.
//!
//! Not here: measurements, calibrations (`poecal-results` has `calibration.json`), and output folders.

#![forbid(unsafe_code)]

pub mod abb;
pub mod foreign;
pub mod logo;
pub mod mimic;
pub mod proof;
pub mod robot_toml;
mod unread;
pub mod urdf;
