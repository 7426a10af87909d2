//! Shared parts of the tests of several crates: numbers of trials, folders, sessions, and the files of `data/`.
//!
//! Not published.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

pub mod damage;
pub mod files;
pub mod largest;
pub mod old_workbook;
#[cfg(feature = "sessions")]
pub mod sessions;
pub mod trials;
