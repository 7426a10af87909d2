//! Vectors of AVX2 and AVX-512. Left to itself the compiler mixes the rows' numbers in its vectors, which takes three times as long.
//!
//! # Safety
//!
//! The instructions must exist on the machine. Both types are private to [`crate::lanes`], and every value of theirs is made below
//! [`super::simd`], which calls functions compiled for these instructions only where it has found them.

#![allow(unsafe_code, reason = "vector instructions that not every machine has")]

use std::arch::x86_64::*;
use std::ops::{Add, Mul, Neg, Sub};

use super::vector::{Vector, Wide};

/// Four numbers.
#[derive(Clone, Copy)]
pub(super) struct Four(__m256d);

/// Eight numbers.
#[derive(Clone, Copy)]
pub(super) struct Eight(__m512d);

macro_rules! operator {
    ($type:ident, $trait:ident, $method:ident, $instruction:ident) => {
        impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: the machine has the instruction (see above).
                $type(unsafe { $instruction(self.0, other.0) })
            }
        }
    };
}

operator!(Four, Add, add, _mm256_add_pd);
operator!(Four, Sub, sub, _mm256_sub_pd);
operator!(Four, Mul, mul, _mm256_mul_pd);
operator!(Eight, Add, add, _mm512_add_pd);
operator!(Eight, Sub, sub, _mm512_sub_pd);
operator!(Eight, Mul, mul, _mm512_mul_pd);

impl Neg for Four {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: the machine has the instructions (see above).
        Four(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
    }
}

impl Neg for Eight {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: the machine has the instructions (see above). Zero less a number would lose the sign of zero, which nothing needs.
        Eight(unsafe { _mm512_sub_pd(_mm512_setzero_pd(), self.0) })
    }
}

impl Vector for Four {
    const LANES: usize = 4;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        // SAFETY: the machine has the instruction (see above).
        Four(unsafe { _mm256_set1_pd(value) })
    }

    #[inline(always)]
    fn load(wide: &Wide, part: usize) -> Self {
        let numbers = &wide.0[4 * part..4 * part + 4];
        // SAFETY: four numbers follow the pointer; the machine has the instruction (see above).
        Four(unsafe { _mm256_loadu_pd(numbers.as_ptr()) })
    }

    #[inline(always)]
    fn store(self, wide: &mut Wide, part: usize) {
        let numbers = &mut wide.0[4 * part..4 * part + 4];
        // SAFETY: four numbers follow the pointer; the machine has the instruction (see above).
        unsafe { _mm256_storeu_pd(numbers.as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        // SAFETY: the machine has the instruction (see above).
        Four(unsafe { _mm256_fmadd_pd(self.0, factor.0, term.0) })
    }

    #[inline(always)]
    fn times_from(self, factor: Self, term: Self) -> Self {
        // SAFETY: the machine has the instruction (see above).
        Four(unsafe { _mm256_fnmadd_pd(self.0, factor.0, term.0) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: the machine has the instruction (see above).
        Four(unsafe { _mm256_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn over(self, other: Self, otherwise: f64) -> Self {
        // SAFETY: the machine has the instructions (see above).
        Four(unsafe {
            let positive = _mm256_cmp_pd::<_CMP_GT_OQ>(other.0, _mm256_setzero_pd());
            _mm256_blendv_pd(_mm256_set1_pd(otherwise), _mm256_div_pd(self.0, other.0), positive)
        })
    }

    #[inline(always)]
    fn sum(self) -> f64 {
        // SAFETY: the machine has the instructions (see above).
        unsafe {
            let half = _mm_add_pd(_mm256_castpd256_pd128(self.0), _mm256_extractf128_pd::<1>(self.0));
            _mm_cvtsd_f64(_mm_add_sd(half, _mm_unpackhi_pd(half, half)))
        }
    }

    #[inline(always)]
    fn are_below(self, bound: f64) -> bool {
        // SAFETY: the machine has the instructions (see above).
        let below = unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, _mm256_set1_pd(bound))) };
        below == 0b1111
    }
}

impl Vector for Eight {
    const LANES: usize = 8;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        // SAFETY: the machine has the instruction (see above).
        Eight(unsafe { _mm512_set1_pd(value) })
    }

    #[inline(always)]
    fn load(wide: &Wide, _part: usize) -> Self {
        // SAFETY: eight numbers follow the pointer; the machine has the instruction (see above).
        Eight(unsafe { _mm512_loadu_pd(wide.0.as_ptr()) })
    }

    #[inline(always)]
    fn store(self, wide: &mut Wide, _part: usize) {
        // SAFETY: eight numbers follow the pointer; the machine has the instruction (see above).
        unsafe { _mm512_storeu_pd(wide.0.as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        // SAFETY: the machine has the instruction (see above).
        Eight(unsafe { _mm512_fmadd_pd(self.0, factor.0, term.0) })
    }

    #[inline(always)]
    fn times_from(self, factor: Self, term: Self) -> Self {
        // SAFETY: the machine has the instruction (see above).
        Eight(unsafe { _mm512_fnmadd_pd(self.0, factor.0, term.0) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: the machine has the instruction (see above).
        Eight(unsafe { _mm512_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn over(self, other: Self, otherwise: f64) -> Self {
        // SAFETY: the machine has the instructions (see above).
        Eight(unsafe {
            let positive = _mm512_cmp_pd_mask::<_CMP_GT_OQ>(other.0, _mm512_setzero_pd());
            _mm512_mask_blend_pd(positive, _mm512_set1_pd(otherwise), _mm512_div_pd(self.0, other.0))
        })
    }

    #[inline(always)]
    fn sum(self) -> f64 {
        // SAFETY: the machine has the instructions (see above).
        unsafe { _mm512_reduce_add_pd(self.0) }
    }

    #[inline(always)]
    fn are_below(self, bound: f64) -> bool {
        // SAFETY: the machine has the instructions (see above).
        let below = unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, _mm512_set1_pd(bound)) };
        below == 0xff
    }
}
