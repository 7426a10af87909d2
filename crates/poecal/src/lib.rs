//! Kinematic calibration of robot arms, and of trees of them, by the product of exponentials.
//!
//! For programs in Rust. Public items here follow semantic versioning. This crate has no code of its own, which is in the parts, and nothing that
//! only the program or the Python package needs of them.
//!
//! A robot is a screw `ξᵢ` for every joint and a home pose `M`. With joint values `θ`, the pose of its tip in the base frame is
//!
//! ```text
//! base_from_tip(θ) = exp(ξ₁θ₁) exp(ξ₂θ₂) … exp(ξₙθₙ) M
//! ```
//!
//! A real robot's screws have small errors. A device at an unknown position measures the tool, as points or poses: [`calibrate`] fits the screws, the
//! tool and the device frame to these measurements.
//!
//! ```
//! use poecal::simulate::elbow;
//! use poecal::{CalibrationOptions, SessionKind, Simulation, calibrate};
//!
//! // A six-axis arm whose axes are off by 1° and 2 mm, and 60 points of its tip with noise of 0.05 mm from a tracker anywhere.
//! let made = Simulation { count: 60, ..Simulation::default() }.run(&elbow(), SessionKind::POINT)?;
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
//! # Contents
//!
//! | to | there is |
//! |---|---|
//! | describe a robot | [`Robot`], [`Joint`], [`JointKind`], [`JointLimits`], [`Reading`], [`Tolerance`]; [`Model`] and [`ChainSelection`] read it from URDF, MJCF, SDF, TOML, makers' files or a calibration |
//! | state measurements | [`Dataset`], [`Observation`], [`Measurement`], [`Noise`], [`Set`]; [`read_measurements`] with [`ReadOptions`] returns a [`MeasurementFile`] |
//! | calibrate | [`calibrate`] with [`CalibrationOptions`] ([`DeviceFrameKnowledge`], [`RobustLoss`], [`Loss`], [`Formulation`]) returns a [`Calibration`] with its [`CalibratedTarget`]s |
//! | assess it | [`Accuracy`] ([`SetAccuracy`], [`ModelAccuracy`], [`Statistic`]), [`Verdict`], [`Trust`], [`Identifiability`] ([`Direction`]), [`Diagnosis`] of mistakes in the input |
//! | judge it by other measurements | [`judge`], which returns a [`Judgement`] |
//! | predict | [`Robot::forward_kinematics`]; [`predict_readings`], which returns [`PredictedPoses`] poses in a [`PredictionFrame`] with their uncertainty |
//! | plan a session | [`identify`] a [`PlannedSession`], which returns a [`ExpectedUncertainty`] |
//! | hand it on | [`CalibrationFile`] with its [`Inputs`], [`Residuals`], [`ModelFormat`], [`calibration_page`] (the report), [`summary`] (the table) |
//! | try it without a robot | [`Simulation`], [`SimulationResult`], [`SessionKind`] and the robots of [`simulate`] |
//! | compute with poses | [`lie`]: poses, twists, screws |
//! | solve other least squares | [`solve`]: Levenberg-Marquardt on a manifold, which knows no robots |
//!
//! Every failure is reported by [`Error`] with an [`ErrorKind`].
//!
//! Lengths are in metres and angles in radians, a twist is `(v; ω)`, `a_from_b` transforms coordinates in b to coordinates in a. The formulas are in
//! `docs/theory.md`, the conventions in `docs/conventions.md`, the crates and their permitted imports in `ARCHITECTURE.md`. This crate re-exports the
//! items that users need of its parts (`poecal-model`, `poecal-fit`, `poecal-calibrate` and others, all of the same version), whose interfaces change
//! without notice.

#![forbid(unsafe_code)]

pub use poecal_arm::{AllBranches, Arm, Branches, HeldBranches, lie};
pub use poecal_calibrate::{
    Accuracy, CalibratedTarget, Calibration, CalibrationOptions, DeviceFrameKnowledge, Formulation, Judgement, Loss,
    ModelAccuracy, RobustLoss, SetAccuracy, Statistic, Trust, Verdict, calibrate, judge,
};
pub use poecal_fit::analysis::{Direction, ExpectedUncertainty, Identifiability, PlannedSession, identify};
pub use poecal_fit::forensics::Diagnosis;
pub use poecal_formats::urdf::ChainSelection;
pub use poecal_import::{MeasurementFile, ReadOptions, read as read_measurements};
pub use poecal_model::measurement::{
    Dataset, MeasuredQuantities, Measurement, Noise, Observation, Quantity, SessionKind, Set,
};
pub use poecal_model::robot::{Joint, JointKind, JointLimits, Reading, Robot, Tolerance};
pub use poecal_model::simulate::{Simulation, SimulationResult};
pub use poecal_numerics::error::{Choices, Error, ErrorKind, Result};
pub use poecal_report::{calibration_page, summary};
pub use poecal_results::calibration_file::{CalibrationFile, Inputs};
pub use poecal_results::model::{Model, ModelFormat, ModelSource};
pub use poecal_results::predictions::{PredictedPoses, PredictionFrame, predict_readings};
pub use poecal_results::residuals::Residuals;

#[doc(inline)]
pub use poecal_model::simulate;
#[doc(inline)]
pub use poecal_numerics::solve;

/// The example of the README is compiled with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
