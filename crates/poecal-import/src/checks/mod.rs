//! Rows judged for their scale, spread and turns as they are read.

pub(crate) mod counted;
pub(crate) mod lengths;
pub(crate) mod scale;
pub(crate) mod spread;
pub(crate) mod turns;
