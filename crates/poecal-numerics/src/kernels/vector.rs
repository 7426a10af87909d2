//! Numbers of several rows side by side: the vectors of the kernels, for all widths of the machine's vectors.

use std::any::TypeId;
use std::ops::{Add, Mul, Neg, Sub};

use pulp::{Scalar128b, Simd};

/// Number of rows side by side in memory, for all widths of the instructions.
pub const WIDTH: usize = 8;

/// One number of [`WIDTH`] rows, on a cache line of its own.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct LaneBlock(pub [f64; WIDTH]);

impl LaneBlock {
    /// Zeros.
    pub const ZERO: LaneBlock = LaneBlock([0.0; WIDTH]);
}

/// One number of each of as many rows as a vector of the machine has lanes, a divisor of [`WIDTH`].
#[derive(Clone, Copy)]
pub(crate) struct Lanes<S: Simd> {
    /// Instructions of the machine.
    simd: S,
    numbers: S::f64s,
}

/// Parts of a wide number.
#[inline(always)]
pub(crate) fn parts<S: Simd>(_simd: S) -> std::ops::Range<usize> {
    0..WIDTH / S::F64_LANES
}

/// Numbers by their index. `std::array::from_fn` calls a function that is not compiled for the vector instructions, unless the optimiser
/// inlines it.
#[inline(always)]
pub(crate) fn from_index<S: Simd, const N: usize>(simd: S, make: impl Fn(usize) -> Lanes<S>) -> [Lanes<S>; N] {
    let mut all = [Lanes::splat(simd, 0.0); N];
    let mut k = 0;
    while k < N {
        all[k] = make(k);
        k += 1;
    }
    all
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    pub(crate) fn splat(simd: S, value: f64) -> Self {
        Lanes { simd, numbers: simd.splat_f64s(value) }
    }

    /// Part `part` of the rows of a wide number.
    #[inline(always)]
    pub(crate) fn load(simd: S, wide: &LaneBlock, part: usize) -> Self {
        Lanes { simd, numbers: S::as_simd_f64s(&wide.0).0[part] }
    }

    #[inline(always)]
    pub(crate) fn store(self, wide: &mut LaneBlock, part: usize) {
        S::as_mut_simd_f64s(&mut wide.0).0[part] = self.numbers;
    }

    /// This value in every lane.
    #[inline(always)]
    pub(crate) fn all(self, value: f64) -> Self {
        Self::splat(self.simd, value)
    }

    /// `self * factor + term`, fused if the machine can.
    #[inline(always)]
    pub(crate) fn times_plus(self, factor: Self, term: Self) -> Self {
        if is_fused::<S>() {
            Lanes { numbers: self.simd.mul_add_f64s(self.numbers, factor.numbers, term.numbers), ..self }
        } else {
            self * factor + term
        }
    }

    /// `term - self * factor`, fused if the machine can.
    #[inline(always)]
    pub(crate) fn times_from(self, factor: Self, term: Self) -> Self {
        if is_fused::<S>() {
            let numbers = self.simd.negate_mul_add_f64s(self.numbers, factor.numbers, term.numbers);
            Lanes { numbers, ..self }
        } else {
            term - self * factor
        }
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        Lanes { numbers: self.simd.sqrt_f64s(self.numbers), ..self }
    }

    /// `self / other`, or `otherwise` if `other` is not positive.
    #[inline(always)]
    pub(crate) fn divide_or(self, other: Self, otherwise: f64) -> Self {
        let positive = self.simd.greater_than_f64s(other.numbers, self.all(0.0).numbers);
        let quotient = self.simd.div_f64s(self.numbers, other.numbers);
        Lanes { numbers: self.simd.select_f64s(positive, quotient, self.all(otherwise).numbers), ..self }
    }

    /// Sum of all lanes, in a fixed order.
    #[inline(always)]
    pub(crate) fn sum(self) -> f64 {
        self.simd.reduce_sum_f64s(self.numbers)
    }

    /// True if all are below a bound, and all others below theirs.
    #[inline(always)]
    pub(crate) fn are_below(self, bound: f64, (other, other_bound): (Self, f64)) -> bool {
        let simd = self.simd;
        let is_below = simd.less_than_f64s(self.numbers, self.all(bound).numbers);
        let other_is_below = simd.less_than_f64s(other.numbers, self.all(other_bound).numbers);
        let both = simd.and_m64s(is_below, other_is_below);
        simd.reduce_max_f64s(simd.select_f64s(both, self.all(0.0).numbers, self.all(1.0).numbers)) == 0.0
    }

    /// Adds these to part `part` of a wide number.
    #[inline(always)]
    pub(crate) fn add_to(self, sum: &mut LaneBlock, part: usize) {
        (Self::load(self.simd, sum, part) + self).store(sum, part);
    }

    /// The polynomial `c₀ + c₁ x + …` of these numbers.
    #[inline(always)]
    pub(crate) fn polynomial<const N: usize>(self, coefficients: [f64; N]) -> Self {
        let mut sum = self.all(coefficients[N - 1]);
        for c in coefficients.iter().rev().skip(1) {
            sum = sum.times_plus(self, self.all(*c));
        }
        sum
    }
}

/// True if the instructions multiply and add at once. For those of every machine, and for WebAssembly's, a software function would.
#[inline(always)]
fn is_fused<S: Simd>() -> bool {
    cfg!(not(target_arch = "wasm32")) && TypeId::of::<S>() != TypeId::of::<Scalar128b>()
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Lanes { numbers: self.simd.add_f64s(self.numbers, other.numbers), ..self }
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Lanes { numbers: self.simd.sub_f64s(self.numbers, other.numbers), ..self }
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Lanes { numbers: self.simd.mul_f64s(self.numbers, other.numbers), ..self }
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Lanes { numbers: self.simd.neg_f64s(self.numbers), ..self }
    }
}

/// A vector in space for each row.
#[derive(Clone, Copy)]
pub(crate) struct Vectors<S: Simd>(pub(crate) [Lanes<S>; 3]);

impl<S: Simd> Vectors<S> {
    #[inline(always)]
    pub(crate) fn splat(simd: S, v: &[f64; 3]) -> Self {
        Vectors([Lanes::splat(simd, v[0]), Lanes::splat(simd, v[1]), Lanes::splat(simd, v[2])])
    }

    /// Part `part` of three wide numbers.
    #[inline(always)]
    pub(crate) fn load(simd: S, [x, y, z]: &[LaneBlock; 3], part: usize) -> Self {
        Vectors([Lanes::load(simd, x, part), Lanes::load(simd, y, part), Lanes::load(simd, z, part)])
    }

    #[inline(always)]
    pub(crate) fn store(self, wide: &mut [LaneBlock; 3], part: usize) {
        self.0[0].store(&mut wide[0], part);
        self.0[1].store(&mut wide[1], part);
        self.0[2].store(&mut wide[2], part);
    }

    #[inline(always)]
    pub(crate) fn scale(self, factor: Lanes<S>) -> Self {
        let [x, y, z] = self.0;
        Vectors([x * factor, y * factor, z * factor])
    }

    /// `self * factor + term`.
    #[inline(always)]
    pub(crate) fn times_plus(self, factor: Lanes<S>, term: Self) -> Self {
        let ([x, y, z], [a, b, c]) = (self.0, term.0);
        Vectors([x.times_plus(factor, a), y.times_plus(factor, b), z.times_plus(factor, c)])
    }

    #[inline(always)]
    pub(crate) fn dot(self, other: Self) -> Lanes<S> {
        let ([x, y, z], [a, b, c]) = (self.0, other.0);
        x.times_plus(a, y.times_plus(b, z * c))
    }

    #[inline(always)]
    pub(crate) fn cross(self, other: Self) -> Self {
        let ([x, y, z], [a, b, c]) = (self.0, other.0);
        Vectors([z.times_from(b, y * c), x.times_from(c, z * a), y.times_from(a, x * b)])
    }
}

impl<S: Simd> Add for Vectors<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let ([x, y, z], [a, b, c]) = (self.0, other.0);
        Vectors([x + a, y + b, z + c])
    }
}

impl<S: Simd> Sub for Vectors<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let ([x, y, z], [a, b, c]) = (self.0, other.0);
        Vectors([x - a, y - b, z - c])
    }
}
