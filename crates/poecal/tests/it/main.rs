//! Behaviour of this crate, tested from outside: one program, since linking it once takes less than linking one for each subject.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

mod facade;
mod theory;
