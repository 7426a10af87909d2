//! The steps of a calibration in order, and their results.

pub(crate) mod accepted;
pub(crate) mod assess;
pub(crate) mod calibrate;
pub(crate) mod calibrated;
pub(crate) mod changes;
pub(crate) mod corrected;
pub(crate) mod figures;
pub(crate) mod found;
pub(crate) mod improvement;
pub(crate) mod repeatability;
pub(crate) mod result;
pub(crate) mod summary;
pub(crate) mod together;
pub(crate) mod tolerance;
pub(crate) mod trust;
pub(crate) mod verdict;
