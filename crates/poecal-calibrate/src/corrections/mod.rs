//! Real joint effects beyond geometry: terms of joint values and of bearings, fitted together with the screws under priors (theory.md §6).
//!
//! `context.rs` holds their inputs, `linear.rs` the rows as linear functions of all unknowns, and `choice.rs` chooses the sizes of priors from them.
//! `fit.rs` is the fit with these, `frames.rs` its base and tip; `degradation.rs` drops the terms if they predict rows worse. `predictive_covariance.rs` is their
//! uncertainty, `effects.rs` their effects at each joint.

mod choice;
mod context;
mod correction_fit;
mod degradation;
mod effect;
mod effects;
mod fit;
mod frames;
mod gravity;
mod linear;
mod matrices;
mod modes;
mod predictive_covariance;
mod row_folds;
mod suspected_rows;
mod unknowns;

pub(crate) use choice::weight_of_prior;
pub use choice::{SizesReason, TriedSizes};
pub use correction_fit::{CorrectedFit, Correction};
pub use effect::{Effects, JointEffect, JointErrorPart, JointErrors};
pub(crate) use fit::fit_corrected;
pub use linear::whitened_rows;
pub(crate) use matrices::{ROUNDING_OF_TERMS, cholesky, solve_factored};
pub(crate) use unknowns::priors;
pub use unknowns::unknowns;
