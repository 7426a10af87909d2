//! What is kept of a calibration: calibration.json, residuals, predictions, exports, validation, visits, comparisons and output folders.
//!
//! A part of [poecal](https://docs.rs/poecal): its interface follows the needs of the other parts and promises nothing by itself.

#![forbid(unsafe_code)]

pub mod calibration_file;
pub mod compare;
pub mod export;
pub mod fleet;
pub mod frame_entries;
pub mod frame_texts;
pub mod hand_eye;
pub mod model;
pub mod offsets;
pub mod output;
pub mod plan_program;
pub mod predictions;
pub mod programs;
pub mod record;
pub mod residuals;
pub mod settings;
pub mod shapes;
pub mod tcp;
pub mod track;
pub mod validation;
