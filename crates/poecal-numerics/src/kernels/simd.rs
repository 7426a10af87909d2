//! Run-time dispatch: the same source compiled for each set of vector instructions.

use std::sync::LazyLock;

use pulp::Scalar128b;
#[cfg(target_arch = "aarch64")]
use pulp::aarch64::Neon;
#[cfg(target_arch = "wasm32")]
use pulp::wasm::Simd128;
#[cfg(target_arch = "x86_64")]
use pulp::x86::{V3, V3_512b, V4};

use super::corners::{self, BrownConrady, CornerProducts, Corners};
use super::dense::{self, Factor};
use super::errors::{self, FrameColumns};
use super::influence::{self, NUMBERS};
use super::plan::{ArmAtEstimate, FixedMotion};
use super::totals::PassTotals;
use super::vector::LaneBlock;
use super::{columns, kernel, sincos, tip};

/// Instruction set of the kernels. A value of this type proves that this machine has it.
#[derive(Clone, Copy, Debug)]
pub enum SimdLevel {
    /// AVX-512: eight numbers at a time.
    #[cfg(target_arch = "x86_64")]
    Avx512(V4),
    /// AVX2 with FMA: four numbers at a time.
    #[cfg(target_arch = "x86_64")]
    Avx2(V3),
    /// AVX2 with FMA, written for eight numbers at a time: slower, for tests of this width without AVX-512.
    #[cfg(target_arch = "x86_64")]
    Avx2Wide(V3_512b),
    /// NEON: two numbers at a time.
    #[cfg(target_arch = "aarch64")]
    Neon(Neon),
    /// WebAssembly's vectors: two numbers at a time.
    #[cfg(target_arch = "wasm32")]
    Simd128(Simd128),
    /// Instructions of every machine of the target: two numbers at a time.
    Baseline(Scalar128b),
}

/// Limits the level of a process to `plain`, `avx2` or `avx512`, so that the kernels have the digits of a machine with fewer instructions.
/// Products of large matrices (matrixmultiply, by nalgebra) and functions of the C library choose for themselves.
const VARIABLE: &str = "POECAL_SIMD";

/// Level of this process; the error is that of the first use, and stays.
static LEVEL: LazyLock<Result<SimdLevel, String>> =
    LazyLock::new(|| match std::env::var_os(VARIABLE).filter(|word| !word.is_empty()) {
        None => Ok(best_detected()),
        Some(word) => limited_to(&word.to_string_lossy()),
    });

impl SimdLevel {
    /// Instructions of every machine of the target.
    pub const BASELINE: SimdLevel = SimdLevel::Baseline(Scalar128b);

    /// Level of this process: the best of this machine, or the one that the variable `POECAL_SIMD` names (`plain`, `avx2`, `avx512`). An
    /// unknown name, or the name of an absent level, has no effect; [`stated_level`] refuses it.
    #[must_use]
    pub fn best_level() -> Self {
        LEVEL.as_ref().copied().unwrap_or_else(|_| best_detected())
    }

    /// Name in `POECAL_SIMD`; `None` for a level that no machine is limited to.
    #[must_use]
    pub fn name(self) -> Option<&'static str> {
        match self {
            #[cfg(target_arch = "x86_64")]
            SimdLevel::Avx512(_) => Some("avx512"),
            #[cfg(target_arch = "x86_64")]
            SimdLevel::Avx2(_) => Some("avx2"),
            #[cfg(target_arch = "x86_64")]
            SimdLevel::Avx2Wide(_) => None,
            #[cfg(target_arch = "aarch64")]
            SimdLevel::Neon(_) => Some("neon"),
            #[cfg(target_arch = "wasm32")]
            SimdLevel::Simd128(_) => Some("simd128"),
            SimdLevel::Baseline(_) => Some("plain"),
        }
    }
}

/// Level of this process, [`SimdLevel::best_level`]; the start of a process requests it before any computation.
///
/// # Errors
///
/// A sentence if the variable `POECAL_SIMD` names no level of this machine.
pub fn stated_level() -> Result<SimdLevel, &'static str> {
    LEVEL.as_ref().copied().map_err(String::as_str)
}

/// Level of this name.
fn limited_to(word: &str) -> Result<SimdLevel, String> {
    let levels = simd_levels();
    let named = levels.iter().copied().find(|level| level.name() == Some(word));
    named.ok_or_else(|| {
        let names: Vec<&str> = levels.iter().filter_map(|level| level.name()).collect();
        format!(
            "{VARIABLE}: found `{word}`, expected one of the levels of this machine ({}), or no such variable",
            names.join(", ")
        )
    })
}

/// Best level of this machine.
fn best_detected() -> SimdLevel {
    detect_level().unwrap_or(SimdLevel::BASELINE)
}

/// The best vector instructions of this machine.
#[cfg(target_arch = "x86_64")]
fn detect_level() -> Option<SimdLevel> {
    V4::try_new().map(SimdLevel::Avx512).or_else(|| V3::try_new().map(SimdLevel::Avx2))
}

/// The best vector instructions of this machine.
#[cfg(target_arch = "aarch64")]
fn detect_level() -> Option<SimdLevel> {
    Neon::try_new().map(SimdLevel::Neon)
}

/// WebAssembly's vectors, if the module was compiled for them: a module cannot query them, and one with others is refused as a whole.
#[cfg(target_arch = "wasm32")]
fn detect_level() -> Option<SimdLevel> {
    Simd128::try_new().map(SimdLevel::Simd128)
}

/// No vector instructions: the kernels are compiled for none here.
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64", target_arch = "wasm32")))]
fn detect_level() -> Option<SimdLevel> {
    None
}

/// Levels that this machine has, the best first, whatever this process is limited to.
#[must_use]
pub fn simd_levels() -> Vec<SimdLevel> {
    let mut levels = vec![best_detected()];
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = V3::try_new() {
        if matches!(levels[0], SimdLevel::Avx512(_)) {
            levels.push(SimdLevel::Avx2(avx2));
        }
        levels.push(SimdLevel::Avx2Wide(V3_512b(avx2)));
    }
    if !matches!(levels[0], SimdLevel::Baseline(_)) {
        levels.push(SimdLevel::BASELINE);
    }
    levels
}

/// Runs `work` in a function that is compiled for the best instructions of this machine, with all code inlined into it; `work` must itself
/// be marked `#[inline(always)]`. Without fused products, which the compiler never makes by itself, the bits are the same at all levels.
pub fn by_best<T>(work: impl FnOnce() -> T) -> T {
    match SimdLevel::best_level() {
        #[cfg(target_arch = "x86_64")]
        SimdLevel::Avx512(simd) => simd.vectorize(work),
        #[cfg(target_arch = "x86_64")]
        SimdLevel::Avx2(simd) => simd.vectorize(work),
        #[cfg(target_arch = "x86_64")]
        SimdLevel::Avx2Wide(simd) => simd.0.vectorize(work),
        #[cfg(target_arch = "aarch64")]
        SimdLevel::Neon(simd) => simd.vectorize(work),
        #[cfg(target_arch = "wasm32")]
        SimdLevel::Simd128(simd) => simd.vectorize(work),
        SimdLevel::Baseline(_) => work(),
    }
}

/// A value that can be used once.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64", target_arch = "wasm32"))]
struct Once;

/// Calls a kernel in a function that is compiled for the instructions of a level. Only a closure that can be called only once is
/// inlined there; another would be compiled without these instructions.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64", target_arch = "wasm32"))]
macro_rules! vectorize {
    ($level:expr, $simd:expr, $module:ident :: $name:ident ($($argument:ident),*)) => {{
        let once = Once;
        $level.vectorize(
            #[inline(always)]
            move || {
                let _used = once;
                $module::$name($simd, $($argument),*)
            },
        )
    }};
}

/// Defines a function that calls a generic kernel, compiled for the instructions of a level.
macro_rules! dispatch {
    ($(#[$doc:meta])* $module:ident :: $name:ident ($($argument:ident: $type:ty),*) $(-> $result:ty)?) => {
        $(#[$doc])*
        pub fn $name(level: SimdLevel, $($argument: $type),*) $(-> $result)? {
            match level {
                #[cfg(target_arch = "x86_64")]
                SimdLevel::Avx512(simd) => vectorize!(simd, simd, $module::$name($($argument),*)),
                #[cfg(target_arch = "x86_64")]
                SimdLevel::Avx2(simd) => vectorize!(simd, simd, $module::$name($($argument),*)),
                #[cfg(target_arch = "x86_64")]
                SimdLevel::Avx2Wide(simd) => vectorize!(simd.0, simd, $module::$name($($argument),*)),
                #[cfg(target_arch = "aarch64")]
                SimdLevel::Neon(simd) => vectorize!(simd, simd, $module::$name($($argument),*)),
                #[cfg(target_arch = "wasm32")]
                SimdLevel::Simd128(simd) => vectorize!(simd, simd, $module::$name($($argument),*)),
                SimdLevel::Baseline(simd) => $module::$name(simd, $($argument),*),
            }
        }
    };
}

dispatch!(
    /// Sums over rows, with products of columns.
    kernel::sum_products(arm: &ArmAtEstimate<'_>, blocks: &[LaneBlock]) -> PassTotals
);
dispatch!(
    /// Sums over rows, without products of columns.
    kernel::sum_gradient(arm: &ArmAtEstimate<'_>, blocks: &[LaneBlock]) -> PassTotals
);
dispatch!(
    /// Sums over the rows of a plain plan, with products of columns.
    kernel::sum_plain_products(arm: &ArmAtEstimate<'_>, blocks: &[LaneBlock]) -> PassTotals
);
dispatch!(
    /// Sums over the rows of a plain plan, without products of columns.
    kernel::sum_plain_gradient(arm: &ArmAtEstimate<'_>, blocks: &[LaneBlock]) -> PassTotals
);
dispatch!(
    /// Writes columns and residuals of the rows of one block.
    columns::whitened_columns(
        arm: &ArmAtEstimate<'_>,
        block: &[LaneBlock],
        first: usize,
        places: &[(usize, f64)],
        jacobian: &mut [[LaneBlock; NUMBERS]],
        residual: &mut [LaneBlock; NUMBERS]
    )
);
dispatch!(
    /// Products of the derivatives of the corners of one picture at a pose; with those of each corner's point if it is unknown.
    corners::corner_products(
        lens: &BrownConrady,
        pose: &FixedMotion,
        corners: &[Corners],
        with_points: bool,
        out: &mut CornerProducts
    )
);
dispatch!(
    /// Writes the frames of the last link.
    tip::last_links(joints: &[(bool, FixedMotion)], values: &[[LaneBlock; 2]], out: &mut [[LaneBlock; 4]; 3])
);
dispatch!(
    /// Writes errors of position and rotation.
    errors::errors(
        links: &[[LaneBlock; 4]; 3],
        ends: &FrameColumns,
        measured: &FrameColumns,
        framed: bool,
        out: &mut [[LaneBlock; 3]; 2]
    )
);
dispatch!(
    /// Writes `(cos, sin)` of each angle, with the same bits at every level.
    sincos::cosines_and_sines(angles: &[f64], out: &mut [(f64, f64)])
);
dispatch!(
    /// Factor of the symmetric matrix with this upper triangle (row-major `n × n`) plus `damping` on the diagonal; `None` if that is
    /// not positive definite.
    dense::cholesky(upper: &[f64], n: usize, damping: f64) -> Option<Factor>
);
dispatch!(
    /// Solves `RᵀR x = b` in place.
    dense::solve(factor: &Factor, x: &mut [f64])
);
dispatch!(
    /// The inverse (row-major) of the matrix that was factorised.
    dense::inverse(factor: &Factor) -> Vec<f64>
);
dispatch!(
    /// Trace of each row's block of the hat matrix, and square of its studentised residual (theory.md §6 (34d) and (34e)).
    influence::influences(
        factor: &Factor,
        shifts: usize,
        jacobian: &mut [[LaneBlock; NUMBERS]],
        residual: &[LaneBlock; NUMBERS],
        weight: &LaneBlock,
        least: f64
    ) -> [LaneBlock; 2]
);
