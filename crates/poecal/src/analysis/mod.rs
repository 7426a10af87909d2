//! What the measurements can tell and what they cannot. Nothing is printed here.

mod identifiability;

pub use identifiability::{Direction, Identifiability, identifiability};
