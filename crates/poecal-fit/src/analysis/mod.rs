//! Unknowns that the measurements determine: rank, undetermined directions, coverage, leverage.

mod causes;
mod coverage;
mod direction;
mod excitation;
mod identifiability;
mod identify;
mod influence;
mod kinematic_paths;
mod observability;
mod open_offsets;
mod other_causes;
mod setup;
mod spectrum;
mod subspace;
mod unobserved_joints;

pub use coverage::{JointCoverage, coverage, is_within_ranges, ranges, within_sampled};
pub use direction::{Cause, Direction};
pub use identifiability::{Identifiability, effective_unknowns, identifiability, residual_variance};
pub use identify::{
    ExpectedError, ExpectedUncertainty, MeasuredPictures, PlannedSession, identify, identify_measured, predicted_data,
};
pub use influence::{Influence, influence};
pub use kinematic_paths::{KinematicPath, ways};
pub use observability::Observability;
pub use setup::AnalysisSetup;
pub use spectrum::{PLAUSIBLE, Spectrum};
