//! Information of the rows of a fit and its prior about the robot's unknowns.

use nalgebra::{DMatrix, DVector, Matrix6, Matrix6xX};

use crate::corrections::{ROUNDING_OF_TERMS, cholesky, solve_factored, whitened_rows};
use crate::robust::RobustFit;
use crate::run::CalibrationRun;
use poecal_fit::parameters::Parameter;
use poecal_fit::problem::Problem;
use poecal_fit::state::Estimate;
use poecal_fit::uncertainty::PriorInformation;
use poecal_model::measurement::Noise;
use poecal_numerics::linalg;
use poecal_numerics::solve::LeastSquares as _;

/// The normal equations of a fit with its prior, at its optimum.
pub(crate) struct FitInformation<'a> {
    pub(crate) problem: Problem<'a>,
    pub(crate) estimate: &'a Estimate,
    factor: linalg::Factor,
    gradient: DVector<f64>,
}

impl<'a> FitInformation<'a> {
    /// Information of a fit with its weights; `None` if it is not positive definite.
    pub(crate) fn from_fit(
        run: &'a CalibrationRun<'_>,
        ratios: &'a [Noise],
        (fit, weights): (&'a RobustFit, &'a [f64]),
    ) -> Option<Self> {
        let session = run.session(ratios);
        let fitted = &fit.fitted;
        let free: Vec<Parameter> = fitted.layout.parameters().map(|(parameter, _)| *parameter).collect();
        let problem = Problem::new(session, run.fit_rows.clone(), free, fitted.noise).with_weights(weights);
        let prior = PriorInformation::new(run.prior.as_ref(), &fitted.estimate, &fitted.layout, session.length_m);
        let normal = problem.normal(&fitted.estimate);
        let factor = factor_of(&symmetric_from_upper(&prior.added_to(&normal.gram, 1.0), normal.dim()))?;
        let gradient = normal.gradient.iter().zip(&prior.normal.gradient);
        let gradient = DVector::from_iterator(normal.dim(), gradient.map(|(rows, prior)| rows + prior));
        Some(FitInformation { problem, estimate: &fitted.estimate, factor, gradient })
    }

    /// The gradient of half the squares.
    pub(crate) fn gradient(&self) -> &DVector<f64> {
        &self.gradient
    }

    /// The inverse times a matrix.
    pub(crate) fn solve(&self, right: &DMatrix<f64>) -> DMatrix<f64> {
        solve_factored(&self.factor, right)
    }

    /// The step to the optimum.
    pub(crate) fn step(&self) -> DVector<f64> {
        DVector::from_vec(linalg::cholesky_solve(&self.factor, self.gradient.as_slice()))
    }

    /// The covariance of the unknowns.
    pub(crate) fn covariance(&self) -> DMatrix<f64> {
        let n = self.gradient.len();
        DMatrix::from_row_slice(n, n, &linalg::inverse(&self.factor))
    }

    /// Derivatives of the predicted poses of weighted pictures by the unknowns, as six motions of the row each, with the picture's index.
    pub(crate) fn of_pictures(&self, run: &CalibrationRun<'_>) -> Vec<(usize, Matrix6xX<f64>)> {
        let pictures = &run.data.pictures.all;
        let counts = |row: u32| run.fit_rows.binary_search(&row).is_ok() && self.problem.weight(row) > 0.0;
        let own: Vec<usize> = (0..pictures.len()).filter(|&at| counts(pictures[at].row)).collect();
        let rows: Vec<u32> = own.iter().map(|&at| pictures[at].row).collect();
        let (starts, jacobian, _) = whitened_rows(&self.problem, self.estimate, &rows);
        let of = |((&at, &row), &start): ((&usize, &u32), &usize)| {
            let unwhitening: Matrix6<f64> = run.data.whitening_of_picture(row).and_then(linalg::inverse_6)?;
            let known = (start + 6 <= jacobian.nrows()).then(|| jacobian.rows(start, 6).into_owned())?;
            Some((at, unwhitening * known / self.problem.weight(row).sqrt()))
        };
        own.iter().zip(&rows).zip(&starts).filter_map(of).collect()
    }
}

/// A symmetric matrix from its upper triangle.
pub(crate) fn symmetric_from_upper(upper: &[f64], n: usize) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |i, j| upper[i.min(j) * n + i.max(j)])
}

/// Factor of an information matrix, of robot or numbers.
pub(crate) fn factor_of(matrix: &DMatrix<f64>) -> Option<linalg::Factor> {
    cholesky(matrix, ROUNDING_OF_TERMS)
}
