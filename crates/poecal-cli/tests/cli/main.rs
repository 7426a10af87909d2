//! The program as users run it.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

mod bad_input;
mod commands;
mod diagnosis;
mod exit_codes;
mod folder;
mod hostile;
mod identify;
mod init;
mod lost_beams;
mod offsets;
#[cfg(unix)]
mod places;
mod report;
mod reproduce;
mod session;
mod stations;
mod table;
mod targets_and_validation;
mod trust;
mod validate;
