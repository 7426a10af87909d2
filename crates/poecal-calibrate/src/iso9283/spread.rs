//! Pose repeatability: mean distance from the barycentre plus three standard deviations, with and without the noise of the instrument.

use nalgebra::{Matrix3, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::figure::FigureBounds;
use super::intervals::mean_and_covariance;
use poecal_model::simulate::random::normal;
use poecal_numerics::linalg::symmetric_eigen;

/// Standard deviations that the standard adds (7.2.2).
pub(super) const DEVIATIONS: f64 = 3.0;
/// Repetitions of the bootstrap, and its seed: an interval depends on nothing else.
const REPETITIONS: usize = 1000;
const SEED: u64 = 9283;
/// Repetitions below and above the interval.
const OUTSIDE: usize = REPETITIONS / 40;

/// RP of positions: `l̄ + 3 S_l`, of distances `l_j` from the barycentre.
pub(super) fn repeatability(places: &[Vector3<f64>]) -> f64 {
    let count = places.len().max(1) as f64;
    let middle = places.iter().sum::<Vector3<f64>>() / count;
    let lengths = || places.iter().map(|it| (it - middle).norm());
    let mean = lengths().sum::<f64>() / count;
    let squares: f64 = lengths().map(|it| (it - mean).powi(2)).sum();
    mean + DEVIATIONS * (squares / (count - 1.0).max(1.0)).sqrt()
}

/// Eigenvalues of a covariance, none below zero.
fn variances(covariance: &Matrix3<f64>) -> [f64; 3] {
    let upper: Vec<f64> = covariance.transpose().iter().copied().collect();
    let (values, _) = symmetric_eigen(&upper, 3);
    std::array::from_fn(|k| values.get(k).copied().unwrap_or(0.0).max(0.0))
}

/// RP of normally distributed positions with these variances along their principal axes: `E|x| + 3 √(tr Σ - E²|x|)`, with
/// `E|x| = (4π)^-½ ∫ (1 - ∏(1 + 2 λ_k t)^-½) t^-3/2 dt` by the trapezoidal rule over ln t.
fn of_normal(variances: [f64; 3]) -> f64 {
    const STEP: f64 = 0.5;
    const STEPS: i32 = 160;
    let total: f64 = variances.iter().sum();
    if total <= 0.0 {
        return 0.0;
    }
    let term = |k: i32| {
        let s = STEP * f64::from(k);
        let t = s.exp();
        // 1 - φ(t) by logarithms, since it is small for small t.
        let exponent: f64 = variances.iter().map(|it| (2.0 * it / total * t).ln_1p()).sum();
        -(-0.5 * exponent).exp_m1() * (-0.5 * s).exp()
    };
    let integral: f64 = (-STEPS..=STEPS).map(term).sum::<f64>() * STEP;
    let mean = integral / (4.0 * std::f64::consts::PI).sqrt();
    total.sqrt() * (mean + DEVIATIONS * (1.0 - mean * mean).max(0.0).sqrt())
}

/// The variances that are left without noise in every direction; their sum is kept where one would be negative.
fn remove_noise(variances: [f64; 3], noise: f64) -> [f64; 3] {
    let total = (variances.iter().sum::<f64>() - 3.0 * noise).max(0.0);
    let left = variances.map(|it| (it - noise).max(0.0));
    let sum: f64 = left.iter().sum();
    if sum > 0.0 { left.map(|it| it * total / sum) } else { [0.0; 3] }
}

/// RP with its interval, and the same without noise of this variance in each component, if it is stated. Positions are taken for normally
/// distributed; the interval is that of the ratio to the true RP in a parametric bootstrap.
pub(super) fn with_interval(
    places: &[Vector3<f64>],
    noise_variance: Option<f64>,
) -> (FigureBounds, Option<FigureBounds>) {
    let found = repeatability(places);
    let own = variances(&mean_and_covariance(places.iter().copied()).1);
    let expected = of_normal(own);
    if expected <= 0.0 {
        let none = FigureBounds { found, from: found, to: found };
        return (none, noise_variance.map(|_| none));
    }
    let roots = own.map(f64::sqrt);
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut ratios: Vec<f64> = (0..REPETITIONS)
        .map(|_| {
            let one = |random: &mut ChaCha8Rng| Vector3::from_fn(|k, _| roots[k] * normal(random));
            let drawn: Vec<Vector3<f64>> = places.iter().map(|_| one(&mut random)).collect();
            repeatability(&drawn) / expected
        })
        .collect();
    ratios.sort_unstable_by(f64::total_cmp);
    let at = |k: usize| found / ratios.get(k).copied().unwrap_or(1.0);
    let bounds = FigureBounds { found, from: at(REPETITIONS - 1 - OUTSIDE), to: at(OUTSIDE) };
    let without = noise_variance.map(|noise| {
        // The scatter whose RP this would be, in the measured shape.
        let free = |raw: f64| of_normal(remove_noise(own.map(|it| it * (raw / expected).powi(2)), noise));
        let share = of_normal(remove_noise(own, noise)) / expected;
        FigureBounds { found: found * share, from: free(bounds.from), to: free(bounds.to) }
    });
    (bounds, without)
}
