//! Numbers of several rows side by side: the vectors of the kernels, whatever the width of the machine's vectors.

use std::ops::{Add, Mul, Neg, Sub};

/// Rows side by side in memory, whatever the width of the instructions.
pub(crate) const WIDTH: usize = 8;

/// One number of [`WIDTH`] rows, on a cache line of its own.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Wide(pub(crate) [f64; WIDTH]);

impl Wide {
    pub(crate) const ZERO: Wide = Wide([0.0; WIDTH]);
}

/// One number of each of `LANES` rows. `LANES` divides [`WIDTH`].
pub(super) trait Vector:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    const LANES: usize;

    fn splat(value: f64) -> Self;

    /// Part `part` of the rows of a wide number.
    fn load(wide: &Wide, part: usize) -> Self;

    fn store(self, wide: &mut Wide, part: usize);

    /// `self * factor + term`, fused if the machine can.
    fn times_plus(self, factor: Self, term: Self) -> Self;

    /// `term - self * factor`, fused if the machine can.
    fn times_from(self, factor: Self, term: Self) -> Self;

    fn sqrt(self) -> Self;

    /// `self / other`, or `otherwise` where `other` is not positive.
    fn over(self, other: Self, otherwise: f64) -> Self;

    /// The sum of all, in a fixed order.
    fn sum(self) -> f64;

    /// Whether all are below a bound.
    fn are_below(self, bound: f64) -> bool;

    /// Adds these to part `part` of a wide number.
    #[inline(always)]
    fn add_to(self, sum: &mut Wide, part: usize) {
        (Self::load(sum, part) + self).store(sum, part);
    }

    /// The polynomial `c₀ + c₁ x + …` of these numbers.
    #[inline(always)]
    fn polynomial<const N: usize>(self, coefficients: [f64; N]) -> Self {
        let mut sum = Self::splat(coefficients[N - 1]);
        for c in coefficients.iter().rev().skip(1) {
            sum = sum.times_plus(self, Self::splat(*c));
        }
        sum
    }
}

/// A vector in space for each row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vectors<V>(pub(super) [V; 3]);

impl<V: Vector> Vectors<V> {
    #[inline(always)]
    pub(super) fn splat(v: &[f64; 3]) -> Self {
        Vectors([V::splat(v[0]), V::splat(v[1]), V::splat(v[2])])
    }

    /// Part `part` of three wide numbers.
    #[inline(always)]
    pub(super) fn load(wide: &[Wide; 3], part: usize) -> Self {
        Vectors([V::load(&wide[0], part), V::load(&wide[1], part), V::load(&wide[2], part)])
    }

    #[inline(always)]
    pub(super) fn store(self, wide: &mut [Wide; 3], part: usize) {
        self.0[0].store(&mut wide[0], part);
        self.0[1].store(&mut wide[1], part);
        self.0[2].store(&mut wide[2], part);
    }

    #[inline(always)]
    pub(super) fn scale(self, factor: V) -> Self {
        let [x, y, z] = self.0;
        Vectors([x * factor, y * factor, z * factor])
    }

    /// `self * factor + term`.
    #[inline(always)]
    pub(super) fn times_plus(self, factor: V, term: Self) -> Self {
        let ([x, y, z], [a, b, c]) = (self.0, term.0);
        Vectors([x.times_plus(factor, a), y.times_plus(factor, b), z.times_plus(factor, c)])
    }

    #[inline(always)]
    pub(super) fn dot(self, other: Self) -> V {
        let ([x, y, z], [a, b, c]) = (self.0, other.0);
        x.times_plus(a, y.times_plus(b, z * c))
    }

    #[inline(always)]
    pub(super) fn cross(self, other: Self) -> Self {
        let ([x, y, z], [a, b, c]) = (self.0, other.0);
        Vectors([z.times_from(b, y * c), x.times_from(c, z * a), y.times_from(a, x * b)])
    }
}

impl<V: Vector> Add for Vectors<V> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let ([x, y, z], [a, b, c]) = (self.0, other.0);
        Vectors([x + a, y + b, z + c])
    }
}

impl<V: Vector> Sub for Vectors<V> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let ([x, y, z], [a, b, c]) = (self.0, other.0);
        Vectors([x - a, y - b, z - c])
    }
}
