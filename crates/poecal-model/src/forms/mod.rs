//! A robot in other parameterisations of the same motions: frames with z along each axis, and tables of Denavit and Hartenberg, Craig, and
//! Hayati.

mod dh;
mod frames;

pub use dh::{DhConvention, DhEntry, DhTable, RowKind};
pub use frames::AxisFrames;
