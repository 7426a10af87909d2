//! A finished fit, as input of its uncertainty.

use std::cmp::Ordering;

use crate::analysis::{PLAUSIBLE, ranges};
use crate::parameters::Parameter;
use crate::problem::{Layout, Prior, Problem};
use crate::state::{Estimate, Session, Sight};
use poecal_model::measurement::{ByQuantity, Noise};
use poecal_numerics::solve::NormalEquations;

/// Prior of the unknowns: its information and gradient at the optimum, in the units of the scaled unknowns (metres), not whitened. The Λ
/// of theory.md §6 (27a).
#[derive(Clone, Debug)]
pub struct PriorInformation {
    /// Upper triangle of the information, 1/m², and the gradient.
    pub normal: NormalEquations,
    /// True if the fit contained the prior; if not, it only bounds undetermined directions.
    pub is_fitted: bool,
    /// Parts for the joints' axes and for their terms; empty for a prior that the fit did not contain.
    pub parts: Vec<NormalEquations>,
    /// Weight of the prior in the fit relative to whitened residuals; `None` if that was the variance of these.
    pub weight: Option<f64>,
}

impl PriorInformation {
    /// The information of a prior at an estimate (theory.md §6 (27a)); without a prior, `I/(0.03 L)²` (theory.md §9, below (39)).
    #[must_use]
    pub fn new(prior: Option<&Prior>, estimate: &Estimate, layout: &Layout, length_m: f64) -> Self {
        if let Some(prior) = prior {
            let mut found = Self::of_weight((prior, 1.0 / prior.looseness(estimate)), estimate, layout);
            // Terms that were freed one by one have no information on each other.
            found.parts.truncate(1);
            return found;
        }
        let n = layout.dim();
        let mut normal = NormalEquations::new(n);
        let information = 1.0 / (PLAUSIBLE * length_m).powi(2);
        normal.gram.iter_mut().step_by(n + 1).for_each(|value| *value = information);
        PriorInformation { normal, is_fitted: false, parts: Vec::new(), weight: None }
    }

    /// Information of a prior of some weight that was in the fit.
    #[must_use]
    pub fn of_weight((prior, weight): (&Prior, f64), estimate: &Estimate, layout: &Layout) -> Self {
        let of = |prior: &Prior| {
            let mut normal = NormalEquations::new(layout.dim());
            prior.add(estimate, layout, weight, &mut normal);
            normal
        };
        let parts = prior.parts().iter().map(of).collect();
        PriorInformation { normal: of(prior), is_fitted: true, parts, weight: None }
    }

    /// No information of `n` unknowns.
    #[must_use]
    pub fn zero(n: usize) -> Self {
        PriorInformation { normal: NormalEquations::new(n), is_fitted: false, parts: Vec::new(), weight: None }
    }

    /// The same information with directions that are a choice, such as motions of the base without effect: as if they were known.
    #[must_use]
    pub fn with_chosen(mut self, directions: &[Vec<f64>], length_m: f64) -> Self {
        const CHOSEN: f64 = 1e-6;
        let information = 1.0 / (CHOSEN * length_m).powi(2);
        for direction in directions {
            let n = direction.len();
            for (k, value) in self.normal.gram.iter_mut().enumerate() {
                *value += information * direction[k / n] * direction[k % n];
            }
        }
        self
    }

    /// Upper triangle of `N + s²Λ`, the H of theory.md §9 (39), from that of N and the variance s² of the whitened residuals.
    #[must_use]
    pub fn added_to(&self, gram: &[f64], variance: f64) -> Vec<f64> {
        gram.iter().zip(&self.normal.gram).map(|(measured, prior)| measured + variance * prior).collect()
    }
}

/// Session, rows, unknowns and optimum of a fit.
#[derive(Clone, Copy, Debug)]
pub struct FitView<'a> {
    /// Robot and measurements.
    pub session: Session<'a>,
    /// Rows of the fit.
    pub rows: &'a [u32],
    /// Unknowns.
    pub free: &'a [Parameter],
    /// Noise with which residuals were whitened.
    pub noise: Noise,
    /// For each quantity, true if that noise is stated rather than estimated.
    pub noise_is_stated: ByQuantity<bool>,
    /// Prior of the unknowns.
    pub prior: &'a PriorInformation,
    /// Variance of the whitened residuals.
    pub variance: f64,
    /// Optimum.
    pub estimate: &'a Estimate,
}

impl<'a> FitView<'a> {
    /// The problem of some of the rows.
    pub(crate) fn problem(&self, rows: Vec<u32>) -> Problem<'a> {
        Problem::new(self.session, rows, self.free.to_vec(), self.noise)
    }

    /// Rows with their targets and stations.
    pub(crate) fn with_sights(&self, rows: &[u32]) -> Vec<(usize, Sight)> {
        rows.iter().map(|&row| (row as usize, Sight::from(self.session.observation(row)))).collect()
    }

    /// Joint values of a row.
    pub(crate) fn values(&self, row: u32) -> &'a [f64] {
        self.session.packed.joint_values(row as usize)
    }

    /// Sampled range of each joint in some rows, radians or metres.
    pub(crate) fn spans(&self, rows: &[u32]) -> Vec<f64> {
        let ranges = ranges(&self.session, rows);
        ranges.into_iter().map(|(least, most)| most - least).collect()
    }

    /// Rows in the order of a joint's value.
    pub(crate) fn sorted_by(&self, rows: &[u32], joint: usize) -> Vec<u32> {
        let mut sorted = rows.to_vec();
        sorted.sort_unstable_by(|&a, &b| self.by_joint(joint, a, b));
        sorted
    }

    /// Order of two rows by a joint's value, and then by number.
    pub(crate) fn by_joint(&self, joint: usize, a: u32, b: u32) -> Ordering {
        self.values(a)[joint].total_cmp(&self.values(b)[joint]).then(a.cmp(&b))
    }
}
