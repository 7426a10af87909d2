//! What the measurements can tell and what they cannot. Nothing is printed here.

mod identifiability;
mod influence;

pub use identifiability::{Direction, Identifiability, identifiability};
pub use influence::{Influence, influence};
