//! The F distribution, by the incomplete beta function (abramowitz1964 26.5 and 26.6).

/// Upper quantile of the F distribution: a ratio of two mean squares of `first` and `second` degrees of freedom exceeds it with this
/// probability of 0 to 0.5. The degrees of freedom need not be whole. For large `second` it tends to χ² over its degrees of freedom.
pub fn f_quantile(probability: f64, first: f64, second: f64) -> f64 {
    let upper = |x: f64| incomplete_beta(1.0 - x, 0.5 * second, 0.5 * first);
    // x = first F / (first F + second) by bisection: monotonic, and as fine as rounding after 60 rounds.
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if upper(middle) > probability { low = middle } else { high = middle }
    }
    second * low / (first * (1.0 - low)).max(f64::MIN_POSITIVE)
}

/// Probability of at most `most` events in `count` independent trials, each with this probability.
pub fn binomial_at_most(most: usize, count: usize, probability: f64) -> f64 {
    if most >= count {
        return 1.0;
    }
    incomplete_beta(1.0 - probability, (count - most) as f64, most as f64 + 1.0)
}

/// The regularised incomplete beta function `I_x(a, b)` by its continued fraction.
fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x >= 1.0 {
        return 1.0;
    }
    let front = (ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (-x).ln_1p()).exp();
    // The fraction converges fast below the mean.
    if x < (a + 1.0) / (a + b + 2.0) {
        front * fraction(x, a, b) / a
    } else {
        1.0 - front * fraction(1.0 - x, b, a) / b
    }
}

/// The continued fraction of the incomplete beta function by Lentz' method.
fn fraction(x: f64, a: f64, b: f64) -> f64 {
    const TINY: f64 = 1e-300;
    let away = |value: f64| if value.abs() < TINY { TINY } else { value };
    let (mut c, mut d) = (1.0, 1.0 / away(1.0 - (a + b) * x / (a + 1.0)));
    let mut product = d;
    for k in 1..1000 {
        let k = f64::from(k);
        let even = k * (b - k) * x / ((a + 2.0 * k - 1.0) * (a + 2.0 * k));
        let odd = -(a + k) * (a + b + k) * x / ((a + 2.0 * k) * (a + 2.0 * k + 1.0));
        let mut change = 1.0;
        for term in [even, odd] {
            d = 1.0 / away(1.0 + term * d);
            c = away(1.0 + term / c);
            change = c * d;
            product *= change;
        }
        if (change - 1.0).abs() < 1e-15 {
            break;
        }
    }
    product
}

/// Logarithm of the gamma function for x above 0 (lanczos1964).
fn ln_gamma(x: f64) -> f64 {
    const G: f64 = 7.0;
    const FIRST: f64 = 0.999_999_999_999_809_9;
    const OTHERS: [f64; 8] = [
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    if x < 0.5 {
        // The series is for larger arguments: Γ(x) = Γ(x + 1) / x.
        return ln_gamma(x + 1.0) - x.ln();
    }
    let x = x - 1.0;
    let sum: f64 = FIRST + OTHERS.iter().enumerate().map(|(k, c)| c / (x + k as f64 + 1.0)).sum::<f64>();
    let t = x + G + 0.5;
    0.5 * std::f64::consts::TAU.ln() + (x + 0.5) * t.ln() - t + sum.ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Upper 5 % and 1 % points as tables print them (and χ² over its degrees for the last). The sums are of
    /// terms that are written out.
    #[test]
    fn binomial_probabilities_are_sums_of_their_terms() {
        for (count, probability) in [(1, 0.3), (20, 0.95), (59, 0.05), (200, 0.95)] {
            let mut term = (1.0f64 - probability).powi(count);
            let mut sum = 0.0;
            for most in 0..count {
                sum += term;
                term *= f64::from(count - most) / f64::from(most + 1) * probability / (1.0 - probability);
                let found = binomial_at_most(most as usize, count as usize, probability);
                // The tolerance is for rounding of the logarithms of the gamma function.
                assert!((found - sum).abs() < 1e-11, "{count} {probability} {most}: {found} {sum}");
            }
        }
        // Fewer than 59 errors do not bound their 95 % quantile from above (wilks1941).
        assert!(1.0 - binomial_at_most(57, 58, 0.95) > 0.05 && 1.0 - binomial_at_most(58, 59, 0.95) < 0.05);
    }

    #[test]
    fn quantiles_agree_with_tables() {
        for (probability, first, second, table) in [
            (0.05, 3.0, 9.0, 3.8625),
            (0.05, 1.0, 1.0, 161.4476),
            (0.05, 3.0, 3.0, 9.2766),
            (0.01, 5.0, 20.0, 4.1027),
            (0.05, 2.0, 120.0, 3.0718),
            (0.01, 30.0, 60.0, 2.0285),
            (0.05, 3.0, 1e7, 7.8147 / 3.0),
        ] {
            let found = f_quantile(probability, first, second);
            println!("{probability} {first} {second}: {found:.4}, table {table:.4}");
            assert!((found / table - 1.0).abs() < 2e-5);
        }
    }
}
