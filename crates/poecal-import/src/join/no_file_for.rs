//! What is said of options that concern forms of files of which there is none.

use poecal_numerics::error::{Error, ErrorKind};

/// What `--body` is for.
pub(crate) const BODIES: &str = "a recording of bodies or markers with names";

/// The error of an option that concerns a form of files of which there is none.
pub(crate) fn unused(option: &str, what: &str) -> Error {
    ErrorKind::Option
        .error(format!("found {option} and no file that it is for, expected {what}: leave the option out"))
}
