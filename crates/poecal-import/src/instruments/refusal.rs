//! Reasons why a file of a known form is not read.

use std::path::Path;

use poecal_numerics::error::{Error, ErrorKind};

/// Reason why a file of a known form is not read, and its line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Refusal {
    line: Option<usize>,
    message: String,
}

impl<T: Into<String>> From<T> for Refusal {
    fn from(message: T) -> Self {
        Refusal { line: None, message: message.into() }
    }
}

/// A line of a file.
#[derive(Clone, Copy)]
pub(crate) struct FileLine(pub(crate) usize);

impl FileLine {
    /// Refuses a file because of the line.
    pub(crate) fn refuse<T>(self, message: impl Into<String>) -> Result<T, Refusal> {
        Err(Refusal { line: Some(self.0), message: message.into() })
    }
}

impl Refusal {
    /// Refuses a file as a whole.
    pub(crate) fn refuse_whole<T>(message: impl Into<String>) -> Result<T, Self> {
        Err(message.into().into())
    }

    /// The refusal of an error without a file.
    pub(crate) fn from_error(error: &Error) -> Self {
        Refusal { line: error.place().and_then(|it| it.line), message: error.message().to_owned() }
    }

    /// The error.
    pub(crate) fn error(self, path: &Path) -> Error {
        let error = ErrorKind::Measurement.error(self.message);
        match self.line {
            Some(line) => error.at_line(path, line),
            None => error.in_file(path),
        }
    }
}
