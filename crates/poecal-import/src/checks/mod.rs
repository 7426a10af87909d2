//! Rows judged for their scale, spread and turns as they are read.

pub(crate) mod counted;
pub(crate) mod turns;
