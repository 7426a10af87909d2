//! How far a calibrated robot can be trusted, configuration by configuration (theory.md §9 (39) to (43)).

mod bootstrap;
mod clusters;
mod discrepancy;
mod folds;
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

use prediction::propagated;

use nalgebra::{Matrix3, Vector3};

use crate::analysis::PLAUSIBLE;
use crate::estimate::{Chain, Estimate, Linkage, Packed};
use crate::linalg;
use crate::measurement::Noise;
use crate::problem::Layout;

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
        let covariance = covariance(gram, layout.dim(), variance * found.inflation, length_m)?;
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
        let linkage = Linkage::new(&self.estimate);
        let mut chain = Chain::default();
        let mut twists = vec![(Vector3::zeros(), Vector3::zeros()); self.layout.dim()];
        let own = |sigma: f64| Matrix3::identity() * (sigma * sigma);
        rows.map(|(row, target)| {
            chain.evaluate(&linkage, packed, row, target);
            self.layout.target_twists(&chain, target, &mut twists);
            let (position, rotation) = propagated(&self.covariance, &twists);
            PredictedError {
                position: position + own(self.discrepancy.position_m),
                rotation: rotation + own(self.discrepancy.rotation_rad),
            }
        })
        .collect()
    }
}

/// `(JᵀJ / variance + I / prior²)⁻¹`, row-major and whole.
fn covariance(gram: &[f64], n: usize, variance: f64, length_m: f64) -> Option<Vec<f64>> {
    let variance = variance.max(f64::MIN_POSITIVE);
    let factor = linalg::cholesky(gram, n, prior_information(length_m) * variance)?;
    let mut covariance = vec![0.0; n * n];
    for (k, column) in covariance.chunks_exact_mut(n.max(1)).enumerate() {
        let mut unit = vec![0.0; n];
        unit[k] = variance;
        column.copy_from_slice(&linalg::cholesky_solve(&factor, &unit));
    }
    covariance.iter().all(|value| value.is_finite()).then_some(covariance)
}

/// Mean over rows of `Σ v_k v_lᵀ`, row-major: how much a step of the unknowns moves predicted places, squared.
fn position_information(view: &View<'_>, rows: &[u32]) -> Vec<f64> {
    let problem = view.problem(Vec::new());
    let layout = problem.layout();
    let n = layout.dim();
    let linkage = Linkage::new(view.estimate);
    let mut chain = Chain::default();
    let mut twists = vec![(Vector3::zeros(), Vector3::zeros()); n];
    let mut sum = vec![0.0; n * n];
    for &row in rows {
        let target = view.data.observations[row as usize].target;
        chain.evaluate(&linkage, view.packed, row as usize, target);
        layout.target_twists(&chain, target, &mut twists);
        for (out, (a, _)) in sum.chunks_exact_mut(n.max(1)).zip(&twists) {
            out.iter_mut().zip(&twists).for_each(|(value, (b, _))| *value += a.dot(b));
        }
    }
    sum.iter_mut().for_each(|value| *value /= rows.len().max(1) as f64);
    sum
}

/// Information of the drawing about each scaled unknown, per square metre: it bounds what the data leave open.
fn prior_information(length_m: f64) -> f64 {
    1.0 / (PLAUSIBLE * length_m).powi(2)
}
