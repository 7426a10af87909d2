//! Real roots of trigonometric polynomials, `Σ aₖ cos kθ + bₖ sin kθ`, with the angles at which two roots are about to meet.

use core::f64::consts::PI;

use crate::trig::{cosine_and_sine, wrap_angle};

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

/// Angles, at most `N`; more are left out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AngleList<const N: usize> {
    pub(crate) values: [f64; N],
    pub(crate) count: usize,
    /// For each, true if it is one of two that meet or almost do.
    touching: [bool; N],
}

/// Tolerances for two angles that meet, or almost do; they grow with the distance of an arm from its relative in closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RootTolerance {
    /// Distance of two angles (rad) below which they almost meet.
    almost: f64,
    /// Least distance of two angles that meet, rad.
    apart: f64,
    /// Imaginary part of a pair of solutions up to which a real pair of the arm itself may be near, rad.
    beyond: f64,
}

impl RootTolerance {
    /// No tolerance: real roots alone.
    pub(crate) const NONE: Self = RootTolerance { almost: 0.0, apart: 0.0, beyond: 0.0 };
    /// Largest tolerance, for an arm at the largest distance from its relative.
    const MOST: Self = RootTolerance { almost: 0.15, apart: 0.06, beyond: 1.6 };

    /// Tolerance for an arm at this distance (rad, lengths over reach) from its relative, which moves double roots by its square root.
    pub(crate) fn from_deviation(off: f64) -> Self {
        let share = (60.0 * off.sqrt()).min(1.0);
        let RootTolerance { almost, apart, beyond } = Self::MOST;
        RootTolerance { almost: share * almost, apart: share * apart, beyond: share * beyond }
    }

    /// The same tolerance, with a pair wherever none is real.
    pub(crate) fn with_forced_pairs(self) -> Self {
        RootTolerance { apart: 0.0, beyond: f64::INFINITY, ..self }
    }

    /// Tolerance for roots that are exact except for rounding.
    pub(crate) fn rounding(beyond: f64) -> Self {
        RootTolerance { beyond, ..Self::NONE }
    }
}

impl<const N: usize> AngleList<N> {
    pub(crate) const EMPTY: Self = AngleList { values: [0.0; N], count: 0, touching: [false; N] };

    fn push(&mut self, angle: f64, is_touching: bool) {
        if self.count < N {
            self.values[self.count] = angle;
            self.touching[self.count] = is_touching;
            self.count += 1;
        }
    }

    /// Angles, each with true if it is one of two that meet or almost do.
    pub(crate) fn iter_flagged(&self) -> impl Iterator<Item = (f64, bool)> {
        let all = self.values.iter().zip(&self.touching).take(self.count);
        all.map(|(value, is_touching)| (*value, *is_touching))
    }

    /// True if two of them meet or almost do.
    pub(crate) fn is_touching(&self) -> bool {
        self.touching.iter().take(self.count).any(|it| *it)
    }

    /// Marks those that have another one near.
    fn mark(&mut self, almost: f64) {
        for k in 0..self.count {
            let near = |other: usize| other != k && wrap_angle(self.values[k] - self.values[other]).abs() < almost;
            self.touching[k] |= (0..self.count).any(near);
        }
    }

    pub(crate) fn as_slice(&self) -> &[f64] {
        &self.values[..self.count]
    }
}

/// Angles with `a cos θ + b sin θ = d`. If there is none, or two are closer than `apart`, there are two at a distance of `apart` (rad)
/// about the place where they meet. The imaginary part of the solutions must be below `beyond`.
pub(crate) fn linear(a: f64, b: f64, d: f64, care: RootTolerance) -> AngleList<2> {
    let RootTolerance { almost, apart, beyond } = care;
    let mut found = AngleList::EMPTY;
    let size = a.hypot(b);
    let (middle, share) = if size > 0.0 { (b.atan2(a), d / size) } else { (0.0, 0.0) };
    let half = if share.abs() <= 1.0 {
        share.acos()
    } else if share.abs().acosh() <= beyond {
        if share > 0.0 { 0.0 } else { PI }
    } else {
        return found;
    };
    let is_touching = half < 0.5 * almost || PI - half < 0.5 * almost;
    let half = half.clamp(0.5 * apart, PI - 0.5 * apart);
    found.push(middle + half, is_touching);
    found.push(middle - half, is_touching);
    found
}

/// Largest number of bisections of a part of the turn.
const DEPTH: u32 = 7;

/// A trigonometric polynomial of degree `D`, `coefficients[k] = (aₖ, bₖ)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TrigonometricPolynomial<const TERMS: usize> {
    pub(crate) coefficients: [(f64, f64); TERMS],
}

impl<const TERMS: usize> TrigonometricPolynomial<TERMS> {
    /// Value and first two derivatives.
    #[inline]
    fn evaluate(&self, angle: f64) -> (f64, f64, f64) {
        let (c, s) = cosine_and_sine(angle);
        let (mut ck, mut sk) = (1.0, 0.0);
        let (mut value, mut slope, mut bend) = (0.0, 0.0, 0.0);
        for (k, (a, b)) in self.coefficients.iter().enumerate() {
            let k = k as f64;
            let (here, along) = (a * ck + b * sk, b * ck - a * sk);
            value += here;
            slope += k * along;
            bend -= k * k * here;
            (ck, sk) = (ck * c - sk * s, sk * c + ck * s);
        }
        (value, slope, bend)
    }

    /// The root between two angles at which the values have opposite signs.
    fn root_between(&self, mut low: f64, mut high: f64, low_value: f64) -> f64 {
        let mut at = 0.5 * (low + high);
        for _ in 0..60 {
            let (value, slope, _) = self.evaluate(at);
            if (value > 0.0) == (low_value > 0.0) {
                low = at;
            } else {
                high = at;
            }
            let step = value / slope;
            let next = at - step;
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            if (next - at).abs() < 1e-13 {
                return next;
            }
            at = next;
        }
        at
    }

    /// All real roots. If two are about to meet or have just separated (imaginary part below `beyond`), there are two at least `apart`
    /// from each other. The turn is searched in `grid` parts.
    pub(crate) fn roots<const N: usize>(&self, grid: usize, care: RootTolerance) -> AngleList<N> {
        let mut found = AngleList::EMPTY;
        let half = PI / grid as f64;
        for k in 0..grid {
            let middle = half * (2 * k + 1) as f64 - PI;
            self.roots_around(middle, half, DEPTH, care, &mut found);
        }
        found.mark(care.almost);
        found
    }

    /// Roots within half a width of an angle. If Taylor's series excludes a zero, there are none. If the second derivative keeps its
    /// sign, there are two at most, determined by values and slopes at the ends; else halves are searched.
    fn roots_around<const N: usize>(
        &self,
        middle: f64,
        half: f64,
        depth: u32,
        care: RootTolerance,
        found: &mut AngleList<N>,
    ) {
        let RootTolerance { apart, beyond, .. } = care;
        let [value, slope, bend, third, fourth] = self.derivatives(middle).map(f64::abs);
        // The fourth derivative is nearly constant.
        let (square, fourth) = (half * half, 2.0 * fourth);
        let change = half * third + square / 2.0 * fourth;
        let most = half * (slope + half / 2.0 * (bend + half / 3.0 * (third + half / 4.0 * fourth)));
        if value > most + 0.5 * beyond * beyond * (bend + change) {
            return;
        }
        let is_simple = slope > half * (bend + half / 2.0 * (third + half / 3.0 * fourth)) || bend > change;
        if depth > 0 && !is_simple {
            let quarter = 0.5 * half;
            self.roots_around(middle - quarter, quarter, depth - 1, care, found);
            self.roots_around(middle + quarter, quarter, depth - 1, care, found);
            return;
        }
        let (low, high) = (middle - half, middle + half);
        let (low_value, low_slope, _) = self.evaluate(low);
        let (high_value, high_slope, _) = self.evaluate(high);
        if (low_value > 0.0) != (high_value > 0.0) {
            found.push(self.root_between(low, high, low_value), false);
        } else if (low_value > 0.0) == (low_slope < 0.0) && (low_slope > 0.0) != (high_slope > 0.0) {
            // Between them the polynomial comes closest to zero.
            let extremum = self.extremum(low, high, low_slope);
            let (there, _, bend) = self.evaluate(extremum);
            if (there > 0.0) != (low_value > 0.0) {
                found.push(self.root_between(low, extremum, low_value), false);
                found.push(self.root_between(extremum, high, there), false);
            } else if (2.0 * there / bend).abs() < beyond * beyond {
                found.push(extremum - 0.5 * apart, true);
                found.push(extremum + 0.5 * apart, true);
            }
        }
    }

    /// Value and first four derivatives.
    #[inline]
    fn derivatives(&self, angle: f64) -> [f64; 5] {
        let (c, s) = cosine_and_sine(angle);
        let (mut ck, mut sk) = (1.0, 0.0);
        let mut out = [0.0; 5];
        for (k, (a, b)) in self.coefficients.iter().enumerate() {
            let k = k as f64;
            let (here, along) = (a * ck + b * sk, k * (b * ck - a * sk));
            let squared = k * k;
            out[0] += here;
            out[1] += along;
            out[2] -= squared * here;
            out[3] -= squared * along;
            out[4] += squared * squared * here;
            (ck, sk) = (ck * c - sk * s, sk * c + ck * s);
        }
        out
    }

    /// Angle between two others at which the slope is zero.
    fn extremum(&self, mut low: f64, mut high: f64, low_slope: f64) -> f64 {
        let mut at = 0.5 * (low + high);
        for _ in 0..40 {
            let (_, slope, bend) = self.evaluate(at);
            if (slope > 0.0) == (low_slope > 0.0) {
                low = at;
            } else {
                high = at;
            }
            let next = at - slope / bend;
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            if (next - at).abs() < 1e-12 {
                return next;
            }
            at = next;
        }
        at
    }
}
