//! Coefficients of the exponential and logarithm series: the only place with small-angle branches.
//!
//! Each function takes the *squared* angle, switches to its Taylor series below [`SWITCH`] and is there exact to rounding:
//! the first omitted term is below 1e-17 of the value.

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

/// Squared angle below which the Taylor series are used (an angle of 0.1 rad).
pub const SWITCH: f64 = 1e-2;

/// `sin θ / θ` of `θ²`: the first coefficient of theory.md §1 (2a).
#[must_use]
pub fn sinc(angle_squared: f64) -> f64 {
    if angle_squared < SWITCH {
        horner(angle_squared, &[1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0, -1.0 / 39_916_800.0])
    } else {
        let angle = angle_squared.sqrt();
        angle.sin() / angle
    }
}

/// `(1 - cos θ) / θ²` of `θ²`: the second coefficient of theory.md §1 (2a).
#[must_use]
pub fn cosc(angle_squared: f64) -> f64 {
    if angle_squared < SWITCH {
        horner(
            angle_squared,
            &[0.5, -1.0 / 24.0, 1.0 / 720.0, -1.0 / 40_320.0, 1.0 / 3_628_800.0, -1.0 / 479_001_600.0],
        )
    } else {
        // 2 sin²(θ/2) / θ² does not cancel.
        let half = (0.5 * angle_squared.sqrt()).sin();
        2.0 * half * half / angle_squared
    }
}

/// `(θ - sin θ) / θ³` of `θ²`: the third coefficient of theory.md §1 (2a).
#[must_use]
pub fn sincc(angle_squared: f64) -> f64 {
    if angle_squared < SWITCH {
        horner(
            angle_squared,
            &[1.0 / 6.0, -1.0 / 120.0, 1.0 / 5040.0, -1.0 / 362_880.0, 1.0 / 39_916_800.0, -1.0 / 6_227_020_800.0],
        )
    } else {
        let angle = angle_squared.sqrt();
        (angle - angle.sin()) / (angle_squared * angle)
    }
}

/// The series of [`cotc`] in `θ²`.
pub const COTC: [f64; 6] =
    [1.0 / 12.0, 1.0 / 720.0, 1.0 / 30_240.0, 1.0 / 1_209_600.0, 1.0 / 47_900_160.0, 691.0 / 1_307_674_368_000.0];

/// The series of `asin(s) / s` in `s²`.
pub const ARCSINE: [f64; 12] = arcsine();

const fn arcsine() -> [f64; 12] {
    let mut out = [1.0; 12];
    let (mut k, mut factor) = (1, 1.0);
    while k < out.len() {
        factor *= (2 * k - 1) as f64 / (2 * k) as f64;
        out[k] = factor / (2 * k + 1) as f64;
        k += 1;
    }
    out
}

/// `(1 - (θ/2) cot(θ/2)) / θ²` of `θ²`, up to θ < 2π: the coefficient of `ω̂²` in `V⁻¹`, theory.md §1 (2a).
#[must_use]
pub fn cotc(angle_squared: f64) -> f64 {
    if angle_squared < SWITCH {
        horner(angle_squared, &COTC)
    } else {
        let half = 0.5 * angle_squared.sqrt();
        (1.0 - half * half.cos() / half.sin()) / angle_squared
    }
}

/// The coefficients c and d of `ad³` and `ad⁴` in the left Jacobian of SE(3), of `θ²` (theory.md §1 (4)).
#[must_use]
pub fn left_jacobian(angle_squared: f64) -> (f64, f64) {
    let x = angle_squared;
    if x < SWITCH {
        (
            horner(x, &[1.0 / 24.0, -1.0 / 360.0, 1.0 / 13_440.0, -1.0 / 907_200.0, 1.0 / 95_800_320.0]),
            horner(x, &[1.0 / 120.0, -1.0 / 2_520.0, 1.0 / 120_960.0, -1.0 / 9_979_200.0, 1.0 / 1_245_404_160.0]),
        )
    } else {
        // d is (2 + cos θ - 3 sinc) / (2 θ⁴), written with sincc to cancel less.
        ((2.0 * cosc(x) - sinc(x)) / (2.0 * x), (3.0 * sincc(x) - cosc(x)) / (2.0 * x))
    }
}

/// The coefficients b and d of `ad²` and `ad⁴` in the inverse left Jacobian of SE(3), of `θ²` below `(2π)²` (theory.md §1 (4a)).
#[must_use]
pub fn inverse_left_jacobian(angle_squared: f64) -> (f64, f64) {
    let x = angle_squared;
    if x < SWITCH {
        (
            horner(x, &[1.0 / 12.0, 0.0, -1.0 / 30_240.0, -1.0 / 604_800.0, -1.0 / 15_966_720.0]),
            horner(x, &[-1.0 / 720.0, -1.0 / 15_120.0, -1.0 / 403_200.0, -1.0 / 11_975_040.0]),
        )
    } else {
        // An even polynomial that has the value and the slope of γ = (θ/2) cot(θ/2) at the double eigenvalues ±iθ of ad.
        let half = 0.5 * x.sqrt();
        let (sine, cosine) = half.sin_cos();
        let gamma = half * cosine / sine;
        // dγ/dθ² = (γ - (θ/2)² / sin²(θ/2)) / (2θ²)
        let slope = (gamma - (half / sine).powi(2)) / (2.0 * x);
        let b = slope - 2.0 * (gamma - 1.0) / x;
        (b, (gamma - 1.0) / (x * x) + b / x)
    }
}

fn horner(x: f64, coefficients: &[f64]) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_meet_closed_forms_at_the_switch() {
        // Closed forms cancel: (θ - sin θ)/θ³ at 0.1 rad loses about 3 digits, hence 1e-12.
        for f in [sinc, cosc, sincc, cotc] {
            let (below, above) = (f(SWITCH * (1.0 - 1e-15)), f(SWITCH * (1.0 + 1e-15)));
            let jump = ((below - above) / above).abs();
            println!("relative jump at the switch: {jump:.1e}");
            assert!(jump < 1e-12);
        }
    }

    #[test]
    fn series_begin_with_their_first_coefficients() {
        assert_eq!((sinc(0.0), cosc(0.0)), (1.0, 0.5));
        assert!((sincc(0.0) - 1.0 / 6.0).abs() < 1e-16 && (cotc(0.0) - 1.0 / 12.0).abs() < 1e-16);
        assert_eq!(left_jacobian(0.0), (1.0 / 24.0, 1.0 / 120.0));
        assert_eq!(inverse_left_jacobian(0.0), (1.0 / 12.0, -1.0 / 720.0));
    }
}
