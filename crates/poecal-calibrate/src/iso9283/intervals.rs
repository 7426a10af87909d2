//! Intervals of means, standard deviations and lengths of means, 95 %.

use nalgebra::{Matrix3, Vector3};

use super::figure::FigureBounds;
use poecal_numerics::distributions::f_quantile;

/// Degrees of freedom that stand for infinitely many.
const INFINITE: f64 = 1e6;

/// A part of the covariance of an estimate, with its degrees of freedom.
#[derive(Clone, Copy, Debug)]
pub(super) struct VariancePart {
    pub(super) covariance: Matrix3<f64>,
    pub(super) freedom: f64,
}

/// Mean of vectors, and their covariance with `n - 1` degrees of freedom.
pub(super) fn mean_and_covariance(of: impl Iterator<Item = Vector3<f64>> + Clone) -> (Vector3<f64>, Matrix3<f64>) {
    let count = of.clone().count().max(1) as f64;
    let mean = of.clone().sum::<Vector3<f64>>() / count;
    let squares: Matrix3<f64> = of.map(|it| (it - mean) * (it - mean).transpose()).sum();
    (mean, squares / (count - 1.0).max(1.0))
}

/// Degrees of freedom of a sum of estimated variances (satterthwaite1946).
fn freedom(variances: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut sum, mut squares) = (0.0, 0.0);
    for (variance, freedom) in variances {
        sum += variance;
        squares += variance * variance / freedom.max(1.0);
    }
    if squares > 0.0 { (sum * sum / squares).max(1.0) } else { INFINITE }
}

/// Student's quantile that is exceeded on either side together with this probability.
fn student(risk: f64, freedom: f64) -> f64 {
    f_quantile(risk, 1.0, freedom).sqrt()
}

/// Interval of a mean whose variance has several parts: variance and degrees of freedom each.
pub(super) fn mean(found: f64, variances: &[(f64, f64)]) -> FigureBounds {
    let sum: f64 = variances.iter().map(|it| it.0).sum();
    let half = student(0.05, freedom(variances.iter().copied())) * sum.sqrt();
    FigureBounds { found, from: found - half, to: found + half }
}

/// Interval of a standard deviation, times `factor`.
pub(super) fn deviation(found: f64, count: usize, factor: f64) -> FigureBounds {
    let freedom = (count as f64 - 1.0).max(1.0);
    let upper = f_quantile(0.025, freedom, INFINITE);
    let lower = 1.0 / f_quantile(0.025, INFINITE, freedom);
    let found = factor * found;
    FigureBounds { found, from: found / upper.sqrt(), to: found / lower.sqrt() }
}

/// Interval of the length of an error, whose estimate is too long by its scatter across: `E|e|² = |ε|² + tr C`. If the error is not shown to differ from
/// zero, the interval is one-sided, from zero.
pub(super) fn length(error: &Vector3<f64>, parts: &[VariancePart]) -> FigureBounds {
    let found = error.norm();
    let total: Matrix3<f64> = parts.iter().map(|it| it.covariance).sum();
    let along = |direction: &Vector3<f64>, of: &Matrix3<f64>| (direction.transpose() * of * direction)[0];
    let direction = if found > 0.0 { error / found } else { Vector3::x() };
    let variance = along(&direction, &total);
    let across = total.trace() - variance;
    let middle = (found * found - across).max(0.0).sqrt();
    let own = |of: fn(&Matrix3<f64>) -> f64| freedom(parts.iter().map(|it| (of(&it.covariance), it.freedom)));
    let all = own(|it| it.trace());
    // A sum of squares with as many degrees of freedom as its covariance has comparable directions.
    let directions = total.trace().powi(2) / (total * total).trace().max(f64::MIN_POSITIVE);
    let shown = found * found > total.trace() * f_quantile(0.05, directions.clamp(1.0, 3.0), all);
    let freedom = freedom(parts.iter().map(|it| (along(&direction, &it.covariance), it.freedom)));
    if shown {
        let half = student(0.05, freedom) * variance.sqrt();
        return FigureBounds { found, from: (middle - half).max(0.0), to: (middle + half).max(found) };
    }
    let widest = (total.trace() - across.min(total.trace())).max(total.trace() / directions.max(1.0));
    FigureBounds { found, from: 0.0, to: (middle + student(0.10, all) * widest.sqrt()).max(found) }
}

/// Interval of the size of a difference, by that of the difference: where this contains zero, from zero to its farther end.
fn size(found: f64, [lower, upper]: [f64; 2]) -> FigureBounds {
    let (from, to) = if lower > 0.0 { (lower, upper) } else { ((-upper).max(0.0), upper.max(-lower)) };
    FigureBounds { found: found.abs(), from, to }
}

/// Interval of the size of a difference of two independent figures, by their own intervals (zou2008).
pub(super) fn difference(first: &FigureBounds, second: &FigureBounds) -> FigureBounds {
    let found = first.found - second.found;
    let below = (first.found - first.from).hypot(second.to - second.found);
    let above = (first.to - first.found).hypot(second.found - second.from);
    size(found, [found - below, found + above])
}

/// Interval of the size of a difference of two lengths that are shown to differ from zero: each is too long by its scatter across, and a part of the
/// scatter moves both.
pub(super) fn difference_of_lengths(
    [first, second]: [(&Vector3<f64>, &[VariancePart]); 2],
    variances: &[(f64, f64)],
) -> FigureBounds {
    let middle = |(error, parts): (&Vector3<f64>, &[VariancePart])| {
        let total: Matrix3<f64> = parts.iter().map(|it| it.covariance).sum();
        let along = (error.transpose() * total * error)[0] / error.norm_squared();
        (error.norm_squared() - total.trace() + along).max(0.0).sqrt()
    };
    let bounds = mean(middle(first) - middle(second), variances);
    size(first.0.norm() - second.0.norm(), [bounds.from, bounds.to])
}
