//! How far a calibrated robot can be trusted, configuration by configuration (theory.md §9 (39) to (43)).

mod bootstrap;
mod clusters;
mod discrepancy;
mod folds;
mod motions;
mod neighbours;
mod pattern;
mod prediction;
mod view;

pub use bootstrap::{Bootstrap, bootstrap};
pub use discrepancy::{Discrepancy, discrepancy};
pub use folds::{CrossValidation, LeftOut, cross_validate};
pub use pattern::{Pattern, strongest_pattern};
pub use prediction::{PredictedError, bound};
pub use view::View;

use motions::{motions, products};

use nalgebra::{DMatrix, Matrix3};

use crate::analysis::PLAUSIBLE;
use crate::estimate::{Estimate, Linkage, Packed, Sight};
use crate::linalg::{self, Factor};
use crate::measurement::Noise;
use crate::problem::Layout;

/// Configurations whose motions are worked out together: enough for a quick product, few enough for the cache.
const TOGETHER: usize = 32;

/// Covariance of an estimate's unknowns, and what the model does not describe.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncertainty {
    /// The estimate that it is about.
    pub estimate: Estimate,
    /// The unknowns and their scales.
    pub layout: Layout,
    /// Covariance of the scaled unknowns (square metres), row-major `n × n`, with [`Uncertainty::inflation`] in it.
    pub covariance: Vec<f64>,
    /// By how much the covariance is larger than white noise alone would make it.
    pub inflation: f64,
    /// Standard deviation of each component of what the model does not describe, device axes: the same at every configuration.
    pub discrepancy: Noise,
    /// Metres that a radian counts in the scaled unknowns.
    pub length_m: f64,
}

impl Uncertainty {
    /// From whitened information (upper triangle of `JᵀJ`) with residuals of this variance. `None` if a number is not finite.
    #[must_use]
    pub fn new(
        estimate: Estimate,
        layout: Layout,
        gram: &[f64],
        variance: f64,
        length_m: f64,
        found: &Discrepancy,
    ) -> Option<Self> {
        let variance = variance * found.inflation;
        let covariance = covariance(&factor(gram, layout.dim(), variance, length_m)?, variance)?;
        Some(Uncertainty {
            estimate,
            layout,
            covariance,
            inflation: found.inflation,
            discrepancy: found.standard_deviation,
            length_m,
        })
    }

    /// Variance of a quantity that changes by `row` with each scaled unknown.
    #[must_use]
    pub fn variance(&self, row: &[f64]) -> f64 {
        let n = self.layout.dim().max(1);
        self.covariance
            .chunks_exact(n)
            .zip(row)
            .map(|(covariance, a)| a * covariance.iter().zip(row).map(|(c, b)| c * b).sum::<f64>())
            .sum::<f64>()
            .max(0.0)
    }

    /// The error to expect of predicted targets, one for each row of joint values.
    #[must_use]
    pub fn predictions(&self, packed: &Packed, target: usize) -> Vec<PredictedError> {
        self.predictions_of((0..packed.rows()).map(|row| (row, target)), packed)
    }

    /// The error to expect of each `(row of joint values, target)`.
    #[must_use]
    pub fn predictions_of(
        &self,
        rows: impl Iterator<Item = (usize, usize)>,
        packed: &Packed,
    ) -> Vec<PredictedError> {
        let errors = self.spread::<2>(rows.map(in_first), packed).into_iter();
        errors.map(|[position, rotation]| PredictedError { position, rotation }).collect()
    }

    /// [`Uncertainty::predictions`], covariances of the place alone, square metres.
    pub(crate) fn positions(&self, packed: &Packed, target: usize) -> Vec<Matrix3<f64>> {
        self.spread::<1>((0..packed.rows()).map(|row| in_first((row, target))), packed).into_flattened()
    }

    /// Covariances of the place, and of the turn if they are two.
    fn spread<const PARTS: usize>(
        &self,
        rows: impl Iterator<Item = (usize, Sight)>,
        packed: &Packed,
    ) -> Vec<[Matrix3<f64>; PARTS]> {
        let linkage = Linkage::new(&self.estimate);
        let n = self.layout.dim();
        let covariance = DMatrix::from_row_slice(n, n, &self.covariance);
        let own = [self.discrepancy.position_m, self.discrepancy.rotation_rad]
            .map(|sigma| Matrix3::identity() * (sigma * sigma));
        let rows: Vec<(usize, Sight)> = rows.collect();
        let mut found = Vec::with_capacity(rows.len());
        for some in rows.chunks(TOGETHER) {
            let motions = motions(&self.layout, &linkage, packed, some, PARTS);
            let spread = &motions * &covariance;
            found.extend((0..some.len()).map(|at| {
                std::array::from_fn(|part| products(&motions, &spread, 3 * (PARTS * at + part)) + own[part])
            }));
        }
        found
    }
}

/// What is predicted is said in the frame of the first place that the device stood at.
fn in_first((row, target): (usize, usize)) -> (usize, Sight) {
    (row, Sight::from(target))
}

/// Factor of `JᵀJ + variance · I / prior²`.
fn factor(gram: &[f64], n: usize, variance: f64, length_m: f64) -> Option<Factor> {
    linalg::cholesky(gram, n, prior_information(length_m) * variance)
}

/// `(JᵀJ / variance + I / prior²)⁻¹` from [`factor`], row-major; `None` if a number is not finite.
fn covariance(factor: &Factor, variance: f64) -> Option<Vec<f64>> {
    let mut covariance = linalg::inverse(factor);
    covariance.iter_mut().for_each(|value| *value *= variance);
    covariance.iter().all(|value| value.is_finite()).then_some(covariance)
}

/// Mean over rows of `Σ v_k v_lᵀ`, row-major: how much a step of the unknowns moves predicted places, squared.
fn position_information(view: &View<'_>, rows: &[u32]) -> Vec<f64> {
    let problem = view.problem(Vec::new());
    let layout = problem.layout();
    let linkage = Linkage::new(view.estimate);
    let mut sum = DMatrix::zeros(layout.dim(), layout.dim());
    for some in rows.chunks(TOGETHER) {
        let motions = motions(layout, &linkage, view.packed, &view.with_sights(some), 1);
        sum += motions.transpose() * motions;
    }
    (sum / rows.len().max(1) as f64).as_slice().to_vec()
}

/// Information of the drawing about each scaled unknown, per square metre: it bounds what the data leave open.
fn prior_information(length_m: f64) -> f64 {
    1.0 / (PLAUSIBLE * length_m).powi(2)
}
