//! Real joint effects beyond geometry: terms of joint values and of bearings, fitted together with the screws under priors (theory.md §6).
//!
//! `context.rs` holds their inputs, `linear.rs` the rows as linear functions of all unknowns, and `choice.rs` chooses the sizes of priors from them.
//! `fit.rs` is the fit with these, `frames.rs` its base and tip; `worse.rs` drops the terms if they predict rows worse. `promise.rs` is their
//! uncertainty, `effects.rs` their effects at each joint.

mod choice;
mod context;
mod effect;
mod effects;
mod fit;
mod found;
mod frames;
mod gravity;
mod left_out;
mod linear;
mod matrices;
mod modes;
mod promise;
mod suspects;
mod unknowns;
mod worse;

pub(crate) use choice::weight_of_prior;
pub use choice::{SizesReason, TriedSizes};
pub use effect::{Effects, JointEffect, JointErrorPart, JointErrors};
pub(crate) use fit::corrected;
pub use found::{CorrectedFit, Correction};
pub use linear::whitened_rows;
pub(crate) use matrices::{ROUNDING_OF_TERMS, cholesky, solved};
pub(crate) use unknowns::priors;
pub use unknowns::unknowns;
