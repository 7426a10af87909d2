//! A calibration judged by other measurements.

pub(crate) mod arm_too;
mod gain;
pub(crate) mod judge;
