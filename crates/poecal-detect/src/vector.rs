//! Loops in the widest vector instructions of the machine. Rust keeps the order of each sum, so results are the same with any.

use pulp::{Arch, Simd, WithSimd};

struct VectorWork<F>(F);

impl<F: FnOnce() -> T, T> WithSimd for VectorWork<F> {
    type Output = T;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> T {
        (self.0)()
    }
}

/// Runs the code inlined into a closure, which has to be `#[inline(always)]` itself, with the vector instructions of the machine.
#[inline(always)]
pub(crate) fn run_vectorized<T>(work: impl FnOnce() -> T) -> T {
    Arch::new().dispatch(VectorWork(work))
}

/// Changes each number by those at the same index in other slices, up to the shortest of them. With iterators the compiler leaves calls.
#[inline(always)]
#[allow(clippy::needless_range_loop)]
pub(crate) fn change<T: Copy, const N: usize, A: Copy>(to: &mut [T], by: [&[A]; N], f: impl Fn(T, [A; N]) -> T) {
    let count = by.iter().map(|it| it.len()).fold(to.len(), usize::min);
    let (to, by) = (&mut to[..count], by.map(|it| &it[..count]));
    for k in 0..count {
        to[k] = f(to[k], by.map(|it| it[k]));
    }
}
