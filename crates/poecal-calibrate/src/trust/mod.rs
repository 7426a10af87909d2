//! Trust in a calibration: expected errors, and the check of their coverage.

pub(crate) mod coverage_check;
pub(crate) mod domain;
pub(crate) mod expected_errors;
pub(crate) mod information;
pub(crate) mod nominal_errors;
