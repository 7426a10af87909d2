//! Checksums of input files, to identify the inputs of a result.

use std::fmt::Write as _;
use std::io::{self, Read};
use std::path::Path;

use sha2::{Digest as _, Sha256};

use super::disk::{self, ObjectKind};
use super::document;
use super::source::is_standard_input;
use poecal_numerics::error::{ErrorKind, Result};

/// SHA-256 of a file, as hexadecimal digits; `None` for input that can be read only once, such as a pipe.
///
/// # Errors
/// [`ErrorKind::File`] if it cannot be read.
pub fn sha256(path: &Path) -> Result<Option<String>> {
    let disk = disk::current_disk();
    if is_standard_input(path) || disk.follow(path).is_ok_and(|found| found.kind != ObjectKind::File) {
        return Ok(None);
    }
    let read = || {
        // The checksum is over the bytes that were read before, if any.
        let file = document::reopen(path).map_or_else(|| disk.open(path), Ok)?;
        let mut file = HashingReader::new(file);
        io::copy(&mut file, &mut io::sink())?;
        Ok(Some(file.sha256()))
    };
    read().map_err(|error: io::Error| {
        ErrorKind::File
            .error(format!("the file cannot be read ({error}), expected an input file to take the checksum of"))
            .in_file(path)
    })
}

/// SHA-256 of a text, as hexadecimal digits.
pub fn sha256_of(text: &str) -> String {
    let mut hashing = HashingReader::new(io::empty());
    hashing.hasher.update(text.as_bytes());
    hashing.sha256()
}

/// A reader that computes the checksum of the bytes read.
pub struct HashingReader<R> {
    source: R,
    hasher: Sha256,
}

impl<R: Read> HashingReader<R> {
    /// Reads from `source`.
    pub fn new(source: R) -> Self {
        HashingReader { source, hasher: Sha256::new() }
    }

    /// Continues the checksum with another source.
    #[cfg(feature = "bags")]
    pub fn continue_with(self, source: R) -> Self {
        HashingReader { source, ..self }
    }

    /// SHA-256 of the bytes read so far, as hexadecimal digits.
    pub fn sha256(&self) -> String {
        let mut digits = String::with_capacity(64);
        for byte in self.hasher.clone().finalize() {
            // Writing to a String cannot fail.
            let _ = write!(digits, "{byte:02x}");
        }
        digits
    }
}

impl<R: Read> Read for HashingReader<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.source.read(into)?;
        self.hasher.update(into.get(..count).unwrap_or_default());
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digests_are_those_of_the_standard() {
        // FIPS 180-2, appendices B.1 and B.3: three bytes, and more than one block of the reader.
        let cases = [
            ("abc".to_owned(), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"),
            ("a".repeat(1_000_000), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0"),
        ];
        let path = std::env::temp_dir().join(format!("poecal_hash_{}", std::process::id()));
        for (text, expected) in cases {
            std::fs::write(&path, text).unwrap();
            assert_eq!(sha256(&path).unwrap().as_deref(), Some(expected));
        }
        std::fs::remove_file(&path).unwrap();
    }
}
