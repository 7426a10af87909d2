//! Stored results: calibration.json, residuals, predictions, exports, validation, visits, comparisons and output folders.
//!
//! A part of [poecal](https://docs.rs/poecal), for the other parts, the program and the package: its interface follows their needs and promises
//! nothing by itself.
//!
//! [`calibration_file`] has the corrected model as an entry whose parts replace those of the file, so that predictions and judgements have one code
//! for both models. [`output`] writes all files of a run or none, and compares written models with the fit. [`compare`] and [`track`] return numbers
//! and single sentences, which `poecal-report` shows.
//!
//! Not here: the fit and its judgement (`poecal-calibrate`), tables and HTML for people (`poecal-report`).

#![forbid(unsafe_code)]

pub mod calibration_file;
pub mod compare;
pub mod export;
pub mod fleet;
pub mod frame_entries;
pub mod frame_texts;
pub mod hand_eye;
pub mod iso9283;
pub mod lens_entries;
pub mod model;
pub mod offsets;
pub mod output;
pub mod plan_program;
pub mod predictions;
pub mod programs;
pub mod record;
pub mod renamed_words;
pub mod residuals;
pub mod settings;
pub mod shapes;
pub mod tcp;
pub mod track;
pub mod validation;
