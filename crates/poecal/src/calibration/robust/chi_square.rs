//! The χ² distribution of few degrees of freedom, its upper tail above all.

use std::f64::consts::PI;

/// Medians for 1 to 6 degrees of freedom.
const MEDIANS: [f64; 6] = [0.4549, 1.3863, 2.3660, 3.3567, 4.3515, 5.3481];

/// The median for 1 to 6 degrees of freedom.
pub(super) fn median(freedom: usize) -> f64 {
    MEDIANS[freedom.clamp(1, 6) - 1]
}

/// What is exceeded with a probability of at most 0.1.
pub(super) fn upper_quantile(probability: f64, freedom: usize) -> f64 {
    let (mut below, mut above) = (1.0, 1.0);
    while survival(above, freedom) > probability && above < 1e4 {
        above *= 2.0;
    }
    for _ in 0..60 {
        let middle = 0.5 * (below + above);
        if survival(middle, freedom) > probability {
            below = middle;
        } else {
            above = middle;
        }
    }
    above
}

/// Probability to exceed `x ≥ 1`: `Q(x; ν + 2) = Q(x; ν) + (x/2)^(ν/2) e^(-x/2) / Γ(ν/2 + 1)` from ν = 1 or 2 on.
fn survival(x: f64, freedom: usize) -> f64 {
    let half = 0.5 * x;
    let odd = freedom % 2 == 1;
    let (mut sum, mut term, mut dof) = if odd {
        (complementary_error(half.sqrt()), (half / PI).sqrt() * 2.0 * (-half).exp(), 1)
    } else {
        ((-half).exp(), half * (-half).exp(), 2)
    };
    while dof < freedom {
        sum += term;
        dof += 2;
        term *= half / (0.5 * dof as f64);
    }
    sum
}

/// `erfc(z)` for z ≥ 0.7 by its continued fraction, from the inside.
fn complementary_error(z: f64) -> f64 {
    let mut fraction = z;
    for k in (1..200).rev() {
        fraction = z + 0.5 * f64::from(k) / fraction;
    }
    (-z * z).exp() / (PI.sqrt() * fraction)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles as tables print them.
    #[test]
    fn quantiles_agree_with_tables() {
        for (probability, freedom, table) in [
            (0.05, 1, 3.841),
            (0.05, 2, 5.991),
            (0.05, 3, 7.815),
            (0.001, 3, 16.266),
            (0.01, 5, 15.086),
            (0.001, 6, 22.458),
        ] {
            let found = upper_quantile(probability, freedom);
            println!("{probability} {freedom}: {found:.4}, table {table}");
            assert!((found - table).abs() < 6e-4);
        }
    }
}
