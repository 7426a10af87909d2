//! Reasons why a file of a known form is not read.

use std::path::Path;

use poecal_numerics::error::{Error, ErrorKind};

/// Reason why a file of a known form is not read, and its line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Refused {
    line: Option<usize>,
    message: String,
}

impl<T: Into<String>> From<T> for Refused {
    fn from(message: T) -> Self {
        Refused { line: None, message: message.into() }
    }
}

/// A line of a file.
#[derive(Clone, Copy)]
pub(crate) struct At(pub(crate) usize);

impl At {
    /// Refuses a file because of the line.
    pub(crate) fn refuse<T>(self, message: impl Into<String>) -> Result<T, Refused> {
        Err(Refused { line: Some(self.0), message: message.into() })
    }
}

impl Refused {
    /// Refuses a file as a whole.
    pub(crate) fn whole<T>(message: impl Into<String>) -> Result<T, Self> {
        Err(message.into().into())
    }

    /// The refusal of an error without a file.
    pub(crate) fn from_error(error: &Error) -> Self {
        Refused { line: error.place().and_then(|it| it.line), message: error.message().to_owned() }
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
