//! Errors of options for forms of files that are absent.

use poecal_numerics::error::{Error, ErrorKind};

/// Files to which `--body` applies.
pub(crate) const BODIES: &str = "a recording of bodies or markers with names";

/// The error of an option for a form of files that is absent.
pub(crate) fn unused_option_error(option: &str, what: &str) -> Error {
    ErrorKind::Option.error(format!("found {option} and no file that it is for, expected {what}: leave the option out"))
}
