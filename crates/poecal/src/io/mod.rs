//! Files: robot models, measurements, results. The only module that opens them; it computes nothing beyond units.

pub mod abb;
pub mod calibration_file;
mod csv_text;
pub mod disk;
pub mod export;
pub mod fleet;
mod foreign;
mod frame_entries;
pub mod frame_texts;
pub mod hand_eye;
mod hashes;
mod limits;
pub mod logo;
mod looks_like;
pub mod measurements;
mod mimic;
pub mod model;
pub mod named_files;
mod numbers;
pub mod offsets;
pub mod output;
pub mod plan_program;
pub mod predictions;
pub mod programs;
mod proof;
pub mod record;
pub mod residuals;
pub mod robot_toml;
pub mod settings;
pub mod shapes;
mod source;
mod source_text;
mod stored_pictures;
pub mod tcp;
pub mod urdf;
pub mod validation;
mod xml;
mod yaml;
mod yaml_tree;

pub use proof::Difference;

use serde::Serialize;

use crate::error::{ErrorKind, Result};

/// The text of a file that is no model and no table; `what` it is, messages say.
///
/// # Errors
/// [`ErrorKind::File`] if it cannot be read, or is no text.
pub fn text_of(path: &std::path::Path, what: &str) -> Result<String> {
    source_text::read(path, what)
}

/// A value as the text of a JSON file; `what` it is, messages say.
pub(crate) fn json_text(value: &impl Serialize, what: &str) -> Result<String> {
    let text = serde_json::to_string_pretty(value);
    let text =
        text.map_err(|error| ErrorKind::Export.error(format!("the {what} cannot be written: {error}")))?;
    Ok(text + "\n")
}
