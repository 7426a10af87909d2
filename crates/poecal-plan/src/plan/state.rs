//! Expected errors of a fit, and their change by adding or removing a configuration (docs/theory.md, *Choosing configurations*).

use nalgebra::DMatrix;

use super::change::{ChangedRows, PlanChange, add, dot, product};
use super::experiment::inverse;

/// Weights of the minimised criterion: of the expected squared errors of the calibrated and of the corrected model, and of the logarithm of the
/// determinant of geometry's covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CriterionWeights {
    pub(crate) calibrated: f64,
    pub(crate) corrected: f64,
    pub(crate) determinant: f64,
}

/// Constants of the choice of configurations: priors, and moments of the workspace.
#[derive(Clone, Debug)]
pub(crate) struct CriterionContext {
    /// Number of unknowns of geometry; those after them are modes of unit prior.
    pub(crate) geometry: usize,
    /// Prior information of all unknowns.
    pub(crate) prior: DMatrix<f64>,
    /// Moments of the workspace.
    pub(crate) moments: DMatrix<f64>,
    pub(crate) weights: CriterionWeights,
    /// Information of rows for the calibrated model, which treats undescribed errors as noise, as a share of that for the corrected one.
    pub(crate) share: f64,
}

/// Expected squared errors over the workspace, m².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct WorkspaceErrors {
    /// Error of the calibrated model by noise and prior, if all undescribed errors were noise.
    pub(crate) noise: f64,
    /// The same error with the true noise.
    pub(crate) true_noise: f64,
    /// Error of the calibrated model by its missing terms.
    pub(crate) terms: f64,
    /// Error of the corrected model.
    pub(crate) corrected: f64,
    /// Logarithm of the determinant of geometry's information.
    pub(crate) determinant: f64,
}

impl WorkspaceErrors {
    /// Minimised error of the calibrated model.
    pub(crate) fn calibrated_error(&self) -> f64 {
        self.noise + self.terms
    }

    /// Minimised criterion.
    pub(crate) fn value(&self, weights: &CriterionWeights) -> f64 {
        weights.calibrated * self.calibrated_error() + weights.corrected * self.corrected
            - weights.determinant * self.determinant
    }
}

impl CriterionContext {
    /// Prior information with unit priors of modes.
    pub(crate) fn new(prior: &DMatrix<f64>, moments: DMatrix<f64>, weights: CriterionWeights, share: f64) -> Self {
        let (g, n) = (prior.nrows(), moments.nrows());
        let mut all = DMatrix::identity(n, n);
        all.view_mut((0, 0), (g, g)).copy_from(prior);
        CriterionContext { geometry: g, prior: all, moments, weights, share }
    }

    pub(crate) fn modes(&self) -> usize {
        self.moments.nrows() - self.geometry
    }

    /// Moments of geometry, of geometry with modes, and of modes.
    fn parts(&self) -> [DMatrix<f64>; 3] {
        let (g, c) = (self.geometry, self.modes());
        let part = |at, size| self.moments.view(at, size).into_owned();
        [part((0, 0), (g, g)), part((0, g), (g, c)), part((g, g), (c, c))]
    }
}

/// Covariances of a fit with some information, and further matrices of the criterion.
#[derive(Clone, Debug)]
pub(crate) struct CovarianceState {
    /// Covariance of all unknowns, and `H⁻¹ M H⁻¹`.
    pub(crate) all: [DMatrix<f64>; 2],
    /// The same of geometry alone.
    pub(crate) own: [DMatrix<f64>; 2],
    /// Bias of geometry by terms, `A = H⁻¹ J_gᵀ J_c`, and `E = H⁻¹ (M_gg A - M_gc)`.
    pull: [DMatrix<f64>; 2],
}

impl CovarianceState {
    /// State by the information of measurements; `None` if it is not positive definite with the prior.
    pub(crate) fn new(aim: &CriterionContext, gram: &DMatrix<f64>) -> Option<(CovarianceState, WorkspaceErrors)> {
        let (g, c) = (aim.geometry, aim.modes());
        let [mgg, mgc, mcc] = aim.parts();
        let prior = aim.prior.view((0, 0), (g, g));
        let h = gram.view((0, 0), (g, g)) * aim.share + prior;
        let own = inverse(&h)?;
        let spread = &mgg * &own;
        let a = &own * gram.view((0, g), (g, c)) * aim.share;
        let d = &mgg * &a - &mgc;
        let bias = a.dot(&(&d - &mgc)) + mcc.trace();
        let determinant = if aim.weights.determinant > 0.0 { log_determinant(&h)? } else { 0.0 };
        let e = &own * &d;
        let p = &own * &spread;
        // H⁻¹ (share² N + Λ) H⁻¹ with share N = H - Λ.
        let noise = spread.trace();
        let true_noise = aim.share * noise + (1.0 - aim.share) * p.dot(&prior);
        let mut squares = WorkspaceErrors { noise, true_noise, terms: bias.max(0.0), corrected: 0.0, determinant };
        let (all, q) = if aim.weights.corrected > 0.0 {
            let all = inverse(&(gram + &aim.prior))?;
            let spread = &aim.moments * &all;
            squares.corrected = spread.trace();
            let q = &all * &spread;
            (all, q)
        } else {
            (DMatrix::zeros(0, 0), DMatrix::zeros(0, 0))
        };
        Some((CovarianceState { all: [all, q], own: [own, p], pull: [a, e] }, squares))
    }

    /// Change by adding (`sign` 1) or removing (-1) these rows; `None` if the rest would not be positive definite.
    pub(crate) fn change(&self, aim: &CriterionContext, rows: &[f64], numbers: usize, sign: f64) -> Option<PlanChange> {
        let (g, c) = (aim.geometry, aim.modes());
        let n = g + c;
        let scaled = scale_rows(rows, aim);
        let own = ChangedRows::new(&self.own, &scaled, (numbers, n, g), sign)?;
        let all = if self.all[0].nrows() > 0 {
            Some(ChangedRows::new(&self.all, rows, (numbers, n, n), sign)?)
        } else {
            None
        };
        // R = J_c - J_g A and Z = J_g E.
        let (mut r, mut z) = (vec![0.0; numbers * c], vec![0.0; numbers * c]);
        own_rows(self, aim, &scaled, numbers, &mut r, &mut z);
        let m = numbers;
        let (mut pulled, mut turned) = (vec![0.0; m * c], vec![0.0; m * c]);
        let tw = product(&own.t, &own.w, m);
        let wtw = product(&own.w, &tw, m);
        for i in 0..m {
            for j in 0..m {
                add(&mut pulled[i * c..(i + 1) * c], own.w[i * m + j], &r[j * c..(j + 1) * c]);
                add(&mut turned[i * c..(i + 1) * c], own.w[i * m + j], &z[j * c..(j + 1) * c]);
                add(&mut turned[i * c..(i + 1) * c], wtw[i * m + j], &r[j * c..(j + 1) * c]);
            }
        }
        Some(PlanChange { own, all, pulled, turned })
    }

    /// The state after a change.
    pub(crate) fn apply(&mut self, change: &PlanChange, numbers: usize) {
        change.own.apply(&mut self.own, numbers);
        if let Some(all) = &change.all {
            all.apply(&mut self.all, numbers);
        }
        let [a, e] = &mut self.pull;
        let (g, c) = a.shape();
        for column in 0..c {
            for row in 0..g {
                let (mut of_a, mut of_e) = (0.0, 0.0);
                for i in 0..numbers {
                    let (k, l) = (change.own.k[i * g + row], change.own.l[i * g + row]);
                    of_a += k * change.pulled[i * c + column];
                    of_e += l * change.pulled[i * c + column] - k * change.turned[i * c + column];
                }
                a[(row, column)] += of_a;
                e[(row, column)] += of_e;
            }
        }
    }
}

fn log_determinant(matrix: &DMatrix<f64>) -> Option<f64> {
    let n = matrix.nrows();
    let (values, _) = poecal_numerics::linalg::symmetric_eigen(matrix.as_slice(), n);
    values.iter().all(|&value| value > 0.0).then(|| values.iter().map(|value| value.ln()).sum())
}

/// Rows with the weight of the calibrated model.
pub(crate) fn scale_rows(rows: &[f64], aim: &CriterionContext) -> Vec<f64> {
    let root = aim.share.sqrt();
    rows.iter().map(|value| value * root).collect()
}

/// `R = J_c - J_g A` and `Z = J_g E` of rows.
#[inline(always)]
pub(crate) fn own_rows(
    state: &CovarianceState,
    aim: &CriterionContext,
    rows: &[f64],
    numbers: usize,
    r: &mut [f64],
    z: &mut [f64],
) {
    let (g, c) = (aim.geometry, aim.modes());
    let [a, e] = &state.pull;
    for i in 0..numbers {
        let row = &rows[i * (g + c)..(i + 1) * (g + c)];
        for column in 0..c {
            let own = |matrix: &DMatrix<f64>| dot(&row[..g], &matrix.as_slice()[column * g..(column + 1) * g]);
            r[i * c + column] = row[g + column] - own(a);
            z[i * c + column] = own(e);
        }
    }
}
