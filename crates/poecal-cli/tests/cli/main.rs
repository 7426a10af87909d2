//! The program as users run it.

mod bad_input;
mod commands;
mod folder;
