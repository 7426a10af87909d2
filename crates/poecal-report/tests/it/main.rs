//! Public behaviour of this crate: one program, since linking it once takes less than linking one for each subject.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

mod compared;
mod compensation_map;
mod quantities;
mod report_charts;
mod report_page;
mod report_places;
