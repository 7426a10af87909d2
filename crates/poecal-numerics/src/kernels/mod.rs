//! The hot path of a fit: several rows at a time, by vector instructions.
//!
//! Kernels are written once, over the vectors of the library pulp (`vector.rs`): two numbers by NEON, WebAssembly or plain code, four by AVX2 with
//! FMA, eight by AVX-512. `simd.rs` compiles each kernel for each of these levels and calls the best one that the machine has. A kernel's first
//! argument, which every vector carries on, proves that the machine has the instructions; so no code is unsafe. In a kernel, functions are
//! `#[inline(always)]` and loops are plain loops: a closure, or a `map` of arrays, may not be compiled for the vector instructions, and each number
//! then costs a call.
//!
//! A kernel has no measurements and no parameters: `poecal-fit`'s `problem/fast.rs` translates a problem into a [`KernelPlan`] (its columns) and
//! [`PackedRows`] (numbers side by side), and stores the sums in their places. The kernels serve every problem:
//!
//! - points and poses: the scalar weight of a row stays a scalar, and rotation products follow from those of translation columns (theory.md
//!   §6 (28a));
//! - any other function of a target's pose: the kernel requests residual and sensitivity of each row (`shape.rs`) and multiplies all
//!   columns by these;
//! - instruments and targets on any body, rows of two configurations: the joints on the kinematic chain, where those passed backward have minus
//!   their value; an unknown that moves a target twice, or in the opposite direction, has two columns with one place, or a sign;
//! - terms of joint values: a factor of each row times the column of the value, packed again in each pass, since values depend on the state;
//! - screws in another parameterisation: columns that the rows supply, by the formulas of the caller.
//!
//! Rows are summed in fixed chunks, so that results do not depend on the number of threads; their last digits depend on the level. Two passes need no
//! `JᵀJ`: errors and residuals (`tip.rs`, `errors.rs`), and the influence of each row (`columns.rs`, `influence.rs`).

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

pub use corners::{BrownConrady, CornerProducts, Corners, MOTIONS};
pub use dense::Factor;
pub use errors::FrameColumns;
pub use gram::TILE;
pub use influence::NUMBERS;
pub use plan::{
    ArmAtEstimate, DevicePlan, FixedMotion, JointPlan, KernelPlan, PackedRows, PlaceComponent, TermPlan, UnpackedRow,
};
pub use rows::{RowFunctions, ShapedRow};
pub use simd::{
    SimdLevel, by_best, cholesky, corner_products, cosines_and_sines, errors, influences, inverse, last_links,
    simd_levels, solve, stated_level, sum_gradient, sum_plain_gradient, sum_plain_products, sum_products,
    whitened_columns,
};
pub use totals::{PassTotals, TileIndex};
pub use vector::{LaneBlock, WIDTH};
