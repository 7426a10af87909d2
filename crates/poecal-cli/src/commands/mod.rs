//! The commands, one a file.

mod calibrate;
mod simulate;

pub(crate) use calibrate::calibrate;
pub(crate) use simulate::simulate;
