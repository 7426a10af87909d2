//! Real roots of trigonometric polynomials, `Σ aₖ cos kθ + bₖ sin kθ`, with the places where two roots are about to meet.

use core::f64::consts::{PI, TAU};

use crate::trig::{cosine_and_sine, wrapped};

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

/// Angles, at most `N`; more are left out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Angles<const N: usize> {
    pub(crate) values: [f64; N],
    pub(crate) count: usize,
    /// Whether each is one of two that meet or almost do.
    touching: [bool; N],
}

/// Distance of two angles (rad) below which they almost meet.
const ALMOST: f64 = 0.15;

impl<const N: usize> Angles<N> {
    pub(crate) const EMPTY: Self = Angles { values: [0.0; N], count: 0, touching: [false; N] };

    fn push(&mut self, angle: f64, is_touching: bool) {
        if self.count < N {
            self.values[self.count] = angle;
            self.touching[self.count] = is_touching;
            self.count += 1;
        }
    }

    /// Each with whether it is one of two that meet or almost do.
    pub(crate) fn each(&self) -> impl Iterator<Item = (f64, bool)> {
        let all = self.values.iter().zip(&self.touching).take(self.count);
        all.map(|(value, is_touching)| (*value, *is_touching))
    }

    /// Whether two of them meet or almost do.
    pub(crate) fn is_touching(&self) -> bool {
        self.touching.iter().take(self.count).any(|it| *it)
    }

    /// Marks those that have another one near.
    fn mark(&mut self) {
        for k in 0..self.count {
            let near =
                |other: usize| other != k && wrapped(self.values[k] - self.values[other]).abs() < ALMOST;
            self.touching[k] |= (0..self.count).any(near);
        }
    }

    pub(crate) fn as_slice(&self) -> &[f64] {
        &self.values[..self.count]
    }
}

/// Angles with `a cos θ + b sin θ = d`. Where there is none, or two are closer than `apart`, two that are `apart` (rad) on both sides of
/// the place where they meet, if the imaginary part of the solutions is below `beyond`.
pub(crate) fn linear(a: f64, b: f64, d: f64, apart: f64, beyond: f64) -> Angles<2> {
    let mut found = Angles::EMPTY;
    let size = a.hypot(b);
    let (middle, share) = if size > 0.0 { (b.atan2(a), d / size) } else { (0.0, 0.0) };
    let half = if share.abs() <= 1.0 {
        share.acos()
    } else if share.abs().acosh() <= beyond {
        if share > 0.0 { 0.0 } else { PI }
    } else {
        return found;
    };
    let is_touching = half < 0.5 * ALMOST || PI - half < 0.5 * ALMOST;
    let half = half.clamp(0.5 * apart, PI - 0.5 * apart);
    found.push(middle + half, is_touching);
    found.push(middle - half, is_touching);
    found
}

/// A trigonometric polynomial of degree `D`, `coefficients[k] = (aₖ, bₖ)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trigonometric<const TERMS: usize> {
    pub(crate) coefficients: [(f64, f64); TERMS],
}

impl<const TERMS: usize> Trigonometric<TERMS> {
    /// Value and first two derivatives.
    #[inline]
    fn at(&self, angle: f64) -> (f64, f64, f64) {
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
    fn between(&self, mut low: f64, mut high: f64, low_value: f64) -> f64 {
        let mut at = 0.5 * (low + high);
        for _ in 0..60 {
            let (value, slope, _) = self.at(at);
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

    /// All real roots; where two are about to meet or have just left each other (imaginary part below `beyond`), two that are at least
    /// `apart` from each other.
    pub(crate) fn roots<const N: usize>(&self, grid: usize, apart: f64, beyond: f64) -> Angles<N> {
        let mut found = Angles::EMPTY;
        let width = TAU / grid as f64;
        let first = -PI;
        let (start_value, start_slope, _) = self.at(first);
        let (mut angle, mut value, mut slope) = (first, start_value, start_slope);
        for k in 1..=grid {
            let next = if k == grid { PI } else { first + width * k as f64 };
            let (next_value, next_slope, _) =
                if k == grid { (start_value, start_slope, 0.0) } else { self.at(next) };
            if (value > 0.0) != (next_value > 0.0) {
                found.push(self.between(angle, next, value), false);
            } else if (value > 0.0) == (slope < 0.0) && (slope > 0.0) != (next_slope > 0.0) {
                // Between them the polynomial comes closest to zero.
                let extremum = self.extremum(angle, next, slope);
                let (there, _, bend) = self.at(extremum);
                if (there > 0.0) != (value > 0.0) {
                    found.push(self.between(angle, extremum, value), false);
                    found.push(self.between(extremum, next, there), false);
                } else if (2.0 * there / bend).abs() < beyond * beyond {
                    found.push(extremum - 0.5 * apart, true);
                    found.push(extremum + 0.5 * apart, true);
                }
            }
            (angle, value, slope) = (next, next_value, next_slope);
        }
        found.mark();
        found
    }

    /// The place between two angles where the slope is zero.
    fn extremum(&self, mut low: f64, mut high: f64, low_slope: f64) -> f64 {
        let mut at = 0.5 * (low + high);
        for _ in 0..40 {
            let (_, slope, bend) = self.at(at);
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
