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

#[cfg(test)]
mod tests {
    use super::sha256;

    #[test]
    fn the_digest_of_abc_is_that_of_the_standard() {
        let path = std::env::temp_dir().join(format!("poecal_hash_{}", std::process::id()));
        std::fs::write(&path, "abc").unwrap();
        let digest = sha256(&path);
        std::fs::remove_file(&path).unwrap();
        // FIPS 180-2, appendix B.1.
        assert_eq!(digest.unwrap(), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }
}
