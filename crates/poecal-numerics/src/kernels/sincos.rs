//! Sines and cosines of many angles: one loop without branches, which the compiler vectorises. No product is fused with a sum, so that the
//! bits are the same at every level.

use pulp::Simd;

use poecal_arm::trig::{LARGEST, cosine_and_sine};

/// Writes `(cos, sin)` of each angle, to within about a unit in the last place. `S` only names the instructions.
#[inline(always)]
pub(crate) fn cosines_and_sines<S: Simd>(_simd: S, angles: &[f64], out: &mut [(f64, f64)]) {
    for (out, &angle) in out.iter_mut().zip(angles) {
        *out = cosine_and_sine(angle);
    }
    mend(angles, out);
}

/// Replaces the results of angles that are too large for the loop.
fn mend(angles: &[f64], out: &mut [(f64, f64)]) {
    for (out, &angle) in out.iter_mut().zip(angles) {
        if angle.abs() > LARGEST {
            *out = (angle.cos(), angle.sin());
        }
    }
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
