//! Tests of this crate from outside: one program, since linking it once takes less time than linking one for each subject.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

mod modern_robotics;
mod offsets;
