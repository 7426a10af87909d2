//! What tests of several crates share: numbers of trials, folders, sessions, and the files of `data/`.
//!
//! Not published.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

pub mod files;
pub mod largest;
#[cfg(feature = "sessions")]
pub mod sessions;
pub mod trials;

/// A file of `data/`.
#[must_use]
pub fn data(name: &str) -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(name)
}
