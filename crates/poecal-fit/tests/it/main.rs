//! Tests of this crate from outside: one program, since linking it once takes less time than linking one for each subject.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

mod bundle;
mod cell;
mod jacobians;
mod misread_pictures;
mod pairing;
#[allow(dead_code)]
#[path = "../reference/mod.rs"]
mod reference;
mod unnamed_targets;
mod zeros;
