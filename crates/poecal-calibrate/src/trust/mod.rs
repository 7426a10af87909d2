//! Trust in a calibration: expected errors, and the check of their coverage.

pub(crate) mod coverage_check;
pub(crate) mod domain;
pub(crate) mod expected;
pub(crate) mod information;
pub(crate) mod nominal;
