//! The experiment of lou2009 with every formulation, and what became of its claims.

mod findings;

pub use findings::{
    Basin, Claim, Efficiency, Iteration, OffsetRow, PointRow, Reproduction, Run, ScrewRow, Seen, Spectrum,
};
