//! Text files read whole, and byte offsets as lines and columns.

use std::io::Read as _;
use std::path::Path;

use super::limits::ResourceLimit;
use super::source;
use poecal_numerics::error::{ErrorKind, Result};

/// The text of a file; `expected` describes it in messages.
///
/// # Errors
/// [`ErrorKind::File`] if it is a directory, missing, unreadable, too large, empty or not UTF-8.
pub fn read(path: &Path, expected: &str) -> Result<String> {
    read_up_to(path, expected, ResourceLimit::Text)
}

/// [`read()`], with another limit.
pub fn read_up_to(path: &Path, expected: &str, limit: ResourceLimit) -> Result<String> {
    let mut bytes = Vec::new();
    source::open(path, expected, limit)?
        .read_to_end(&mut bytes)
        .map_err(|error| source::unreadable_error(path, &error, expected))?;
    let text = String::from_utf8(bytes).or_else(|error| latin(error.as_bytes()).ok_or(error)).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let message = format!("found bytes that are not UTF-8, expected {expected} as UTF-8 text");
        let text = String::from_utf8_lossy(error.as_bytes());
        ErrorKind::File.error(message).at_offset(path, &text, valid)
    })?;
    if text.trim_start_matches('\u{feff}').trim().is_empty() {
        return Err(ErrorKind::File.error(format!("the file is empty, expected {expected}")).in_file(path));
    }
    Ok(text)
}

/// The text of an XML file that declares ISO-8859-1 in its first line, so that each byte is a character. The result is UTF-8, and declares it.
fn latin(bytes: &[u8]) -> Option<String> {
    let end = bytes.iter().take(LONGEST_DECLARATION).position(|it| *it == b'>')?;
    let declaration = std::str::from_utf8(bytes.get(..end)?).ok().filter(|it| it.starts_with("<?xml"))?;
    let lower = declaration.to_ascii_lowercase();
    let (at, name) = LATIN.iter().find_map(|name| lower.find(name).map(|at| (at, name)))?;
    // ISO-8859-15 has other characters.
    if declaration.as_bytes().get(at + name.len()).is_none_or(u8::is_ascii_alphanumeric) {
        return None;
    }
    let rest: String = bytes.get(at + name.len()..)?.iter().map(|&it| char::from(it)).collect();
    Some(format!("{}UTF-8{rest}", declaration.get(..at)?))
}

/// Names of the encoding.
const LATIN: [&str; 3] = ["iso-8859-1", "iso_8859-1", "latin1"];
const LONGEST_DECLARATION: usize = 200;

#[cfg(test)]
mod tests {
    use super::latin;

    #[test]
    fn a_declared_latin_text_becomes_utf_8() {
        let text = b"<?xml version='1.0' encoding='ISO-8859-1'?>\n<robot name='gr\xfcn'/>";
        assert_eq!(latin(text).unwrap(), "<?xml version='1.0' encoding='UTF-8'?>\n<robot name='gr\u{fc}n'/>");
        for other in [
            &b"<robot name='gr\xfcn'/>"[..],
            b"<?xml encoding='UTF-16'?>\xff",
            b"<?xml encoding='ISO-8859-15'?>\xff",
            b"",
            b"<?xml",
        ] {
            assert_eq!(latin(other), None);
        }
    }
}
