//! The hot path of a fit: several rows at a time, by vector instructions.
mod batch;
mod columns;
mod corners;
mod dense;
mod errors;
mod frame;
mod gram;
mod influence;
mod kernel;
mod plan;
mod rows;
mod shape;
mod simd;
mod sincos;
mod tip;
mod totals;
mod turn;
mod vector;
mod work;

pub(crate) use corners::{Brown, CornerProducts, Corners, MOTIONS};
pub(crate) use dense::Factor;
pub(crate) use errors::Frames;
pub(crate) use gram::TILE;
pub(crate) use influence::NUMBERS;
pub(crate) use plan::{Along, Arm, DevicePlan, FixedMotion, JointPlan, PackedRows, Plan, RowData, TermPlan};
pub(crate) use rows::{Shape, ShapedRow};
pub use simd::{SimdLevel, simd_levels, stated_level};
pub(crate) use simd::{
    by_best, cholesky, corner_products, cosines_and_sines, errors, influences, inverse, last_links, solve,
    sum_gradient, sum_plain_gradient, sum_plain_products, sum_products, whitened_columns,
};
pub(crate) use totals::{Tiles, Totals};
pub(crate) use vector::{WIDTH, Wide};
