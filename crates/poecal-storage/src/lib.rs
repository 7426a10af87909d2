//! Files as bytes and text: a disk behind a trait, inputs with limits, CSV, XML, YAML and checksums.
//!
//! This crate is a part of [poecal](https://docs.rs/poecal), for the other parts, the program and the package. Its interface follows their needs
//! and promises nothing by itself.
//!
//! It is the only part that opens files. [`disk`] has the trait. Inputs are opened only in [`source`] (limits, standard input, files that are not
//! text), once for all questions of a command ([`document`]). Their sizes are limited in [`limits`]. Results are put in place by `poecal-results`'s
//! `output`, through the same trait.
//!
//! Other crates have robots, measurements, results, and computation beyond the numbers of a text.

#![forbid(unsafe_code)]

#[cfg(any(feature = "bags", feature = "workbooks"))]
pub mod containers;
pub mod csv_text;
pub mod disk;
pub mod document;
pub mod folder;
pub mod hashes;
pub mod limits;
pub mod looks_like;
pub mod named_files;
pub mod numbers;
pub mod other_keys;
pub mod source;
pub mod source_text;
pub mod write_locks;
pub mod xml;
pub mod yaml;
pub mod yaml_tree;

use serde::Serialize;

use poecal_numerics::error::{ErrorKind, Result};

/// The text of a file that is no model and no table; `what` describes it in messages.
///
/// # Errors
/// [`ErrorKind::File`] if it cannot be read, or is no text.
pub fn text_of(path: &std::path::Path, what: &str) -> Result<String> {
    source_text::read(path, what)
}

/// A value as the text of a JSON file; `what` describes it in messages.
pub fn json_text(value: &impl Serialize, what: &str) -> Result<String> {
    let text = serde_json::to_string_pretty(value);
    let text = text.map_err(|error| ErrorKind::Export.error(format!("the {what} cannot be written: {error}")))?;
    Ok(text + "\n")
}
