//! Sines and cosines with the same bits on every machine, and angles.

use core::f64::consts::{FRAC_2_PI, TAU};

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

/// π/2 in three parts of 33 bits, so that their products with a number of quarter turns below 2²⁰ are exact.
const QUARTER: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];
/// Number whose addition and subtraction rounds to a whole number, which is then in the lowest bits.
const ROUND: f64 = 1.5 * (1_u64 << 52) as f64;
/// Largest angle for three parts of π/2: some 80,000 turns.
pub const LARGEST: f64 = 5e5;

/// Taylor-like coefficients of `(sin r - r) / r³` and `(cos r - 1 + r²/2) / r⁴` for `|r| ≤ π/4` (those of the FreeBSD library).
const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
const COSINE: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// `(cos, sin)` of an angle up to [`LARGEST`], to within about a unit in the last place. There are no branches, so that loops compile to
/// vector instructions, and no fused products, so that the bits are the same on every machine.
#[inline(always)]
#[must_use]
pub fn cosine_and_sine(angle_rad: f64) -> (f64, f64) {
    let rounded = angle_rad * FRAC_2_PI + ROUND;
    let quarters = rounded - ROUND;
    let bits = rounded.to_bits();
    let r = ((angle_rad - quarters * QUARTER[0]) - quarters * QUARTER[1]) - quarters * QUARTER[2];
    let z = r * r;
    let sine = r + r * z * polynomial(z, &SINE);
    let half = 0.5 * z;
    let whole = 1.0 - half;
    let cosine = whole + (((1.0 - whole) - half) + z * z * polynomial(z, &COSINE));
    let (sine, cosine) = if bits & 1 == 0 { (sine, cosine) } else { (cosine, sine) };
    let signed = |value: f64, quarter: u64| f64::from_bits(value.to_bits() ^ ((quarter & 2) << 62));
    (signed(cosine, bits.wrapping_add(1)), signed(sine, bits))
}

#[inline(always)]
fn polynomial(z: f64, c: &[f64; 6]) -> f64 {
    c[0] + z * (c[1] + z * (c[2] + z * (c[3] + z * (c[4] + z * c[5]))))
}

/// The same angle in (-π, π].
#[must_use]
pub fn wrap_angle(angle_rad: f64) -> f64 {
    let turns = (angle_rad / TAU).round();
    let angle = angle_rad - turns * TAU;
    if angle <= -core::f64::consts::PI { angle + TAU } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cosines_and_sines_are_those_of_the_library() {
        for k in -4000..4000 {
            let angle = 0.37 * f64::from(k);
            let (cosine, sine) = cosine_and_sine(angle);
            // Two units in the last place of numbers up to 1.
            assert!((cosine - angle.cos()).abs() < 2.3e-16 && (sine - angle.sin()).abs() < 2.3e-16, "{angle}");
        }
    }

    #[test]
    fn angles_are_wrapped_to_half_a_turn() {
        assert!((wrap_angle(7.0) - (7.0 - TAU)).abs() < 1e-15);
        assert_eq!(wrap_angle(-core::f64::consts::PI), core::f64::consts::PI);
    }
}
