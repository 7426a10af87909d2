//! The program as users run it: one program of tests, since linking it once takes less than linking several.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

mod acceptance;
#[cfg(any(unix, windows))]
mod at_once;
mod bad_input;
mod board;
mod certificate;
mod checks;
mod commands;
mod compensate;
mod configurations;
mod counted;
#[cfg(any(unix, windows))]
mod detect;
mod diagnosis;
mod example;
mod exit_codes;
// These tests run its commands.
#[allow(dead_code, unreachable_pub)]
#[path = "../../../poecal-testing/src/files.rs"]
mod files;
#[cfg(any(unix, windows))]
mod fleet;
mod folder;
mod hand_eye;
mod hostile;
mod identify;
mod init;
mod joining;
mod joining_faults;
mod limits;
mod lost_beams;
mod mistaken_files;
mod offsets;
mod original_urdf;
#[cfg(any(unix, windows))]
mod photographs;
mod pictures;
#[cfg(unix)]
mod places;
mod plan;
mod project;
mod readme;
mod recorded;
mod recordings;
mod remedies;
mod repaired;
mod report;
mod reproduce;
mod session;
mod simulated_disk;
mod spatial_analyzer;
mod stations;
mod table;
mod targets_and_validation;
mod tip;
mod track;
mod trees;
mod trust;
mod validate;
mod workbook;
mod workbook_cells;
