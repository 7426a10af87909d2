//! A calibration judged by other measurements.

pub(crate) mod arm_too;
mod confirmed;
mod gain;
pub(crate) mod judge;
