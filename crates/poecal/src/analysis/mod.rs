//! What the measurements can tell and what they cannot. Nothing is printed here.

mod causes;
mod coverage;
mod excitation;
mod identifiability;
mod identify;
mod influence;
mod observability;
mod remainder;
mod subspace;

pub(crate) use coverage::ranges;
pub use coverage::{JointCoverage, coverage};
pub(crate) use identifiability::PLAUSIBLE;
pub use identifiability::{
    Cause, Direction, Identifiability, Setup, Spectrum, identifiability, residual_variance, unknowns_told,
};
pub use identify::{ExpectedError, Foresight, Session, identify};
pub use influence::{Influence, influence};
pub use observability::Observability;
