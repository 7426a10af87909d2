//! Two files as one session: pairs of lines, by names, order, time or motion.
//!
//! `join_plan.rs` finds the files with joint readings only and those with measurements only. `read/joining.rs` reads the measurements twice, first
//! without readings. `join_pairs.rs` pairs them by names or by their order, and reports it. Recordings in time are first reduced to the robot's
//! static intervals (`poecal-fit`'s `pairing`). The robot decides whether pairs are right (`poecal-fit`'s `start/pairing`). Each line of the measurements then
//! has its readings, and all else proceeds as if one file had both. `set_choice.rs` and `shifted_header.rs` use the robot to determine which of two
//! sets was measured, and whether names are above their values. `join_entry.rs` keeps the record for `calibration.json` and
//! the report.

pub(crate) mod input_roles;
pub(crate) mod join_entry;
pub(crate) mod join_judgement;
pub(crate) mod join_lags;
pub(crate) mod join_motion;
pub(crate) mod join_order;
pub(crate) mod join_pairs;
pub(crate) mod join_plan;
pub(crate) mod join_words;
pub(crate) mod missing_columns;
pub(crate) mod missing_forms;
pub(crate) mod missing_intervals;
pub(crate) mod set_choice;
pub(crate) mod shifted_header;
pub(crate) mod unused_options;
pub(crate) mod witness;
