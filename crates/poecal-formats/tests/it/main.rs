//! Tests of this crate's interface: one program, since linking it once takes less time than linking one for each subject.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

mod urdf_patch;
