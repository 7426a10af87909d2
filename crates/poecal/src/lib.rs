//! Kinematic calibration of serial robots by the product of exponentials.
//!
//! A robot is a screw `ξᵢ` for every joint and a home pose `M`. With joint values `θ`, its tip stands in the base frame at
//!
//! ```text
//! base_from_tip(θ) = exp(ξ₁θ₁) exp(ξ₂θ₂) … exp(ξₙθₙ) M
//! ```
//!
//! A real robot's screws are a little off. A device that stands somewhere and sees the tool, as points or poses, tells by how much:
//! [`calibration::calibrate`] finds the screws, the tool and the device's frame that explain best what was measured.
//!
//! ```
//! use poecal::calibration::{CalibrationOptions, calibrate};
//! use poecal::simulate::{Kind, Simulation, elbow};
//!
//! // A six-axis arm whose axes are off by 1° and 2 mm, and 60 points of its tip with noise of 0.05 mm from a tracker anywhere.
//! let made = Simulation { count: 60, ..Simulation::default() }.run(&elbow(), Kind::Point)?;
//! let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
//!
//! // 30 % of the points were held out: 0.05 mm in each of three coordinates is what is left there.
//! let held_out = calibration.accuracy.held_out.ok_or("no rows were held out")?;
//! assert!(held_out.registered.position_mm.rms > 10.0);
//! assert!(held_out.calibrated.position_mm.rms < 0.15);
//!
//! // The calibrated robot is a robot like any other.
//! let tip = calibration.robot.forward_kinematics(&[0.0, -0.5, 0.5, 0.0, 1.0, 0.0]);
//! assert!((tip.translation - elbow().forward_kinematics(&[0.0, -0.5, 0.5, 0.0, 1.0, 0.0]).translation).norm() < 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The way of a calibration
//!
//! 1. [`io::model`] reads a robot, [`io::measurements`] what was seen of it, in SI.
//! 2. [`start`] finds the device's frame and the tool in closed form, with the screws as delivered: the *registered* model.
//! 3. [`solve`] minimises the whitened residuals over all screws, tool points and frames. [`problem`] gives it the normal information,
//!    rows of a [`measurement`] times columns of the [`parameters`].
//! 4. [`gauge`] picks, among all models that predict the same, the one nearest to nominal; [`analysis`] says what the data leave open.
//! 5. [`calibration`] judges the nominal, registered and calibrated model on fitted and on held-out rows; [`report`] tells it and
//!    [`io::output`] writes it.
//!
//! # Modules
//!
//! | module | holds |
//! |---|---|
//! | [`lie`] | poses, twists, screws: the geometry |
//! | [`robot`] | joints, home pose, forward kinematics |
//! | [`measurement`] | what a device sees: points, poses; residuals |
//! | [`simulate`] | robots and measurements with known errors |
//! | [`offsets`] | joint offsets as screws, and back |
//! | [`estimate`] | the state that a fit moves, and what a row sees of it |
//! | [`parameters`] | what may be wrong: screws, targets, device frame |
//! | [`solve`] | Levenberg-Marquardt; knows no robots |
//! | [`problem`] | rows × columns |
//! | [`analysis`], [`gauge`] | what the data determine, or would; the choice among equals |
//! | [`start`] | device frame and tool without a guess |
//! | [`forensics`] | mistakes in the input, named with evidence |
//! | [`calibration`] | all steps in order |
//! | [`report`] | the result as text |
//! | [`text`] | text from outside as people may see it |
//! | [`io`] | files: the only module that opens them |
//!
//! Lengths are in metres and angles in radians, a twist is `(v; ω)`, `a_from_b` takes coordinates in b to coordinates in a. The
//! formulas stand in `docs/theory.md`, the conventions in `docs/conventions.md`, the import directions in `ARCHITECTURE.md`.

pub mod analysis;
pub mod calibration;
mod distributions;
pub mod error;
pub mod estimate;
pub mod forensics;
pub mod gauge;
pub mod io;
mod lanes;
pub mod lie;
mod linalg;
pub mod measurement;
pub mod offsets;
pub mod parameters;
pub mod problem;
pub mod report;
pub mod robot;
pub mod simulate;
pub mod solve;
pub mod start;
pub mod text;
mod threads;
pub mod uncertainty;

pub use error::{Error, ErrorKind, Result, nearest};
pub use threads::MOST_THREADS;

/// The example of the README is compiled with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
