//! Frames of several rows.

use super::plan::FixedMotion;
use super::vector::{Vector, Vectors};

/// A frame in the device's axes, by rows: a component of the directions x, y, z and of the origin. In this order a product needs few
/// registers.
#[derive(Clone, Copy)]
pub(super) struct Frame<V>(pub(super) [[V; 4]; 3]);

impl<V: Vector> Frame<V> {
    #[inline(always)]
    pub(super) fn fixed(step: &FixedMotion) -> Self {
        let [x, y, z] = &step.columns;
        let mut rows = [[V::splat(0.0); 4]; 3];
        for (k, row) in rows.iter_mut().enumerate() {
            *row = [V::splat(x[k]), V::splat(y[k]), V::splat(z[k]), V::splat(step.translation[k])];
        }
        Frame(rows)
    }

    /// The frame after a fixed motion.
    #[inline(always)]
    pub(super) fn then(mut self, step: &FixedMotion) -> Self {
        for row in &mut self.0 {
            *row = turned(*row, step);
        }
        self
    }

    #[inline(always)]
    pub(super) fn column(&self, k: usize) -> Vectors<V> {
        let [a, b, c] = &self.0;
        Vectors([a[k], b[k], c[k]])
    }

    #[inline(always)]
    pub(super) fn origin(&self) -> Vectors<V> {
        self.column(3)
    }
}

/// A row of a frame after a fixed motion.
#[inline(always)]
pub(super) fn turned<V: Vector>([x, y, z, origin]: [V; 4], step: &FixedMotion) -> [V; 4] {
    let [a, b, c] = &step.columns;
    let along = |v: &[f64; 3]| x.times_plus(V::splat(v[0]), y.times_plus(V::splat(v[1]), z * V::splat(v[2])));
    let [p, q, r] = step.translation;
    let origin = x.times_plus(V::splat(p), y.times_plus(V::splat(q), z.times_plus(V::splat(r), origin)));
    [along(a), along(b), along(c), origin]
}

/// A row of a frame after a joint's own motion, a turn about z by `(cos θ, sin θ)` or a slide along it by `(θ, 0)`.
#[inline(always)]
pub(super) fn moved<V: Vector>([x, y, z, origin]: [V; 4], turns: bool, cosine: V, sine: V) -> [V; 4] {
    if turns {
        [x.times_plus(cosine, y * sine), x.times_from(sine, y * cosine), z, origin]
    } else {
        [x, y, z, z.times_plus(cosine, origin)]
    }
}
