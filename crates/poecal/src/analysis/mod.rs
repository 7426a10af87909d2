//! What the measurements can tell and what they cannot. Nothing is printed here.

mod causes;
mod coverage;
mod direction;
mod excitation;
mod identifiability;
mod identify;
mod influence;
mod observability;
mod remainder;
mod setup;
mod spectrum;
mod subspace;

pub use coverage::{JointCoverage, coverage};
pub(crate) use coverage::{inside, ranges};
pub use direction::{Cause, Direction};
pub use identifiability::{Identifiability, identifiability, residual_variance, unknowns_told};
pub use identify::{ExpectedError, Foresight, Session, identify};
pub use influence::{Influence, influence};
pub use observability::Observability;
pub use setup::Setup;
pub(crate) use spectrum::PLAUSIBLE;
pub use spectrum::Spectrum;
