//! Files: robot models, measurements, results. The only module that opens them; it computes nothing beyond units.
//!
//! A part of [poecal](https://docs.rs/poecal): its interface follows the needs of the other parts and promises nothing by itself.

#![forbid(unsafe_code)]

pub mod csv_text;
pub mod disk;
pub mod hashes;
pub mod looks_like;
pub mod named_files;
pub mod numbers;
pub mod source;
pub mod source_text;
pub mod xml;
pub mod yaml;
pub mod yaml_tree;

use serde::Serialize;

use poecal_numerics::error::{ErrorKind, Result};

/// The text of a file that is no model and no table; `what` it is, messages say.
///
/// # Errors
/// [`ErrorKind::File`] if it cannot be read, or is no text.
pub fn text_of(path: &std::path::Path, what: &str) -> Result<String> {
    source_text::read(path, what)
}

/// A value as the text of a JSON file; `what` it is, messages say.
pub fn json_text(value: &impl Serialize, what: &str) -> Result<String> {
    let text = serde_json::to_string_pretty(value);
    let text =
        text.map_err(|error| ErrorKind::Export.error(format!("the {what} cannot be written: {error}")))?;
    Ok(text + "\n")
}
