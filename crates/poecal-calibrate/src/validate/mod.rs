//! A calibration judged by other measurements.

pub(crate) mod compare_with_arm_fit;
mod confirmation;
mod gain;
pub(crate) mod judge;
