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

pub use corners::{Brown, CornerProducts, Corners, MOTIONS};
pub use dense::Factor;
pub use errors::Frames;
pub use gram::TILE;
pub use influence::NUMBERS;
pub use plan::{Along, Arm, DevicePlan, FixedMotion, JointPlan, PackedRows, Plan, RowData, TermPlan};
pub use rows::{Shape, ShapedRow};
pub use simd::{
    SimdLevel, by_best, cholesky, corner_products, cosines_and_sines, errors, influences, inverse,
    last_links, simd_levels, solve, stated_level, sum_gradient, sum_plain_gradient, sum_plain_products,
    sum_products, whitened_columns,
};
pub use totals::{Tiles, Totals};
pub use vector::{WIDTH, Wide};
