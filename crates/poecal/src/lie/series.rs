//! Coefficients of the exponential and logarithm series: the only place with small-angle branches.
//!
//! Each function takes the *squared* angle, switches to its Taylor series below [`SWITCH`] and is there exact to rounding:
//! the first omitted term is below 1e-17 of the value.

/// Squared angle below which the Taylor series are used (an angle of 0.1 rad).
pub const SWITCH: f64 = 1e-2;

/// `sin θ / θ` of `θ²`.
///
/// ```
/// assert_eq!(poecal::lie::series::sinc(0.0), 1.0);
/// ```
#[must_use]
pub fn sinc(angle_squared: f64) -> f64 {
    if angle_squared < SWITCH {
        horner(
            angle_squared,
            &[1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0, -1.0 / 39_916_800.0],
        )
    } else {
        let angle = angle_squared.sqrt();
        angle.sin() / angle
    }
}

/// `(1 - cos θ) / θ²` of `θ²`.
///
/// ```
/// assert_eq!(poecal::lie::series::cosc(0.0), 0.5);
/// ```
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

/// `(θ - sin θ) / θ³` of `θ²`.
///
/// ```
/// assert!((poecal::lie::series::sincc(0.0) - 1.0 / 6.0).abs() < 1e-16);
/// ```
#[must_use]
pub fn sincc(angle_squared: f64) -> f64 {
    if angle_squared < SWITCH {
        horner(
            angle_squared,
            &[
                1.0 / 6.0,
                -1.0 / 120.0,
                1.0 / 5040.0,
                -1.0 / 362_880.0,
                1.0 / 39_916_800.0,
                -1.0 / 6_227_020_800.0,
            ],
        )
    } else {
        let angle = angle_squared.sqrt();
        (angle - angle.sin()) / (angle_squared * angle)
    }
}

/// `(1 - (θ/2) cot(θ/2)) / θ²` of `θ²`: the second coefficient of the inverse left Jacobian, defined up to θ < 2π.
///
/// ```
/// assert!((poecal::lie::series::cotc(0.0) - 1.0 / 12.0).abs() < 1e-16);
/// ```
#[must_use]
pub fn cotc(angle_squared: f64) -> f64 {
    if angle_squared < SWITCH {
        horner(
            angle_squared,
            &[
                1.0 / 12.0,
                1.0 / 720.0,
                1.0 / 30_240.0,
                1.0 / 1_209_600.0,
                1.0 / 47_900_160.0,
                691.0 / 1_307_674_368_000.0,
            ],
        )
    } else {
        let half = 0.5 * angle_squared.sqrt();
        (1.0 - half * half.cos() / half.sin()) / angle_squared
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
}
