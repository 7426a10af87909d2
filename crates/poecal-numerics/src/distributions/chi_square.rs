//! The χ² distribution of few degrees of freedom, its upper tail above all.

use std::f64::consts::PI;

use super::beta::f_quantile;

/// Medians for 1 to 6 degrees of freedom.
const MEDIANS: [f64; 6] = [0.4549, 1.3863, 2.3660, 3.3567, 4.3515, 5.3481];

/// Median for 1 to 6 degrees of freedom.
pub fn chi_square_median(freedom: usize) -> f64 {
    MEDIANS[freedom.clamp(1, 6) - 1]
}

/// Upper quantile: exceeded with a probability of at most 0.1, by Newton's method on the logarithm of the tail.
pub fn upper_quantile(probability: f64, freedom: usize) -> f64 {
    let mut x = freedom as f64;
    for _ in 0..60 {
        let (survival, density) = upper_tail(x, freedom);
        let step = (survival / probability).ln() * survival / density;
        x += step;
        if step.abs() < 1e-14 * x {
            break;
        }
    }
    x
}

/// Degrees of freedom beyond which the approximation of wilson1931 is as good as the F distribution with 1e6 for infinitely many.
const MANY: f64 = 1000.0;
/// Degrees of freedom that represent infinitely many.
const INFINITE: f64 = 1e6;
/// Normal quantile that is exceeded with a probability of 0.05.
const NORMAL: f64 = 1.644_853_627;

/// Upper 5 % point of a mean square of `freedom` degrees of freedom, which need not be whole, of variables of variance 1.
pub fn upper_mean_square(freedom: f64) -> f64 {
    if freedom > MANY { mean_square_quantile(freedom, NORMAL) } else { f_quantile(0.05, freedom, INFINITE) }
}

/// Lower 5 % point of such a mean square.
pub fn lower_mean_square(freedom: f64) -> f64 {
    if freedom > MANY { mean_square_quantile(freedom, -NORMAL) } else { 1.0 / f_quantile(0.05, INFINITE, freedom) }
}

/// Quantile of a mean square by its normal quantile (wilson1931).
pub fn mean_square_quantile(freedom: f64, normal: f64) -> f64 {
    let spread = 2.0 / (9.0 * freedom);
    (1.0 - spread + normal * spread.sqrt()).powi(3)
}

/// Normal quantile of the 99 % band of a mean square.
const BAND: f64 = 2.575_829;

/// Position of a mean square of variables of variance 1 relative to its 99 % band (wilson1931): below, inside, above.
pub fn is_within_band(mean_square: f64, freedom: f64) -> std::cmp::Ordering {
    let spread = 2.0 / (9.0 * freedom);
    let deviation = (mean_square.cbrt() - (1.0 - spread)) / spread.sqrt();
    if deviation > BAND {
        std::cmp::Ordering::Greater
    } else if deviation < -BAND {
        std::cmp::Ordering::Less
    } else {
        std::cmp::Ordering::Equal
    }
}

/// Probability to exceed `x ≥ 1`, and the density there: `Q(x; ν + 2) = Q(x; ν) + (x/2)^(ν/2) e^(-x/2) / Γ(ν/2 + 1)` from ν = 1 or 2
/// on, where the added term is twice the density for ν + 2.
fn upper_tail(x: f64, freedom: usize) -> (f64, f64) {
    let half = 0.5 * x;
    let (mut sum, mut twice, mut dof) = if freedom % 2 == 1 {
        (complementary_error(half.sqrt()), (-half).exp() / (PI * half).sqrt(), 1)
    } else {
        ((-half).exp(), (-half).exp(), 2)
    };
    while dof < freedom {
        twice *= half / (0.5 * dof as f64);
        sum += twice;
        dof += 2;
    }
    (sum, 0.5 * twice)
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

    /// Both 5 % points of χ² over its degrees of freedom as tables print them, and continuous where the method of computation changes.
    #[test]
    fn mean_squares_agree_with_tables() {
        for (freedom, lower, upper) in
            [(1.0, 0.00393, 3.841), (3.0, 0.3518, 7.815), (10.0, 3.940, 18.307), (100.0, 77.929, 124.342)]
        {
            let [low, high] = [lower_mean_square(freedom), upper_mean_square(freedom)].map(|it| it * freedom);
            println!("{freedom}: {low:.5} {high:.4}, table {lower} {upper}");
            // The tolerance is for the tables' digits, and 1e6 for infinitely many degrees of freedom.
            assert!((low - lower).abs() < 2e-4 * lower.max(0.03) + 1e-5 && (high / upper - 1.0).abs() < 4e-4);
        }
        for of in [lower_mean_square, upper_mean_square] {
            assert!((of(MANY) / of(MANY + 1e-6) - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn quantiles_are_exceeded_as_often_as_asked_for() {
        for freedom in 1..=6 {
            for probability in [0.1, 1e-3, 1e-9, 1e-13] {
                let (survival, _) = upper_tail(upper_quantile(probability, freedom), freedom);
                let off = (survival / probability - 1.0).abs();
                println!("{freedom} {probability:e}: {off:.1e}");
                // The tolerance is for a few roundings of the exponential's argument.
                assert!(off < 1e-13);
            }
        }
    }
}
