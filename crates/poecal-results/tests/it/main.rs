//! Public behaviour of this crate: one program, since linking it once takes less than linking one for each subject.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

mod blocks;
mod calibration_file;
mod corrections;
mod documented_files;
mod export;
mod fk_reference;
mod foreign_models;
mod masses;
mod mixed_cell;
mod model_convert;
mod model_errors;
mod open_zeros;
mod optics;
mod pictures;
mod refit_promise;
mod robust;
mod shapes;
mod tip_bounds;
mod track;
mod tree_models;
