//! Errors of specifications and files.

use std::fmt;

/// A result with the error of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Error message of one sentence: the found and the expected, with the path of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    message: String,
}

impl Error {
    pub(crate) fn new(message: impl Into<String>) -> Self {
        // Some messages of other crates have several lines.
        let message: String = message.into();
        Error { message: message.split_whitespace().collect::<Vec<_>>().join(" ") }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.message)
    }
}

impl std::error::Error for Error {}
