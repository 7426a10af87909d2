//! The hot path of a fit: several rows at a time, by vector instructions.
mod gram;
mod kernel;
mod plain;
mod plan;
mod simd;
mod sincos;
mod turn;
mod vector;
#[cfg(target_arch = "x86_64")]
mod x86;

pub(crate) use kernel::{Totals, product};
pub(crate) use plan::{JointPlan, Plan, RowData, Rows, Step};
pub(crate) use simd::{cosines_and_sines, sum};
pub use simd::{Level, levels};
