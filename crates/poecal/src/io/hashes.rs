//! Checksums of input files, by which a reader can tell that a result came from the files at hand.

use std::fmt::Write as _;
use std::path::Path;

use sha2::{Digest as _, Sha256};

use crate::error::{Error, ErrorKind, Result};

/// SHA-256 of a file, as hexadecimal digits.
///
/// # Errors
/// [`ErrorKind::File`] if it cannot be read.
pub(super) fn sha256(path: &Path) -> Result<String> {
    let bytes = std::fs::read(path).map_err(|error| {
        let message =
            format!("the file cannot be read ({error}), expected an input file to take the checksum of");
        Error::new(ErrorKind::File, message).in_file(path)
    })?;
    let mut digits = String::with_capacity(64);
    for byte in Sha256::digest(bytes) {
        // Writing to a String cannot fail.
        let _ = write!(digits, "{byte:02x}");
    }
    Ok(digits)
}
