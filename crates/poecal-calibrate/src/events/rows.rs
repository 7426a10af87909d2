//! All rows of a session as linear functions of the unknowns of a corrected model, about its optimum.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::hypotheses::{HypothesisColumns, hypotheses};
use crate::corrections::{CorrectedFit, priors, unknowns, weight_of_prior, whitened_rows};
use crate::run::task::FitTask;
use crate::steps::calibrated_fit::CalibratedFit;
use poecal_fit::parameters::Parameter;
use poecal_fit::problem::Problem;
use poecal_fit::state::{Session, sample_rows};
use poecal_model::measurement::Dataset;
use poecal_model::robot::Sizes;
use poecal_numerics::linalg;
use poecal_numerics::solve::NormalEquations;

/// Most measured numbers: with fewer an event still shows, and its position is determined to a few rows.
const MOST_NUMBERS: usize = 6000;
/// Largest difference of readings within one run of rows, radians or metres.
const SAME: f64 = 1e-3;
/// Least share of the numbers that counts as redundant.
const LEAST_FREEDOM: f64 = 0.2;
/// Information added to each unknown, as a share of the largest.
const RIDGE: f64 = 1e-12;

/// Rows of a session about the optimum of a corrected model.
pub(crate) struct SessionRows {
    pub(crate) rows: Vec<u32>,
    /// Start index of each row's numbers.
    pub(crate) starts: Vec<usize>,
    /// Consecutive rows of one configuration, as indices of `rows`.
    pub(crate) runs: Vec<Range<usize>>,
    /// Whitened derivatives by all fitted unknowns.
    fitted: DMatrix<f64>,
    /// Whitened residuals at the estimate.
    residual: DVector<f64>,
    /// Information and gradient of the priors.
    prior: (DMatrix<f64>, DVector<f64>),
    /// Hypotheses, with their derivatives.
    pub(crate) columns: Vec<HypothesisColumns>,
}

/// The optimum of weighted rows.
pub(crate) struct Optimum {
    /// Residuals.
    pub(crate) residual: DVector<f64>,
    /// Derivatives in units in which the covariance of the fitted unknowns is 1.
    pub(crate) whitened: DMatrix<f64>,
    /// Variance of a number, and the redundancy of the numbers.
    pub(crate) variance: f64,
    pub(crate) freedom: f64,
}

impl SessionRows {
    /// The rows of a session with its corrected model; `None` if this determines nothing.
    pub(crate) fn new(fit: &CalibratedFit<'_>, found: &CorrectedFit, rows: &[u32]) -> Option<Self> {
        let (session, options) = (fit.session(), &fit.run.options);
        let data = session.data;
        let sizes = found.sizes.max(&Sizes::COMMON);
        let known = unknowns(&found.model, session.unknowns, &sizes);
        let session = Session { unknowns: &known, ..found.session(fit) };
        let numbers = |row: &u32| data.observations[*row as usize].measurement.dim();
        let all: usize = rows.iter().map(numbers).sum();
        let rows = sample_rows(rows, rows.len() * MOST_NUMBERS / all.max(MOST_NUMBERS));
        let prior = options.prior_with_terms(&session).with_terms(priors(&found.model, &sizes));
        let task = FitTask { session, rows: &rows, weights: None, prior: None, options };
        let mut free: Vec<Parameter> = task.free_parameters(&found.estimate);
        let fitted = free.len();
        let all = hypotheses(&session, found, &rows, &mut free);
        let problem = Problem::new(session, rows.clone(), free, found.noise);
        let layout = problem.layout();
        let places: Vec<Vec<(usize, f64)>> = layout.parameters().map(|(_, places)| places.to_vec()).collect();
        let of_fit: Vec<usize> = places.get(..fitted)?.iter().flatten().map(|(place, _)| *place).collect();
        let (starts, jacobian, residual) = whitened_rows(&problem, &found.estimate, &rows);
        let mut believed = NormalEquations::new(layout.dim());
        prior.add(&found.estimate, layout, 1.0, &mut believed);
        let n = layout.dim();
        let runs = runs(data, &rows);
        let weight = weight_of_prior(runs.len()) * found.prior_weight.max(1.0);
        let gram = |i: usize, j: usize| weight * believed.gram[i.min(j) * n + i.max(j)];
        let gram = DMatrix::from_fn(of_fit.len(), of_fit.len(), |i, j| gram(of_fit[i], of_fit[j]));
        let pull = DVector::from_iterator(of_fit.len(), of_fit.iter().map(|&place| weight * believed.gradient[place]));
        let columns = all.into_iter().map(|it| it.columns(&jacobian, &places, &rows, &session));
        let columns = columns.collect();
        let fitted = jacobian.select_columns(&of_fit);
        Some(SessionRows { rows, starts, runs, fitted, residual, prior: (gram, pull), columns })
    }

    /// The numbers of a run.
    pub(crate) fn numbers(&self, run: &Range<usize>) -> Range<usize> {
        self.starts[run.start]..self.starts[run.end]
    }

    /// The optimum with a weight for each run.
    pub(crate) fn optimum(&self, weights: &[f64]) -> Option<Optimum> {
        let p = self.fitted.ncols();
        let mut each = DVector::zeros(self.residual.len());
        for (run, weight) in self.runs.iter().zip(weights) {
            self.numbers(run).for_each(|at| each[at] = *weight);
        }
        let mut weighted = self.fitted.clone();
        weighted.row_iter_mut().zip(each.iter()).for_each(|(mut row, weight)| row *= *weight);
        let mut gram = self.fitted.transpose() * &weighted + &self.prior.0;
        let largest = gram.diagonal().amax();
        (0..p).for_each(|at| gram[(at, at)] += RIDGE * largest);
        let pull = weighted.tr_mul(&self.residual) + &self.prior.1;
        let (step, whitened) = linalg::solved_and_whitened(gram, &pull, &self.fitted)?;
        let residual = &self.residual - &self.fitted * step;
        let numbers: f64 = each.sum();
        let determined: f64 =
            whitened.row_iter().zip(each.iter()).map(|(row, weight)| weight * row.norm_squared()).sum();
        let squares: f64 = residual.iter().zip(each.iter()).map(|(value, weight)| weight * value * value).sum();
        let freedom = numbers - determined;
        let variance = squares / freedom.max(LEAST_FREEDOM * numbers).max(1.0);
        (variance > 0.0).then_some(Optimum { residual, whitened, variance, freedom })
    }

    /// Correlation of the numbers of a run along a step: the variance of its size by runs, over that by numbers; at least 1.
    pub(crate) fn shared_variance(&self, optimum: &Optimum, weights: &[f64], moved: &DVector<f64>) -> f64 {
        let mut weighted = moved.clone();
        for (run, weight) in self.runs.iter().zip(weights) {
            self.numbers(run).for_each(|at| weighted[at] *= *weight);
        }
        // Part of the step that the fitted unknowns do not explain, and part of the residuals that the step does not explain.
        let left = moved - &optimum.whitened * optimum.whitened.tr_mul(&weighted);
        let residual = &optimum.residual - &left;
        let (mut scatter, mut information) = (0.0, 0.0);
        for (run, weight) in self.runs.iter().zip(weights) {
            let numbers = self.numbers(run);
            let own = left.rows(numbers.start, numbers.len());
            scatter += weight * own.dot(&residual.rows(numbers.start, numbers.len())).powi(2);
            information += weight * own.norm_squared();
        }
        (scatter / (information * optimum.variance).max(f64::MIN_POSITIVE)).max(1.0)
    }
}

/// Consecutive rows of one configuration.
fn runs(data: &Dataset, rows: &[u32]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (at, &row) in rows.iter().enumerate() {
        let is_same = runs.last().is_some_and(|run: &Range<usize>| {
            let first = data.readings(rows[run.start] as usize);
            first.iter().zip(data.readings(row as usize)).all(|(a, b)| (a - b).abs() <= SAME)
        });
        match runs.last_mut() {
            Some(run) if is_same => run.end = at + 1,
            _ => runs.push(at..at + 1),
        }
    }
    runs
}
