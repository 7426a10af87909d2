//! Behaviour of this crate, tested from outside: one program, since linking it once takes less than linking one for each subject.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

mod arms;
mod determinism;
mod field;
mod iso9283;
mod programs;
mod singular;
mod taught;
mod two_arms;
