//! Size of a robot's deviations from nominal, and of the terms of its joints, relative to their priors: theory.md §9 (39d).

use nalgebra::{DMatrix, DVector};

use super::information::factor;
use super::view::FitView;
use poecal_numerics::linalg;
use poecal_numerics::solve::NormalEquations;

/// Weight of the assumption that deviations have the size of the prior, as a number of deviations.
const BELIEVED: f64 = 2.0;
/// Least size of deviations relative to the prior, squared.
const LEAST: f64 = 0.0025;
/// Share of the largest information below which a direction has no prior.
const NONE: f64 = 1e-12;
/// Largest number of steps by which the sizes of the parts are estimated together; each halves the remaining change at least.
const STEPS: usize = 40;

/// A part of the prior, with its part of the covariance.
struct PriorPart {
    information: DMatrix<f64>,
    /// `s⁴ H⁻¹ Λ H⁻¹`.
    covariance: DMatrix<f64>,
    /// Square of the deviations in units of the prior, and its expectation from noise.
    found: f64,
    of_noise: f64,
    size: f64,
}

/// A covariance (row-major) with the parts of the prior scaled to the sizes of the deviations: (39d). The input is the covariance with the
/// prior's sizes, and the normal equations of the measurements.
pub(super) fn own_size(covariance: Vec<f64>, measured: &NormalEquations, view: &FitView<'_>) -> Vec<f64> {
    let n = measured.gradient.len();
    let prior = view.prior;
    let Some(factor) = factor(&measured.gram, n, prior, view.variance).filter(|_| prior.is_fitted) else {
        return covariance;
    };
    let formal = DMatrix::from_row_slice(n, n, &linalg::inverse(&factor)) * view.variance;
    let pull = measured.gradient.iter().zip(&prior.normal.gradient);
    let pull = DVector::from_iterator(n, pull.map(|(data, prior)| data / view.variance + prior));
    // Terms that are possible and were not fitted are at the end of one step.
    let step = &formal * pull;
    let mut full = DMatrix::from_row_slice(n, n, &covariance);
    let parts = prior.parts.iter().filter(|part| part.gram.iter().any(|value| *value > 0.0));
    let mut parts: Vec<PriorPart> = parts.map(|part| PriorPart::new(part, &formal, &step)).collect();
    let noise = parts.iter().fold(full.clone(), |noise, part| noise - &part.covariance);
    for part in &mut parts {
        part.of_noise = part.information.dot(&noise).max(0.0);
    }
    settle(&mut parts, &formal);
    for part in &parts {
        full -= &part.covariance * (1.0 - part.size);
    }
    (&full + full.transpose()).scale(0.5).as_slice().to_vec()
}

impl PriorPart {
    fn new(part: &NormalEquations, formal: &DMatrix<f64>, step: &DVector<f64>) -> Self {
        let n = step.len();
        let information = DMatrix::from_fn(n, n, |i, j| part.gram[i.min(j) * n + i.max(j)]);
        let along: f64 = part.gradient.iter().zip(step.iter()).map(|(pull, step)| pull * step).sum();
        let found = 2.0 * part.cost - 2.0 * along + step.dot(&(&information * step));
        let covariance = formal * &information * formal;
        PriorPart { information, covariance, found: found.max(0.0), of_noise: 0.0, size: 1.0 }
    }

    /// Expected square for deviations of the size of the prior: the trace of `(I - P)²`.
    fn determined_part(&self, formal: &DMatrix<f64>) -> f64 {
        // Unknowns without information in the part are no directions of it.
        let own: Vec<usize> = (0..self.information.nrows()).filter(|&at| self.information[(at, at)] > 0.0).collect();
        let some = self.information.select_rows(&own).select_columns(&own);
        let (values, _) = linalg::symmetric_eigen(some.as_slice(), own.len());
        let largest = values.iter().fold(0.0, |most: f64, value| most.max(*value));
        let directions = values.iter().filter(|value| **value > NONE * largest).count() as f64;
        let shares = formal * &self.information;
        (directions - 2.0 * shares.trace() + self.information.dot(&self.covariance)).max(0.0)
    }
}

/// Estimates the sizes of all parts, each with those of the others.
fn settle(parts: &mut [PriorPart], formal: &DMatrix<f64>) {
    let determined: Vec<f64> = parts.iter().map(|part| part.determined_part(formal)).collect();
    for _ in 0..STEPS {
        for at in 0..parts.len() {
            let others = (0..parts.len()).filter(|&other| other != at);
            let of_others: f64 =
                others.map(|other| parts[other].size * parts[at].information.dot(&parts[other].covariance)).sum();
            let part = &mut parts[at];
            let own = part.found - part.of_noise - of_others;
            part.size = ((own + BELIEVED) / (determined[at] + BELIEVED)).clamp(LEAST, 1.0);
        }
    }
}
