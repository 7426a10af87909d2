//! Pictures for the head of a certificate.

use std::path::Path;

use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::disk;

/// Largest picture, bytes.
const LARGEST: u64 = 1 << 20;

/// The media type of a picture by its first bytes, and its bytes.
///
/// # Errors
/// [`ErrorKind::File`] if it cannot be read, is none of PNG, JPEG and SVG, or is larger than 1 MiB.
pub fn read(path: &Path) -> Result<(&'static str, Vec<u8>)> {
    use std::io::Read as _;
    let refused = |message: String| ErrorKind::File.error(message).in_file(path);
    let mut bytes = Vec::new();
    disk::current_disk().open(path).and_then(|file| file.take(LARGEST + 1).read_to_end(&mut bytes)).map_err(
        |error| refused(format!("the file cannot be read ({error}), expected a picture (PNG, JPEG or SVG)")),
    )?;
    if bytes.len() as u64 > LARGEST {
        return Err(refused("found more than 1 MiB, expected a picture of at most 1 MiB: make it smaller".to_owned()));
    }
    let text = || String::from_utf8_lossy(&bytes[..bytes.len().min(4096)]).contains("<svg");
    let kind = match bytes.as_slice() {
        [0x89, b'P', b'N', b'G', ..] => "image/png",
        [0xff, 0xd8, 0xff, ..] => "image/jpeg",
        _ if text() => "image/svg+xml",
        _ => return Err(refused("found no picture, expected PNG, JPEG or SVG".to_owned())),
    };
    Ok((kind, bytes))
}
