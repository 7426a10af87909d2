//! Results as text for people. No number here that is not in the result.

mod breakdown;
mod check;
mod claims;
mod fixed;
mod identify;
mod judgement;
mod offsets;
mod outliers;
mod page;
mod plot;
mod reproduction;
mod summary;
mod table;

pub use breakdown::{breakdown_files, breakdown_table};
pub use check::{Check, SetCounts};
pub use claims::claims;
pub use identify::Identify;
pub use judgement::judgement;
pub use offsets::{Offsets, offset_ends};
pub use page::calibration_page;
pub use reproduction::reproduction_files;
pub use summary::{Detail, summary, unsaid};

use serde::Serialize;

use crate::error::{Error, ErrorKind, Result};

/// A result as JSON, with a line break at its end.
///
/// # Errors
/// [`ErrorKind::Export`] if it cannot be written as JSON.
pub fn json(result: &impl Serialize) -> Result<String> {
    let text = serde_json::to_string_pretty(result)
        .map_err(|error| Error::new(ErrorKind::Export, format!("the result cannot be written: {error}")))?;
    Ok(text + "\n")
}
