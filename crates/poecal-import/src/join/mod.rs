//! Two files as one session: which line belongs to which, by names, order, time or motion.

pub(crate) mod beside;
pub(crate) mod join_doubt;
pub(crate) mod join_entry;
pub(crate) mod join_judgement;
pub(crate) mod join_lags;
pub(crate) mod join_motion;
pub(crate) mod join_order;
pub(crate) mod join_pairs;
pub(crate) mod join_plan;
pub(crate) mod join_words;
pub(crate) mod missing_columns;
pub(crate) mod motions;
pub(crate) mod no_file_for;
pub(crate) mod no_stands;
pub(crate) mod set_choice;
pub(crate) mod shifted_header;
pub(crate) mod stand_means;
pub(crate) mod streams;
pub(crate) mod unused;
pub(crate) mod witness;
