//! The commands, one a file.

mod calibrate;

pub(crate) use calibrate::calibrate;
