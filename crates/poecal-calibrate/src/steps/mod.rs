//! The steps of a calibration in order, and their results.
//!
//! `calibrate.rs` calls the steps, each once, in order, and has no formulas. These are `calibrated_fit.rs` (the fit, a loop if several instruments have
//! noises of their own), `corrected_fit.rs` (a loop if the corrected model suspects other rows than geometry), `tolerance.rs` (a loop over fits and their
//! cross-validations), and `assess.rs` (the judgement of the fit, once; figures by `figures.rs`, the level with its reasons by `verdict.rs`).

pub(crate) mod assess;
pub(crate) mod calibrate;
pub(crate) mod calibrated_fit;
pub(crate) mod changes;
pub(crate) mod corrected_fit;
pub(crate) mod figures;
pub(crate) mod fit_progress;
pub(crate) mod improvement;
pub(crate) mod joint_correlations;
pub(crate) mod judging_rows;
pub(crate) mod level;
pub(crate) mod limit_checks;
pub(crate) mod repeatability;
pub(crate) mod result;
pub(crate) mod summary;
pub(crate) mod tolerance;
pub(crate) mod trust;
pub(crate) mod verdict;
