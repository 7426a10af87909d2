//! Forward and inverse kinematics of actual robot arms, by the product of exponentials. It needs no standard library, threads or
//! files, and allocates nothing once an arm is made.
//!
//! This is the lowest crate of [poecal](https://github.com/poecal/poecal), which estimates the actual arm from measurements. It is for programs
//! that move an arm, also on controllers; its public items follow semantic versioning. The standard library, files, threads, measurements, and
//! other crates of the workspace are not used here.
//!
//! | to | see |
//! |---|---|
//! | have an arm, and the pose of its tip | [`Arm`], [`Arm::forward_kinematics`] |
//! | have joints that turn more than their readings | [`ArmModel`], [`Arm::from_model`] |
//! | know the parts of joint values beyond readings, with derivatives | [`TermKind`], [`Term`] |
//! | have many poses, Jacobians, or deflections under weights | [`Arm::forward_kinematics_of`], [`Arm::jacobians_of`], [`Arm::sag_of`] |
//! | move the tip to a pose, from the current configuration | [`Arm::solve_nearest`] |
//! | correct readings of a program for the nominal arm | [`ReadingCorrections`] |
//! | know all configurations for a pose | [`AllBranches`]; of seven axes with one held, [`HeldBranches`] |
//! | compute with poses | [`lie`]: poses, twists, screws |
//!
//! Units are metres and radians, numbers are `f64`.

#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;
#[cfg(test)]
#[macro_use]
extern crate std;

mod arm;
mod arm_state;
mod branches;
mod chain;
mod correction;
pub mod lie;
mod model;
mod motions;
mod newton;
mod numbers;
mod real_chain;
mod rows;
mod small_systems;
mod terms;
pub mod trig;
mod zeros;

pub use arm::Arm;
pub use arm_state::MOST_JOINTS;
pub use branches::{AllBranches, Branches, HeldBranches, MOST_BRANCHES};
pub use correction::{CorrectionOutcome, CorrectionResidual, MaxCorrection, ReadingCorrections};
pub use model::{ArmModel, GravityTorque, JointValue, ModelJoint, NominalJoint, PulledWeight, TermCurve, Wave};
pub use terms::{GroupRow, Term, TermArgument, TermFunction, TermGroup, TermKind, TermRow};
