//! Run-time dispatch: the same source compiled for each set of vector instructions. The only unsafe code of the library.

use super::columns;
use super::dense::{self, Factor};
use super::errors::{self, Frames};
use super::influence::{self, NUMBERS};
use super::kernel;
#[cfg(target_arch = "x86_64")]
use super::plain::Pair;
use super::plain::Two;
use super::plan::{Arm, FixedMotion};
use super::poses::{self, Exponential};
use super::sincos;
use super::tip;
use super::totals::Totals;
use super::vector::Wide;
#[cfg(target_arch = "x86_64")]
use super::x86::{Eight, Four};

/// Instruction set of the kernels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SimdLevel {
    /// Instructions of every machine of the target: two numbers at a time.
    Baseline,
    /// AVX2 with FMA: four numbers at a time.
    Avx2,
    /// AVX2 with FMA, written for eight numbers at a time: slower, for tests of this width without AVX-512.
    Avx2Wide,
    /// AVX-512: eight numbers at a time.
    Avx512,
}

impl SimdLevel {
    /// The best level of this machine.
    #[must_use]
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if SimdLevel::Avx512.is_here() {
                return SimdLevel::Avx512;
            }
            if SimdLevel::Avx2.is_here() {
                return SimdLevel::Avx2;
            }
        }
        SimdLevel::Baseline
    }

    /// Whether this machine has the instructions.
    fn is_here(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        {
            let avx2 = || is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
            match self {
                SimdLevel::Baseline => true,
                SimdLevel::Avx2 | SimdLevel::Avx2Wide => avx2(),
                SimdLevel::Avx512 => is_x86_feature_detected!("avx512f") && avx2(),
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            self == SimdLevel::Baseline
        }
    }
}

/// Levels that this machine has, the best first.
#[must_use]
pub fn simd_levels() -> Vec<SimdLevel> {
    let all = [SimdLevel::Avx512, SimdLevel::Avx2, SimdLevel::Avx2Wide, SimdLevel::Baseline];
    all.into_iter().filter(|level| level.is_here()).collect()
}

/// Defines a function that calls a generic kernel, compiled for the instructions of a level.
macro_rules! dispatch {
    ($(#[$doc:meta])* $module:ident :: $name:ident ($($argument:ident: $type:ty),*) $(-> $result:ty)?) => {
        $(#[$doc])*
        #[allow(unsafe_code, reason = "functions compiled for further instructions may only be called where the machine has them")]
        pub(crate) fn $name(level: SimdLevel, $($argument: $type),*) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,fma")]
            fn avx2($($argument: $type),*) $(-> $result)? {
                $module::$name::<Four>($($argument),*)
            }
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,fma")]
            fn avx2_wide($($argument: $type),*) $(-> $result)? {
                $module::$name::<Pair<Four>>($($argument),*)
            }
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,avx2,fma")]
            fn avx512($($argument: $type),*) $(-> $result)? {
                $module::$name::<Eight>($($argument),*)
            }
            match if level.is_here() { level } else { SimdLevel::Baseline } {
                // SAFETY: `is_here` has found AVX2 and FMA, which is all that the function asks for.
                #[cfg(target_arch = "x86_64")]
                SimdLevel::Avx2 => unsafe { avx2($($argument),*) },
                // SAFETY: as above.
                #[cfg(target_arch = "x86_64")]
                SimdLevel::Avx2Wide => unsafe { avx2_wide($($argument),*) },
                // SAFETY: `is_here` has found AVX-512F, AVX2 and FMA, which is all that the function asks for.
                #[cfg(target_arch = "x86_64")]
                SimdLevel::Avx512 => unsafe { avx512($($argument),*) },
                #[cfg(not(target_arch = "x86_64"))]
                SimdLevel::Avx2 | SimdLevel::Avx2Wide | SimdLevel::Avx512 => $module::$name::<Two>($($argument),*),
                SimdLevel::Baseline => $module::$name::<Two>($($argument),*),
            }
        }
    };
}

dispatch!(
    /// Sums over rows, with products of columns.
    kernel::sum_products(arm: &Arm<'_>, blocks: &[Wide]) -> Totals
);
dispatch!(
    /// Sums over rows, without products of columns.
    kernel::sum_gradient(arm: &Arm<'_>, blocks: &[Wide]) -> Totals
);
dispatch!(
    /// Writes columns and residuals of the rows of one block.
    columns::whitened_columns(
        arm: &Arm<'_>,
        block: &[Wide],
        places: &[usize],
        jacobian: &mut [[Wide; NUMBERS]],
        residual: &mut [Wide; NUMBERS]
    )
);
dispatch!(
    /// Writes the frames of the last link.
    tip::last_links(joints: &[(bool, FixedMotion)], values: &[[Wide; 2]], out: &mut [[Wide; 4]; 3])
);
dispatch!(
    /// Writes errors of position and rotation.
    errors::errors(
        links: &[[Wide; 4]; 3],
        ends: &Frames,
        measured: &Frames,
        framed: bool,
        out: &mut [[Wide; 3]; 2]
    )
);
dispatch!(
    /// Writes `(cos, sin)` of each angle, with the same bits at every level.
    sincos::cosines_and_sines(angles: &[f64], out: &mut [(f64, f64)])
);
dispatch!(
    /// The product of the motions of all joints, each with its two factors, with the same bits at every level.
    poses::product_of_exponentials(joints: &[Exponential], factors: &[[Wide; 2]]) -> [[Wide; 4]; 3]
);
dispatch!(
    /// Factor of the symmetric matrix given by its upper triangle (row-major `n × n`) plus `damping` on the diagonal; `None` if that
    /// is not positive definite.
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
        jacobian: &mut [[Wide; NUMBERS]],
        residual: &[Wide; NUMBERS],
        weight: &Wide,
        least: f64
    ) -> [Wide; 2]
);
