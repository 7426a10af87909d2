//! Robot models in files: URDF, MJCF, SDF, TOML and files of makers, with the proof that a written model is the robot.
//!
//! This crate is a part of [poecal](https://docs.rs/poecal), for the other parts, the program and the package. Its interface follows their needs
//! and promises nothing by itself.
//!
//! An existing URDF is patched in place, never rewritten. A form of [`foreign`] becomes links and joints, and the equivalent URDF is then read and
//! written as any other. [`proof`] compares a written model with the robot.
//!
//! Other crates have measurements, calibrations (`poecal-results` has `calibration.json`), and output folders.

#![forbid(unsafe_code)]

pub mod abb;
pub mod foreign;
pub mod logo;
pub mod mimic;
pub mod motors;
pub mod proof;
pub mod robot_toml;
mod unread_elements;
pub mod urdf;
