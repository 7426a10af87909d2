//! Two files as one session: which line belongs to which, by names, order, time or motion.
//!
//! `join_plan.rs` sees which files have joint readings alone and which measurements alone; `read/joining.rs` reads the measurements twice, first
//! without readings; `join_pairs.rs` pairs them by names or by their order, and says so. Recordings in time are reduced to the robot's stands before
//! (`streams.rs`). Whether pairs are right the robot decides (`poecal-fit`'s `start/pairing`). Each line of the measurements then has its readings,
//! and all else goes on as if one file had both. `set_choice.rs` and `shifted_header.rs` ask the robot which of two sets was measured, and whether
//! names stand beside their values; `join_entry.rs` and `motions.rs` keep what `calibration.json` and the report show of it.

pub(crate) mod beside;
pub(crate) mod join_entry;
pub(crate) mod join_judgement;
pub(crate) mod join_lags;
pub(crate) mod join_motion;
pub(crate) mod join_order;
pub(crate) mod join_pairs;
pub(crate) mod join_plan;
pub(crate) mod join_words;
pub(crate) mod missing_columns;
pub(crate) mod no_file_for;
pub(crate) mod no_stands;
pub(crate) mod set_choice;
pub(crate) mod shifted_header;
pub(crate) mod unused;
pub(crate) mod witness;
