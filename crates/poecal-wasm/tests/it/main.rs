//! The program on a disk in memory, as the module runs it.

#![allow(missing_docs, reason = "tests")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

mod disk;
mod runs;
