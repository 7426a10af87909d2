//! Frames of several rows.

use pulp::Simd;

use super::plan::FixedMotion;
use super::vector::{Lanes, Vectors};

/// A frame in the device's axes, by rows: a component of the directions x, y, z and of the origin. In this order a product needs few
/// registers.
#[derive(Clone, Copy)]
pub(crate) struct KernelFrame<S: Simd>(pub(crate) [[Lanes<S>; 4]; 3]);

impl<S: Simd> KernelFrame<S> {
    #[inline(always)]
    pub(crate) fn from_step(simd: S, step: &FixedMotion) -> Self {
        let [x, y, z] = &step.columns;
        let mut rows = [[Lanes::splat(simd, 0.0); 4]; 3];
        for (k, row) in rows.iter_mut().enumerate() {
            *row = [
                Lanes::splat(simd, x[k]),
                Lanes::splat(simd, y[k]),
                Lanes::splat(simd, z[k]),
                Lanes::splat(simd, step.translation[k]),
            ];
        }
        KernelFrame(rows)
    }

    /// The frame after a fixed motion.
    #[inline(always)]
    pub(crate) fn compose(mut self, simd: S, step: &FixedMotion) -> Self {
        for row in &mut self.0 {
            *row = turn_row(simd, *row, step);
        }
        self
    }

    #[inline(always)]
    pub(crate) fn column(&self, k: usize) -> Vectors<S> {
        let [a, b, c] = &self.0;
        Vectors([a[k], b[k], c[k]])
    }

    #[inline(always)]
    pub(crate) fn origin(&self) -> Vectors<S> {
        self.column(3)
    }
}

/// A row of a frame after a fixed motion.
#[inline(always)]
pub(crate) fn turn_row<S: Simd>(simd: S, [x, y, z, origin]: [Lanes<S>; 4], step: &FixedMotion) -> [Lanes<S>; 4] {
    let [a, b, c] = &step.columns;
    let along = |v: &[f64; 3]| {
        let [i, j, k] = Vectors::splat(simd, v).0;
        x.times_plus(i, y.times_plus(j, z * k))
    };
    let [p, q, r] = Vectors::splat(simd, &step.translation).0;
    let origin = x.times_plus(p, y.times_plus(q, z.times_plus(r, origin)));
    [along(a), along(b), along(c), origin]
}

/// A row of a frame after a joint's own motion: a rotation about z by `(cos θ, sin θ)` or a translation along it by `(θ, 0)`.
#[inline(always)]
pub(crate) fn move_row<S: Simd>(
    [x, y, z, origin]: [Lanes<S>; 4],
    turns: bool,
    cosine: Lanes<S>,
    sine: Lanes<S>,
) -> [Lanes<S>; 4] {
    if turns {
        [x.times_plus(cosine, y * sine), x.times_from(sine, y * cosine), z, origin]
    } else {
        [x, y, z, z.times_plus(cosine, origin)]
    }
}
