//! Containers of bytes: records of MCAP, and streams of old office programs.

pub mod fields;
#[cfg(feature = "bags")]
pub mod mcap;
#[cfg(feature = "workbooks")]
pub mod office;
#[cfg(feature = "bags")]
pub mod unpack;
