//! Robot programs as raw bytes.

use std::io::Read as _;
use std::path::Path;

use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::limits::ResourceLimit;
use poecal_storage::source;

/// The bytes of a robot program, in any encoding.
///
/// # Errors
/// [`ErrorKind::File`] if it is a directory, missing, unreadable, larger than [`ResourceLimit::Program`], or empty; [`ErrorKind::Syntax`] if it is text of
/// two bytes for each letter.
pub fn read_program(path: impl AsRef<Path>) -> Result<Vec<u8>> {
    read_at(path.as_ref())
}

/// The part of reading that does not depend on the kind of path, compiled once.
fn read_at(path: &Path) -> Result<Vec<u8>> {
    let expected = "a robot program";
    let mut bytes = Vec::new();
    source::open(path, expected, ResourceLimit::Program)?
        .read_to_end(&mut bytes)
        .map_err(|error| source::unreadable_error(path, &error, expected))?;
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Err(ErrorKind::File.error("the file is empty, expected a robot program").in_file(path));
    }
    if bytes.contains(&0) {
        return Err(ErrorKind::Syntax.error("found zero bytes, expected a robot program as text with one byte for each letter of a word (ASCII, Latin-1, UTF-8): save \
                       it so").in_file(path));
    }
    Ok(bytes)
}
