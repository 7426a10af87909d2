//! Uncertainty of a calibrated robot, configuration by configuration (theory.md §9 (39) to (43)).

mod bootstrap;
mod clusters;
mod conditional;
mod correlation;
mod discrepancy;
mod folds;
mod gauge;
mod information;
mod motions;
mod neighbours;
mod pattern;
mod prediction;
mod prior_size;
mod refit;
mod residual_variance;
mod serial_correlation;
mod share;
mod view;

pub use bootstrap::{Bootstrap, bootstrap};
pub use conditional::held_covariance;
pub use correlation::Correlations;
pub use discrepancy::{Discrepancy, discrepancy};
pub use folds::{
    CrossValidation, FEWEST_VALIDATED, FoldErrors, OutsideRange, cross_validate, leave_clusters_out, parts_to_leave_out,
};
pub use pattern::{JointPattern, strongest_pattern};
pub use prediction::{PredictedError, Quantile, bound};
pub use refit::FrameRefit;
pub use residual_variance::{Attribution, KindVariance, ResidualVariance, VarianceComponents, remainder};
pub use share::Shares;
pub use view::{FitView, PriorInformation};

use gauge::Gauge;
use information::{ROUNDING, factor};
use motions::{motions, products};
use prior_size::own_size;

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use crate::analysis::ranges;
use crate::problem::Layout;
use crate::state::{Estimate, Linkage, PackedValues, Sight};
use poecal_model::measurement::{ByQuantity, Quantity};
use poecal_model::robot::JointKind;
use poecal_numerics::linalg::{self, Factor};
use poecal_numerics::solve::NormalEquations;

/// Configurations whose columns share one matrix: enough for a quick product, few enough for the cache.
const TOGETHER: usize = 32;
/// Covariance of an estimate's unknowns, and the model error beside it (theory.md §9 (39) and (41)).
#[derive(Clone, Debug, PartialEq)]
pub struct Uncertainty {
    /// Estimate.
    pub estimate: Estimate,
    /// Unknowns and their scales.
    pub layout: Layout,
    /// Covariance of the scaled unknowns (square metres), row-major `n × n`, with [`Discrepancy::scatter`] in it.
    pub covariance: Vec<f64>,
    /// Covariance outside the sampled range, with [`Discrepancy::extrapolation`]; `None` if that is no larger.
    pub covariance_outside: Option<Vec<f64>>,
    /// Relative standard deviation of the size of the robot and the cell, if no measurement has a length: it is in no covariance.
    pub size_sigma: Option<f64>,
    /// Sampled range of each joint, radians or metres.
    pub sampled: Vec<[f64; 2]>,
    /// Model error, estimated from the residuals.
    pub discrepancy: Discrepancy,
    /// Metres that a radian counts in the scaled unknowns.
    pub length_m: f64,
}

impl Uncertainty {
    /// Covariance of a fit, theory.md §9 (39) and (39d), from its whitened normal equations and its unknowns. `None` if a number is not
    /// finite.
    #[must_use]
    pub fn new(view: &FitView<'_>, layout: Layout, normal: &NormalEquations, found: &Discrepancy) -> Option<Self> {
        let gram = &normal.gram;
        let outside = (found.extrapolation > found.scatter)
            .then(|| extrapolate_covariance(gram, layout.dim(), view, found.extrapolation));
        let sampled = ranges(&view.session, view.rows);
        let covariance = own_size(inflate_covariance(gram, layout.dim(), view, found.scatter)?, normal, view);
        let gauge = Gauge::from_view(view, &layout);
        let fixed = |covariance: Vec<f64>| match &gauge {
            Some(gauge) => gauge.fix_gauge(&covariance),
            None => covariance,
        };
        Some(Uncertainty {
            estimate: view.estimate.clone(),
            size_sigma: gauge.as_ref().and_then(|it| it.size_sigma(&covariance)),
            covariance: fixed(covariance),
            covariance_outside: outside.flatten().map(fixed),
            sampled: sampled.into_iter().map(|(least, most)| [least, most]).collect(),
            layout,
            discrepancy: *found,
            length_m: view.session.length_m,
        })
    }

    /// Variance `aᵀ Σ a` of a quantity whose derivatives by the scaled unknowns are `row` (a), with the Σ of theory.md §9 (39).
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

    /// Expected errors of a target's predictions, one for each row of joint values: theory.md §9 (40), in the axes of the first station's
    /// device frame.
    #[must_use]
    pub fn predictions(&self, packed: &PackedValues, target: usize) -> Vec<PredictedError> {
        self.predictions_of((0..packed.rows()).map(|row| (row, target)), packed)
    }

    /// Expected error of each `(row of joint values, target)`: theory.md §9 (40), in the axes of the first station's device frame.
    #[must_use]
    pub fn predictions_of(
        &self,
        rows: impl Iterator<Item = (usize, usize)>,
        packed: &PackedValues,
    ) -> Vec<PredictedError> {
        let quantiles = self.quantiles();
        let errors = self.spread::<2>(rows.map(in_first), packed).into_iter();
        errors.map(|[position, rotation]| PredictedError { position, rotation, quantiles }).collect()
    }

    /// Factors by which 95 % bounds exceed those of a known covariance, of positions and of rotations: theory.md §9, below (40).
    #[must_use]
    pub fn quantiles(&self) -> ByQuantity<Quantile> {
        self.discrepancy.freedom.map(Quantile::new)
    }

    /// Covariances of predicted positions alone, square metres: `P_p` of theory.md §9 (40), in the axes of the first station's device
    /// frame.
    pub fn positions(&self, packed: &PackedValues, target: usize) -> Vec<Matrix3<f64>> {
        self.spread::<1>((0..packed.rows()).map(|row| in_first((row, target))), packed).into_flattened()
    }

    /// Derivatives by the scaled unknowns of `Σ dᵀ p` over rows of joint values. p is the predicted position of a target in each, d a
    /// vector, both in the axes of the first station's device frame.
    #[must_use]
    pub fn derivatives_along(&self, packed: &PackedValues, target: usize, vectors: &[Vector3<f64>]) -> Vec<f64> {
        let linkage = Linkage::new(&self.estimate);
        let mut sum = DVector::zeros(self.layout.dim());
        let rows: Vec<(usize, Sight)> = (0..vectors.len()).map(|row| in_first((row, target))).collect();
        for (some, vectors) in rows.chunks(TOGETHER).zip(vectors.chunks(TOGETHER)) {
            let vectors = DVector::from_iterator(3 * vectors.len(), vectors.iter().flatten().copied());
            sum += motions(&self.layout, &linkage, packed, some, 1).tr_mul(&vectors);
        }
        sum.as_slice().to_vec()
    }

    /// Distance of a configuration from the sampled range: 0 inside, 1 from a fifth of the range on. The blocks of cross-validation are a
    /// fifth of the range (theory.md §9 (41)).
    fn distance_outside(&self, values: &[f64]) -> f64 {
        const FULLY: f64 = 0.2;
        let joints = values.iter().zip(&self.sampled).zip(self.estimate.kinds());
        let beyond = joints.map(|((value, [least, most]), kind)| {
            let way = match kind {
                JointKind::Prismatic => (least - value).max(value - most),
                // Whole turns change nothing.
                JointKind::Revolute => {
                    let value = value - TAU * ((value - least) / TAU).floor();
                    (value - most).min(least + TAU - value)
                }
            };
            if way > 1e-6 { way / (FULLY * (most - least)) } else { 0.0 }
        });
        beyond.fold(0.0, f64::max).min(1.0)
    }

    /// Covariances of the position, and with two `PARTS` of the rotation: theory.md §9 (40).
    fn spread<const PARTS: usize>(
        &self,
        rows: impl Iterator<Item = (usize, Sight)>,
        packed: &PackedValues,
    ) -> Vec<[Matrix3<f64>; PARTS]> {
        let linkage = Linkage::new(&self.estimate);
        let n = self.layout.dim();
        let inside = DMatrix::from_row_slice(n, n, &self.covariance);
        let beyond = self.covariance_outside.as_ref().map(|outside| DMatrix::from_row_slice(n, n, outside));
        let own = [Quantity::Position, Quantity::Rotation]
            .map(|quantity| self.discrepancy.standard_deviation[quantity])
            .map(|sigma| Matrix3::identity() * (sigma * sigma));
        let rows: Vec<(usize, Sight)> = rows.collect();
        let mut found = Vec::with_capacity(rows.len());
        for some in rows.chunks(TOGETHER) {
            let motions = motions(&self.layout, &linkage, packed, some, PARTS);
            let spread = &motions * &inside;
            let farther: Vec<f64> =
                some.iter().map(|&(row, _)| self.distance_outside(packed.joint_values(row))).collect();
            let wider = beyond.as_ref().filter(|_| farther.iter().any(|share| *share > 0.0));
            let wider = wider.map(|covariance| products(&motions, &(&motions * covariance)));
            let nearer = products(&motions, &spread);
            found.extend(farther.into_iter().enumerate().map(|(at, share)| {
                std::array::from_fn(|part| {
                    let here = nearer[PARTS * at + part];
                    let there = wider.as_ref().filter(|_| share > 0.0).map(|there| there[PARTS * at + part]);
                    there.map_or(here, |there| here * (1.0 - share) + there * share) + own[part]
                })
            }));
        }
        found
    }
}

/// Predictions are stated in the device frame of the first station.
fn in_first((row, target): (usize, usize)) -> (usize, Sight) {
    (row, Sight::from(target))
}

/// Covariance of an estimate whose residuals scatter by `inflation` κ times as much as independent ones. With `H = N + s²Λ` and a prior Λ
/// in the fit it is `s² H⁻¹ (κ N + s²Λ) H⁻¹`, which is `s² H⁻¹` for κ = 1. Without a prior in the fit it is `κ s² (N + κ s²Λ)⁻¹`
/// (theory.md §9 (39)).
fn inflate_covariance(gram: &[f64], n: usize, view: &FitView<'_>, inflation: f64) -> Option<Vec<f64>> {
    let prior = (view.prior.normal.gram.as_slice(), view.prior.is_fitted);
    inflated_by((gram, n), prior, view.variance, inflation)
}

/// The same covariance by the upper triangles of N and Λ; `is_fitted` is true if the fit contained the prior.
fn inflated_by(
    (gram, n): (&[f64], usize),
    (prior, is_fitted): (&[f64], bool),
    variance: f64,
    inflation: f64,
) -> Option<Vec<f64>> {
    let of = |variance: f64| {
        let both: Vec<f64> = gram.iter().zip(prior).map(|(measured, prior)| measured + variance * prior).collect();
        let largest = (0..n).map(|k| both[k * n + k]).fold(0.0, f64::max);
        covariance(&linalg::cholesky(&both, n, ROUNDING * largest)?, variance)
    };
    if !is_fitted || inflation == 1.0 {
        return of(variance * inflation);
    }
    let formal = DMatrix::from_row_slice(n, n, &of(variance)?);
    let of_prior = DMatrix::from_fn(n, n, |i, j| prior[i.min(j) * n + i.max(j)]);
    let spread = &formal * inflation - &formal * of_prior * &formal * (inflation - 1.0);
    Some((&spread + spread.transpose()).scale(0.5).as_slice().to_vec())
}

/// Covariance outside the sampled range, where model error is a bias: `κ s² (N + κ s²(Λ + I/(0.1 L)²))⁻¹` with the prior Λ and the length
/// L that a radian counts (theory.md §9, below (41)).
fn extrapolate_covariance(gram: &[f64], n: usize, view: &FitView<'_>, inflation: f64) -> Option<Vec<f64>> {
    const FARTHEST: f64 = 0.1;
    let variance = view.variance * inflation;
    let mut both = view.prior.added_to(gram, variance);
    let bound = variance / (FARTHEST * view.session.length_m).powi(2);
    both.iter_mut().step_by(n + 1).for_each(|value| *value += bound);
    covariance(&linalg::cholesky(&both, n, 0.0)?, variance)
}

/// `(JᵀJ / variance + prior)⁻¹` from [`factor`], row-major: theory.md §9 (39) for κ = 1. `None` if a number is not finite.
fn covariance(factor: &Factor, variance: f64) -> Option<Vec<f64>> {
    let mut covariance = linalg::inverse(factor);
    covariance.iter_mut().for_each(|value| *value *= variance);
    covariance.iter().all(|value| value.is_finite()).then_some(covariance)
}

/// Mean over rows of `v_kᵀ v_l`, row-major: the Q of theory.md §9 (45). `δᵀ Q δ` is the mean square distance by which a step δ moves
/// predicted positions.
pub fn position_information(view: &FitView<'_>, rows: &[u32]) -> Vec<f64> {
    let problem = view.problem(Vec::new());
    let layout = problem.layout();
    let linkage = Linkage::new(view.estimate);
    let mut sum = DMatrix::zeros(layout.dim(), layout.dim());
    for some in rows.chunks(TOGETHER) {
        let motions = motions(layout, &linkage, view.session.packed, &view.with_sights(some), 1);
        sum += motions.transpose() * motions;
    }
    (sum / rows.len().max(1) as f64).as_slice().to_vec()
}
