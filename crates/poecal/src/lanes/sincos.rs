//! Sines and cosines of many angles: one loop without branches, which the compiler vectorises. No product is fused with a sum, so that the
//! bits are the same at every level.

use pulp::Simd;

use std::f64::consts::FRAC_2_PI;

/// π/2 in three parts of 33 bits, so that their products with a number of quarter turns below 2²⁰ are exact.
const QUARTER: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];
/// Adding and subtracting it rounds to a whole number, which then stands in the lowest bits.
const ROUND: f64 = 1.5 * (1_u64 << 52) as f64;
/// Largest angle for three parts of π/2: some 80,000 turns.
const LARGE: f64 = 5e5;

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

/// Writes `(cos, sin)` of each angle, to within about a unit in the last place. `S` only names the instructions.
#[inline(always)]
pub(super) fn cosines_and_sines<S: Simd>(_simd: S, angles: &[f64], out: &mut [(f64, f64)]) {
    for (out, &angle) in out.iter_mut().zip(angles) {
        *out = cosine_and_sine(angle);
    }
    mend(angles, out);
}

/// Replaces the results of angles that are too large for the loop.
fn mend(angles: &[f64], out: &mut [(f64, f64)]) {
    for (out, &angle) in out.iter_mut().zip(angles) {
        if angle.abs() > LARGE {
            *out = (angle.cos(), angle.sin());
        }
    }
}

#[inline(always)]
fn cosine_and_sine(angle: f64) -> (f64, f64) {
    let rounded = angle * FRAC_2_PI + ROUND;
    let quarters = rounded - ROUND;
    let bits = rounded.to_bits();
    let r = ((angle - quarters * QUARTER[0]) - quarters * QUARTER[1]) - quarters * QUARTER[2];
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

#[cfg(test)]
mod tests {
    use super::super::{cosines_and_sines, simd_levels};

    #[test]
    fn sines_are_those_of_the_library() {
        let mut angles: Vec<f64> = (-40_000..40_000).map(|k| f64::from(k) * 3.7e-4).collect();
        angles.extend((-4000..4000).map(|k| f64::from(k) * std::f64::consts::FRAC_PI_4));
        angles.extend((0..4000).map(|k| 1e-9 * 1.01_f64.powi(k)).filter(|angle| *angle < 1e15));
        angles.extend([0.0, -0.0, 1e300]);
        let mut reference: Option<Vec<(f64, f64)>> = None;
        for level in simd_levels() {
            let mut found = vec![(0.0, 0.0); angles.len()];
            cosines_and_sines(level, &angles, &mut found);
            let mut worst: f64 = 0.0;
            for (angle, (cosine, sine)) in angles.iter().zip(&found) {
                let ulp = |value: f64, exact: f64| {
                    (value - exact).abs() / (exact.abs() * f64::EPSILON).max(f64::MIN_POSITIVE)
                };
                for error in [ulp(*cosine, angle.cos()), ulp(*sine, angle.sin())] {
                    assert!(error <= 1.0, "{level:?} {angle}: {error} ε");
                    worst = worst.max(error);
                }
            }
            println!("{level:?}: {worst:.2} ε");
            assert!(reference.get_or_insert_with(|| found.clone()) == &found);
        }
    }
}
