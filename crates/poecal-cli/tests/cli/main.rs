//! The program as users run it.

#![allow(clippy::unwrap_used, clippy::panic)]

mod bad_input;
mod commands;
mod diagnosis;
mod folder;
mod offsets;
mod session;
mod targets_and_validation;
