//! Text files read whole, and byte offsets as lines and columns.

use std::io::Read as _;
use std::path::Path;

use super::source;
use crate::error::{Error, ErrorKind, Result};

/// The text of a file; `expected` describes it in messages.
///
/// # Errors
/// [`ErrorKind::File`] if it is a directory, missing, unreadable, too large, empty or not UTF-8.
pub(super) fn read(path: &Path, expected: &str) -> Result<String> {
    read_up_to(path, expected, source::LARGEST_TEXT)
}

/// [`read()`], with another largest size.
pub(super) fn read_up_to(path: &Path, expected: &str, largest: u64) -> Result<String> {
    let mut bytes = Vec::new();
    source::open(path, expected, largest)?
        .read_to_end(&mut bytes)
        .map_err(|error| source::unreadable(path, &error, expected))?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let message = format!("found bytes that are not UTF-8, expected {expected} as UTF-8 text");
        let text = String::from_utf8_lossy(error.as_bytes());
        Error::new(ErrorKind::File, message).at_offset(path, &text, valid)
    })?;
    if text.trim_start_matches('\u{feff}').trim().is_empty() {
        let message = format!("the file is empty, expected {expected}");
        return Err(Error::new(ErrorKind::File, message).in_file(path));
    }
    Ok(text)
}

impl Error {
    /// The same error at a byte offset of a file's text.
    pub(in crate::io) fn at_offset(self, path: &Path, text: &str, offset: usize) -> Self {
        let (line, column) = position(text, offset);
        self.at(path, line, column)
    }
}

/// Line and column (from 1, the column in characters) of a byte offset.
pub(super) fn position(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = before.matches('\n').count() + 1;
    (line, before.get(line_start..).unwrap_or("").trim_start_matches('\u{feff}').chars().count() + 1)
}

#[cfg(test)]
mod tests {
    use super::position;

    #[test]
    fn positions_count_characters_from_one() {
        assert_eq!(position("ab\r\nµm x", 0), (1, 1));
        assert_eq!(position("ab\r\nµm x", 7), (2, 3));
        assert_eq!(position("\u{feff}ab", 4), (1, 2));
        assert_eq!(position("ab", 99), (1, 3));
    }
}
