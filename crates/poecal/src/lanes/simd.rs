//! Run-time dispatch: the same source compiled for each set of vector instructions. The only unsafe code of the library.

use super::kernel::{self, Totals};
#[cfg(target_arch = "x86_64")]
use super::plain::Pair;
use super::plain::Two;
use super::plan::{Plan, Step};
use super::sincos;
use super::vector::{Vector, Wide};
#[cfg(target_arch = "x86_64")]
use super::x86::{Eight, Four};

/// By which instructions the kernels run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Those that every machine of the target has: two numbers at a time.
    Baseline,
    /// AVX2 with FMA: four numbers at a time.
    Avx2,
    /// AVX2 with FMA, written for eight numbers at a time: slower, and there so that this width can be tested without AVX-512.
    Avx2Wide,
    /// AVX-512: eight numbers at a time.
    Avx512,
}

impl Level {
    /// The best level of this machine.
    #[must_use]
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if Level::Avx512.is_here() {
                return Level::Avx512;
            }
            if Level::Avx2.is_here() {
                return Level::Avx2;
            }
        }
        Level::Baseline
    }

    /// Whether this machine has the instructions.
    fn is_here(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        {
            let avx2 = || is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
            match self {
                Level::Baseline => true,
                Level::Avx2 | Level::Avx2Wide => avx2(),
                Level::Avx512 => is_x86_feature_detected!("avx512f") && avx2(),
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            self == Level::Baseline
        }
    }
}

/// Levels that this machine has, the best first.
#[must_use]
pub fn levels() -> Vec<Level> {
    let all = [Level::Avx512, Level::Avx2, Level::Avx2Wide, Level::Baseline];
    all.into_iter().filter(|level| level.is_here()).collect()
}

/// Level, arm, steps and end, rows.
type Task<'a> = (&'a Plan, &'a [Step], &'a Step, &'a [Wide]);

#[inline(always)]
fn run<V: Vector>((plan, steps, end, blocks): Task<'_>, full: bool) -> Totals {
    if full {
        kernel::sum::<V, true>(plan, steps, end, blocks)
    } else {
        kernel::sum::<V, false>(plan, steps, end, blocks)
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2(task: Task<'_>, full: bool) -> Totals {
    run::<Four>(task, full)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2_wide(task: Task<'_>, full: bool) -> Totals {
    run::<Pair<Four>>(task, full)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
fn run_avx512(task: Task<'_>, full: bool) -> Totals {
    run::<Eight>(task, full)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn cosines_and_sines_avx2(angles: &[f64], out: &mut [(f64, f64)]) {
    sincos::cosines_and_sines(angles, out);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
fn cosines_and_sines_avx512(angles: &[f64], out: &mut [(f64, f64)]) {
    sincos::cosines_and_sines(angles, out);
}

/// Writes `(cos, sin)` of each angle, with the same bits at every level.
#[allow(unsafe_code, reason = "functions compiled for further instructions may only be called where the machine has them")]
pub(crate) fn cosines_and_sines(level: Level, angles: &[f64], out: &mut [(f64, f64)]) {
    let level = if level.is_here() { level } else { Level::Baseline };
    match level {
        // SAFETY: `is_here` has found AVX2 and FMA, which is all that the function asks for.
        #[cfg(target_arch = "x86_64")]
        Level::Avx2 | Level::Avx2Wide => unsafe { cosines_and_sines_avx2(angles, out) },
        // SAFETY: `is_here` has found AVX-512F, AVX2 and FMA, which is all that the function asks for.
        #[cfg(target_arch = "x86_64")]
        Level::Avx512 => unsafe { cosines_and_sines_avx512(angles, out) },
        _ => sincos::cosines_and_sines(angles, out),
    }
    sincos::mend(angles, out);
}

/// Sums over rows, with products of columns if `full`.
#[allow(unsafe_code, reason = "functions compiled for further instructions may only be called where the machine has them")]
pub(crate) fn sum(level: Level, task: Task<'_>, full: bool) -> Totals {
    let level = if level.is_here() { level } else { Level::Baseline };
    match level {
        // SAFETY: `is_here` has found AVX2 and FMA, which is all that the function asks for.
        #[cfg(target_arch = "x86_64")]
        Level::Avx2 => unsafe { run_avx2(task, full) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Level::Avx2Wide => unsafe { run_avx2_wide(task, full) },
        // SAFETY: `is_here` has found AVX-512F, AVX2 and FMA, which is all that the function asks for.
        #[cfg(target_arch = "x86_64")]
        Level::Avx512 => unsafe { run_avx512(task, full) },
        _ => run::<Two>(task, full),
    }
}
