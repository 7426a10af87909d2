//! The experiment of lou2009 with every formulation, and what became of its claims.

mod findings;
pub mod literal;
pub mod tables;

pub use findings::{
    Basin, Claim, Efficiency, Iteration, OffsetRow, PointRow, Reproduction, Run, ScrewRow, Seen, Spectrum,
};
