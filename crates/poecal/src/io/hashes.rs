//! Checksums of input files, by which a reader can tell that a result came from the files at hand.

use std::fmt::Write as _;
use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use sha2::{Digest as _, Sha256};

use crate::error::{Error, ErrorKind, Result};

/// Bytes read at a time.
const PIECE: usize = 1 << 16;

/// SHA-256 of a file, as hexadecimal digits.
///
/// # Errors
/// [`ErrorKind::File`] if it cannot be read.
pub(super) fn sha256(path: &Path) -> Result<String> {
    let digest = digest(path).map_err(|error| {
        let message =
            format!("the file cannot be read ({error}), expected an input file to take the checksum of");
        Error::new(ErrorKind::File, message).in_file(path)
    })?;
    let mut digits = String::with_capacity(64);
    for byte in digest {
        // Writing to a String cannot fail.
        let _ = write!(digits, "{byte:02x}");
    }
    Ok(digits)
}

fn digest(path: &Path) -> std::io::Result<impl IntoIterator<Item = u8>> {
    let mut file = File::open(path)?;
    let mut hasher = Sha256::new();
    let mut piece = vec![0; PIECE];
    loop {
        let count = file.read(&mut piece)?;
        if count == 0 {
            return Ok(hasher.finalize());
        }
        hasher.update(piece.get(..count).unwrap_or_default());
    }
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
