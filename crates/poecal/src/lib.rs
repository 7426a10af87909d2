//! Kinematic calibration of robot arms, and of trees of them, by the product of exponentials.
//!
//! A robot is a screw `ξᵢ` for every joint and a home pose `M`. With joint values `θ`, its tip stands in the base frame at
//!
//! ```text
//! base_from_tip(θ) = exp(ξ₁θ₁) exp(ξ₂θ₂) … exp(ξₙθₙ) M
//! ```
//!
//! A real robot's screws are a little off. A device at an unknown place measures the tool, as points or poses: [`calibrate`] fits the
//! screws, the tool and the device frame to these measurements.
//!
//! ```
//! use poecal::simulate::elbow;
//! use poecal::{CalibrationOptions, Kind, Simulation, calibrate};
//!
//! // A six-axis arm whose axes are off by 1° and 2 mm, and 60 points of its tip with noise of 0.05 mm from a tracker anywhere.
//! let made = Simulation { count: 60, ..Simulation::default() }.run(&elbow(), Kind::POINT)?;
//! let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
//!
//! // 30 % of the points were held out: their error is the noise of 0.05 mm in each of three coordinates.
//! let held_out = calibration.accuracy.held_out.ok_or("no rows were held out")?;
//! assert!(held_out.registered.position_mm().rms > 10.0);
//! assert!(held_out.calibrated.position_mm().rms < 0.15);
//!
//! // The calibrated robot is a robot like any other.
//! let tip = calibration.robot.forward_kinematics(&[0.0, -0.5, 0.5, 0.0, 1.0, 0.0]);
//! assert!((tip.translation - elbow().forward_kinematics(&[0.0, -0.5, 0.5, 0.0, 1.0, 0.0]).translation).norm() < 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What is here
//!
//! | to | there is |
//! |---|---|
//! | describe a robot | [`Robot`], [`Joint`], [`JointKind`], [`Limits`], [`Reading`], [`Tolerance`]; [`Model`] and [`ChainSelection`] read it from URDF, MJCF, SDF, TOML, makers' files or a calibration |
//! | say what was measured | [`Dataset`], [`Observation`], [`Measurement`], [`Noise`], [`Set`]; [`read_measurements`] with [`ReadOptions`] gives a [`MeasurementFile`] |
//! | calibrate | [`calibrate`] with [`CalibrationOptions`] ([`DeviceFrameKnowledge`], [`Robust`], [`Loss`], [`Formulation`]) gives a [`Calibration`] with its [`CalibratedTarget`]s |
//! | know how good it is | [`Accuracy`] ([`SetAccuracy`], [`ModelAccuracy`], [`Statistic`]), [`Verdict`], [`Trust`], [`Identifiability`] ([`Direction`]), [`Diagnosis`] of mistakes in the input |
//! | judge it by other measurements | [`judge`], which gives a [`Judgement`] |
//! | predict | [`Robot::forward_kinematics`]; [`predicted`], which gives [`Predicted`] poses in a [`PredictionFrame`] with their uncertainty |
//! | plan a session | [`identify`] a [`PlannedSession`], which gives a [`Foresight`] |
//! | hand it on | [`CalibrationFile`] with its [`Inputs`], [`Residuals`], [`ModelFormat`], [`calibration_page`] (the report), [`summary`] (the table) |
//! | try it without a robot | [`Simulation`], [`Simulated`], [`Kind`] and the robots of [`simulate`] |
//! | compute with poses | [`lie`]: poses, twists, screws |
//! | solve other least squares | [`solve`]: Levenberg-Marquardt on a manifold, which knows no robots |
//!
//! Whatever fails says so by [`Error`] with an [`ErrorKind`].
//!
//! Lengths are in metres and angles in radians, a twist is `(v; ω)`, `a_from_b` takes coordinates in b to coordinates in a. The
//! formulas stand in `docs/theory.md`, the conventions in `docs/conventions.md`, the modules and what they may import in
//! `ARCHITECTURE.md`. Modules without a place in this list are there for the program, the Python package and the tests, and change
//! without notice.

#![forbid(unsafe_code)]

// The reference of the kernels is one file for the tests of this crate and of others.
#[cfg(test)]
extern crate self as poecal;
#[cfg(test)]
#[allow(dead_code)]
#[path = "../tests/reference/mod.rs"]
mod reference;

// Hidden from readers only: for lints they are as public as they are.
#[cfg_attr(doc, doc(hidden))]
pub mod analysis;
#[cfg_attr(doc, doc(hidden))]
pub mod calibration;
#[cfg_attr(doc, doc(hidden))]
pub mod camera;
#[cfg_attr(doc, doc(hidden))]
pub mod compare;
#[cfg_attr(doc, doc(hidden))]
pub mod compensate;
mod distributions;
#[cfg_attr(doc, doc(hidden))]
pub mod error;
#[cfg_attr(doc, doc(hidden))]
pub mod estimate;
#[cfg_attr(doc, doc(hidden))]
pub mod fleet;
#[cfg_attr(doc, doc(hidden))]
pub mod forensics;
#[cfg_attr(doc, doc(hidden))]
pub mod forms;
#[cfg_attr(doc, doc(hidden))]
pub mod gauge;
#[cfg_attr(doc, doc(hidden))]
pub mod hand_eye;
#[cfg_attr(doc, doc(hidden))]
pub mod io;
mod lanes;
mod linalg;
#[cfg_attr(doc, doc(hidden))]
pub mod measurement;
#[cfg_attr(doc, doc(hidden))]
pub mod offsets;
#[cfg_attr(doc, doc(hidden))]
pub mod parameters;
#[cfg_attr(doc, doc(hidden))]
pub mod plan;
#[cfg_attr(doc, doc(hidden))]
pub mod problem;
mod programs;
#[cfg_attr(doc, doc(hidden))]
pub mod report;
#[cfg_attr(doc, doc(hidden))]
pub mod robot;
pub mod simulate;
pub mod solve;
#[cfg_attr(doc, doc(hidden))]
pub mod start;
#[cfg_attr(doc, doc(hidden))]
pub mod text;
mod threads;
#[cfg_attr(doc, doc(hidden))]
pub mod track;
#[cfg_attr(doc, doc(hidden))]
pub mod uncertainty;
mod unit;

pub use analysis::{Direction, Foresight, Identifiability, PlannedSession, identify};
pub use calibration::{
    Accuracy, CalibratedTarget, Calibration, CalibrationOptions, DeviceFrameKnowledge, Formulation,
    Judgement, Loss, ModelAccuracy, Robust, SetAccuracy, Statistic, Trust, Verdict, calibrate, judge,
};
pub use error::{Choices, Error, ErrorKind, Result};
pub use forensics::Diagnosis;
pub use io::calibration_file::{CalibrationFile, Inputs};
pub use io::measurements::{MeasurementFile, ReadOptions, read as read_measurements};
pub use io::model::{Model, ModelFormat, ModelSource};
pub use io::predictions::{Predicted, PredictionFrame, predicted};
pub use io::residuals::Residuals;
pub use io::urdf::ChainSelection;
pub use measurement::{Dataset, Kind, Measured, Measurement, Noise, Observation, Quantity, Set};
pub use report::{calibration_page, summary};
pub use robot::{Joint, JointKind, Limits, Reading, Robot, Tolerance};
pub use simulate::{Simulated, Simulation};

#[doc(inline)]
pub use poecal_arm::lie;
#[doc(inline)]
pub use poecal_arm::{AllBranches, Arm, Branches, HeldBranches};

#[doc(hidden)]
pub use error::nearest;
#[doc(hidden)]
pub use measurement::ByQuantity;
#[doc(hidden)]
pub use poecal_arm as arm;
#[doc(hidden)]
pub use threads::{MOST_THREADS, threads_now};
#[doc(hidden)]
pub use unit::Unit;

/// The example of the README is compiled with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
