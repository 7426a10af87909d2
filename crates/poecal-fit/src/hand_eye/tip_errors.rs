//! Uncertainty of tips: by the errors of touches, and by those of the arm, which follow its orientation.
//!
//! An arm has similar errors in similar orientations. An error that follows the orientation linearly is a shift of the tip, which no touch
//! determines. So errors have a share that is independent from touch to touch, and a share that is correlated. The correlation is by the angle
//! between orientations, or by the tilt of the direction about which the flange turned most. Several such shares are weighted by their restricted
//! likelihood. Each adds a shift of the arm that is not observable (theory.md §9, *The tip of a tool*).

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::touches::{TouchFit, TouchLayout};
use poecal_arm::lie::Pose;
use poecal_numerics::linalg;

/// Angle over which errors of an arm are correlated, radians.
const ALIKE: f64 = 1.0;
/// Shares of the variance that follow the orientation.
const SHARES: [f64; 2] = [0.5, 0.9];
/// Variance of the shift of the flange that no touch determines, over that of the arm's share. The arms have errors of the axes of 0.03° to 0.1° and
/// 0.2 to 0.5 mm. With 4 to 12 touches, 93 % to 96 % of the tips are then inside their bounds.
const UNSEEN: f64 = 0.7;
/// Largest number of touches that are evaluated; of more, as many in equal steps.
const MOST: usize = 300;

/// Correlation of the tip's errors.
#[derive(Clone, Copy)]
enum TipErrorPattern {
    /// Independent touches.
    Never,
    /// By the angle between two orientations.
    Turned(f64),
    /// By the angle between a direction of the flange in both.
    Tilted(f64),
}

/// Covariance of the unknowns (tips, then points), m²; `about` is the direction of the flange about which it turned most. `None` if touches do not
/// determine them.
pub(crate) fn covariance(
    poses: &[Pose],
    layout: &TouchLayout,
    fit: &TouchFit,
    about: &Vector3<f64>,
) -> Option<DMatrix<f64>> {
    let kept: Vec<usize> = (0..poses.len()).filter(|&row| fit.kept[row]).collect();
    let kept: Vec<usize> = kept.iter().copied().step_by(kept.len().div_ceil(MOST).max(1)).collect();
    let mut kinds = vec![TipErrorPattern::Never];
    kinds.extend(SHARES.map(TipErrorPattern::Turned));
    kinds.extend(SHARES.map(TipErrorPattern::Tilted));
    let touches = CountedTouches { poses, layout, kept: &kept };
    let found: Option<Vec<TipErrorFit>> = kinds.iter().map(|kind| touches.fit_correlated(*kind, about)).collect();
    let found = found?;
    let most = found.iter().map(|it| it.likelihood).fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = found.iter().map(|it| (it.likelihood - most).exp()).collect();
    let all: f64 = weights.iter().sum();
    let n = layout.unknowns();
    let mut sum = DMatrix::zeros(n, n);
    for (fitted, weight) in found.iter().zip(&weights) {
        // The estimate is that of independent touches.
        let off = &fitted.unknowns - DVector::from_row_slice(&fit.unknowns);
        sum += (&fitted.covariance + &off * off.transpose()) * (weight / all);
    }
    Some(sum)
}

/// Touches that count.
struct CountedTouches<'a> {
    poses: &'a [Pose],
    layout: &'a TouchLayout,
    kept: &'a [usize],
}

/// A fit with errors of one kind.
struct TipErrorFit {
    unknowns: DVector<f64>,
    covariance: DMatrix<f64>,
    /// Logarithm of the restricted likelihood, but for a constant.
    likelihood: f64,
}

impl CountedTouches<'_> {
    /// Generalised least squares of the touches with correlated errors.
    fn fit_correlated(&self, kind: TipErrorPattern, about: &Vector3<f64>) -> Option<TipErrorFit> {
        let (m, n) = (self.kept.len(), self.layout.unknowns());
        let alike = DMatrix::from_fn(m, m, |i, j| self.error_correlation(kind, (i, j), about));
        let factor = linalg::cholesky(alike.as_slice(), m, 0.0)?;
        let between = linalg::inverse(&factor);
        let mut gram = DMatrix::zeros(n, n);
        let mut right = DVector::zeros(n);
        for i in 0..m {
            for j in 0..m {
                let weight = between[i * m + j];
                let (one, other) = (self.columns(i), self.columns(j));
                let shown = -self.poses[self.kept[j]].translation;
                for (a, first) in &one {
                    let by = first.transpose() * weight;
                    let mut part = right.fixed_rows_mut::<3>(*a);
                    part += by * shown;
                    for (b, second) in &other {
                        let mut block = gram.fixed_view_mut::<3, 3>(*a, *b);
                        block += by * second;
                    }
                }
            }
        }
        let normal = linalg::cholesky(gram.as_slice(), n, 0.0)?;
        let unknowns = linalg::cholesky_solve(&normal, right.as_slice());
        let all = self.layout.misses(self.poses, &unknowns);
        let misses: Vec<Vector3<f64>> = self.kept.iter().map(|&row| all[row]).collect();
        let squares: f64 = (0..m * m).map(|k| between[k] * misses[k / m].dot(&misses[k % m])).sum();
        let freedom = (3 * m - n) as f64;
        let variance = squares / freedom.max(1.0);
        let mut covariance = DMatrix::from_row_slice(n, n, &linalg::inverse(&normal)) * variance;
        let unseen = UNSEEN * kind.share() * variance;
        let tips = self.layout.tips.len();
        for (one, other) in (0..tips).flat_map(|one| (0..tips).map(move |other| (one, other))) {
            let mut block = covariance.fixed_view_mut::<3, 3>(3 * one, 3 * other);
            block += Matrix3::identity() * unseen;
        }
        let determinants = 3.0 * log_determinant(&alike)? + log_determinant(&gram)?;
        let likelihood = -0.5 * (determinants + freedom * squares.max(f64::MIN_POSITIVE).ln());
        let unknowns = DVector::from_vec(unknowns);
        let is_finite = covariance.iter().chain(unknowns.iter()).all(|it| it.is_finite());
        (is_finite && likelihood.is_finite()).then_some(TipErrorFit { unknowns, covariance, likelihood })
    }

    /// Derivatives of a touch by its tip and its point, each with its first unknown.
    fn columns(&self, at: usize) -> [(usize, Matrix3<f64>); 2] {
        let row = self.kept[at];
        let (tip, point) = self.layout.rows[row];
        [(3 * tip, self.poses[row].rotation), (3 * (self.layout.tips.len() + point), -Matrix3::identity())]
    }

    /// Correlation of the errors of two touches.
    fn error_correlation(&self, kind: TipErrorPattern, (i, j): (usize, usize), about: &Vector3<f64>) -> f64 {
        if i == j {
            return 1.0;
        }
        let between = self.poses[self.kept[i]].rotation.transpose() * self.poses[self.kept[j]].rotation;
        let cosine = match kind {
            TipErrorPattern::Never => return 0.0,
            TipErrorPattern::Turned(_) => 0.5 * (between.trace() - 1.0),
            TipErrorPattern::Tilted(_) => about.dot(&(between * about)),
        };
        let angle = cosine.clamp(-1.0, 1.0).acos();
        kind.share() * (-0.5 * (angle / ALIKE).powi(2)).exp()
    }
}

impl TipErrorPattern {
    /// Share of the variance that follows the orientation.
    fn share(self) -> f64 {
        match self {
            TipErrorPattern::Never => 0.0,
            TipErrorPattern::Turned(share) | TipErrorPattern::Tilted(share) => share,
        }
    }
}

/// Logarithm of the determinant of a symmetric matrix; `None` if it is not positive definite.
fn log_determinant(matrix: &DMatrix<f64>) -> Option<f64> {
    let (values, _) = linalg::symmetric_eigen(matrix.as_slice(), matrix.nrows());
    values.iter().all(|it| *it > 0.0).then(|| values.iter().map(|it| it.ln()).sum())
}
