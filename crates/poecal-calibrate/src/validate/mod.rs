//! A calibration judged by other measurements.

pub(crate) mod arm_too;
pub(crate) mod judge;
