//! Tests of this crate's interface: one program, since linking it once takes less time than linking one for each subject.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

mod camera_keys;
mod components;
mod controllers;
mod drawing;
mod foreign_corners;
mod foreign_messages;
mod mapping_errors;
mod mapping_forms;
mod mapping_guess;
mod measurement_choices;
mod measurement_errors;
mod measurement_forms;
mod measurement_long;
mod motion;
mod other_tools;
mod shop;
mod stands;
