//! Vectors without instructions of their own: two numbers, and two vectors taken as one.

use std::ops::{Add, Mul, Neg, Sub};

use super::vector::{Vector, Wide};

/// Whether instructions that every machine of the target has multiply and add at once.
const FUSED: bool = cfg!(target_arch = "aarch64");

/// Two numbers, vectorised by the compiler where it can.
#[derive(Clone, Copy, Debug)]
pub(super) struct Two([f64; 2]);

/// Two vectors as one of twice the width.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair<V>([V; 2]);

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl $trait for Two {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Two([self.0[0].$method(other.0[0]), self.0[1].$method(other.0[1])])
            }
        }

        impl<V: Vector> $trait for Pair<V> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Pair([self.0[0].$method(other.0[0]), self.0[1].$method(other.0[1])])
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);

impl Neg for Two {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Two([-self.0[0], -self.0[1]])
    }
}

impl Vector for Two {
    const LANES: usize = 2;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Two([value; 2])
    }

    #[inline(always)]
    fn load(wide: &Wide, part: usize) -> Self {
        Two([wide.0[2 * part], wide.0[2 * part + 1]])
    }

    #[inline(always)]
    fn store(self, wide: &mut Wide, part: usize) {
        [wide.0[2 * part], wide.0[2 * part + 1]] = self.0;
    }

    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        if FUSED {
            Two([self.0[0].mul_add(factor.0[0], term.0[0]), self.0[1].mul_add(factor.0[1], term.0[1])])
        } else {
            self * factor + term
        }
    }

    #[inline(always)]
    fn times_from(self, factor: Self, term: Self) -> Self {
        (-self).times_plus(factor, term)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Two([self.0[0].sqrt(), self.0[1].sqrt()])
    }

    #[inline(always)]
    fn over(self, other: Self, otherwise: f64) -> Self {
        let over = |a: f64, b: f64| if b > 0.0 { a / b } else { otherwise };
        Two([over(self.0[0], other.0[0]), over(self.0[1], other.0[1])])
    }

    #[inline(always)]
    fn sum(self) -> f64 {
        self.0[0] + self.0[1]
    }

    #[inline(always)]
    fn are_below(self, bound: f64) -> bool {
        self.0[0] < bound && self.0[1] < bound
    }
}

impl<V: Vector> Neg for Pair<V> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Pair([-self.0[0], -self.0[1]])
    }
}

impl<V: Vector> Vector for Pair<V> {
    const LANES: usize = 2 * V::LANES;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Pair([V::splat(value); 2])
    }

    #[inline(always)]
    fn load(wide: &Wide, part: usize) -> Self {
        Pair([V::load(wide, 2 * part), V::load(wide, 2 * part + 1)])
    }

    #[inline(always)]
    fn store(self, wide: &mut Wide, part: usize) {
        self.0[0].store(wide, 2 * part);
        self.0[1].store(wide, 2 * part + 1);
    }

    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        let ([a, b], [c, d], [e, f]) = (self.0, factor.0, term.0);
        Pair([a.times_plus(c, e), b.times_plus(d, f)])
    }

    #[inline(always)]
    fn times_from(self, factor: Self, term: Self) -> Self {
        let ([a, b], [c, d], [e, f]) = (self.0, factor.0, term.0);
        Pair([a.times_from(c, e), b.times_from(d, f)])
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Pair([self.0[0].sqrt(), self.0[1].sqrt()])
    }

    #[inline(always)]
    fn over(self, other: Self, otherwise: f64) -> Self {
        Pair([self.0[0].over(other.0[0], otherwise), self.0[1].over(other.0[1], otherwise)])
    }

    #[inline(always)]
    fn sum(self) -> f64 {
        (self.0[0] + self.0[1]).sum()
    }

    #[inline(always)]
    fn are_below(self, bound: f64) -> bool {
        self.0[0].are_below(bound) && self.0[1].are_below(bound)
    }
}
