//! Unknowns that the measurements determine: rank, undetermined directions, coverage, leverage.

mod causes;
mod coverage;
mod direction;
mod excitation;
mod identifiability;
mod identify;
mod influence;
mod observability;
mod open_offsets;
mod other_causes;
mod setup;
mod spectrum;
mod subspace;
mod unseen;
mod ways;

pub use coverage::{JointCoverage, coverage, inside, ranges, within_sampled};
pub use direction::{Cause, Direction};
pub use identifiability::{Identifiability, effective_unknowns, identifiability, residual_variance};
pub use identify::{
    ExpectedError, Foresight, MeasuredPictures, PlannedSession, identify, identify_measured, predicted_data,
};
pub use influence::{Influence, influence};
pub use observability::Observability;
pub use setup::Setup;
pub use spectrum::{PLAUSIBLE, Spectrum};
pub use ways::{Way, ways};
