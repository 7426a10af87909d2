//! Parts of the rows that are left out in turn, and their errors by the fits of the others.

use nalgebra::{DMatrix, DVector};

use super::linear::{LEAST_FREEDOM, LinearRows};
use super::matrices::{ROUNDING_OF_TERMS, cholesky, of_geometry, solve_factored, square};
use poecal_model::robot::Sizes;
use poecal_numerics::linalg::{self, Factor};
use poecal_numerics::threads;
use poecal_numerics::unit::Unit;

/// `|e - E t|²` as a function of the modes t: by the rows, or for many rows by their products.
enum SquaredErrors {
    Rows(DMatrix<f64>, DVector<f64>),
    Products { constant: f64, gradient: DVector<f64>, gram: DMatrix<f64>, numbers: usize },
}

/// A part of the rows, and the fit of the others.
pub(crate) struct FoldFit {
    /// Information of the modes, with all else at its optimum.
    information: DMatrix<f64>,
    pull: DVector<f64>,
    /// Squared residuals of the part with its device frames fitted to it.
    fitted: SquaredErrors,
    /// Numbers of the part, derivative of the other unknowns by each mode, and their values without modes.
    places: Vec<usize>,
    follow: DMatrix<f64>,
    still: DVector<f64>,
    /// Covariance of geometry if the modes are known.
    covariance: DMatrix<f64>,
}

impl LinearRows {
    /// The parts that are left out in turn.
    pub(crate) fn parts(&self, parts: &[Vec<u32>], (gram, gradient): &(DMatrix<f64>, DVector<f64>)) -> Vec<FoldFit> {
        let (mut gram, mut gradient) = (gram.clone(), gradient.clone());
        self.add_prior(&mut gram, &mut gradient);
        let each = threads::map_parts(parts.len(), |at| self.part(parts.get(at)?, &gram, &gradient));
        each.into_iter().flatten().collect()
    }

    fn part(&self, rows: &[u32], gram: &DMatrix<f64>, gradient: &DVector<f64>) -> Option<FoldFit> {
        let (k, m) = (self.known.len(), self.modes.len());
        let of_row = |row: &u32| {
            let at = self.sample.binary_search(row).ok()?;
            Some(self.starts[at]..self.starts[at + 1])
        };
        let places: Vec<usize> = rows.iter().filter_map(of_row).flatten().collect();
        let own = self.jacobian.select_rows(&places);
        // A part that its own device frames explain entirely is uninformative.
        let frames = self.devices.iter().filter(|&&column| own.column(column).amax() > 0.0).count();
        if places.len() <= frames {
            return None;
        }
        let residuals = self.residuals.select_rows(&places);
        let fitted = own.columns(0, k + m).into_owned();
        let rest = gram - square(&fitted);
        let pull = gradient - fitted.tr_mul(&residuals);
        let factor = of_geometry(rest.view((0, 0), (k, k)).into_owned())?;
        let mixed = rest.view((0, k), (k, m)).into_owned();
        // Derivative of the other unknowns by each mode, and their values without modes.
        let covariance = DMatrix::from_column_slice(k, k, &linalg::inverse(&factor));
        let follow = &covariance * &mixed;
        let still = DVector::from_vec(linalg::cholesky_solve(&factor, pull.rows(0, k).as_slice()));
        let information = rest.view((k, k), (m, m)) - mixed.transpose() * &follow;
        let pull = pull.rows(k, m) - mixed.tr_mul(&still);
        let known = own.columns(0, k);
        let columns = own.columns(k, m) - known * &follow;
        let left = &residuals - known * &still;
        let frames = own.select_columns(&self.devices);
        let fitted = if frames.ncols() == 0 {
            SquaredErrors::new(columns, left)
        } else {
            let factor = cholesky(&square(&frames), 1e-9)?;
            let moved = solve_factored(&factor, &(frames.transpose() * &columns));
            let of_still = DVector::from_vec(linalg::cholesky_solve(&factor, frames.tr_mul(&left).as_slice()));
            SquaredErrors::new(columns - &frames * moved, left - &frames * of_still)
        };
        Some(FoldFit { information, pull, fitted, places, follow, still, covariance })
    }

    /// The modes of these sizes by the fit without a part; `None` if its information is not positive definite.
    fn modes_without_part(&self, part: &FoldFit, used: &[(usize, f64)]) -> Option<DVector<f64>> {
        let mut modes = DVector::zeros(self.modes.len());
        if used.is_empty() {
            return Some(modes);
        }
        let (factor, unit) = self.factor_without(part, used)?;
        let right: Vec<f64> = used.iter().zip(&unit).map(|((at, _), unit)| unit * part.pull[*at]).collect();
        let found = linalg::cholesky_solve(&factor, &right);
        used.iter().zip(&unit).zip(found).for_each(|(((at, _), unit), value)| modes[*at] = unit * value);
        Some(modes)
    }

    /// Factor of the information of the used modes without a part, in units in which the prior is 1, and these units.
    fn factor_without(&self, part: &FoldFit, used: &[(usize, f64)]) -> Option<(Factor, Vec<f64>)> {
        let n = used.len();
        let unit: Vec<f64> = used.iter().map(|(_, prior)| (self.weight * prior).sqrt().recip()).collect();
        let mut gram = vec![0.0; n * n];
        for (i, (row, &(a, _))) in gram.chunks_exact_mut(n).zip(used).enumerate() {
            let column = part.information.column(a);
            for (j, (out, &(b, _))) in row.iter_mut().zip(used).enumerate().skip(i) {
                *out = unit[i] * unit[j] * column[b];
            }
        }
        let largest = gram.iter().step_by(n + 1).fold(0.0, |largest: f64, it| largest.max(*it));
        Some((linalg::cholesky(&gram, n, 1.0 + ROUNDING_OF_TERMS * largest)?, unit))
    }

    /// Mean predicted variance of some numbers of a part by the fit without it, by its information alone.
    fn predicted_without(&self, part: &FoldFit, used: &[(usize, f64)], counts: impl Fn(&usize) -> bool) -> Option<f64> {
        let k = self.known.len();
        let places: Vec<usize> = part.places.iter().copied().filter(counts).collect();
        let own = self.jacobian.select_rows(&places);
        let known = own.columns(0, k);
        let mut sum = (known * &part.covariance).dot(&known);
        if !used.is_empty() {
            let (factor, unit) = self.factor_without(part, used)?;
            let all = own.columns(k, self.modes.len()) - known * &part.follow;
            let columns: Vec<DVector<f64>> =
                used.iter().zip(&unit).map(|((at, _), unit)| all.column(*at) * *unit).collect();
            let columns = DMatrix::from_columns(&columns);
            let n = used.len();
            sum += (&columns * DMatrix::from_column_slice(n, n, &linalg::inverse(&factor))).dot(&columns);
        }
        Some(sum / places.len().max(1) as f64)
    }

    /// Mean over the parts of the logarithm of their mean squared residual, by the fits of the others with terms of these sizes.
    pub(crate) fn left_out(&self, parts: &[FoldFit], sizes: &Sizes) -> f64 {
        let used = self.used_modes(sizes);
        mean_logarithm(parts, |part| Some(part.fitted.mean(&self.modes_without_part(part, &used)?)))
    }

    /// Mean squared error of the lengths of the parts by the fits of the others and their device frames, relative to its expectation; at least 1. The
    /// residuals of all rows and the uncertainty of these fits determine the expectation. Without lengths it is that of all numbers.
    pub(crate) fn growth(
        &self,
        parts: &[FoldFit],
        (gram, gradient): &(DMatrix<f64>, DVector<f64>),
        sizes: &Sizes,
    ) -> f64 {
        let has_lengths = self.quantities.iter().any(|quantity| quantity.unit() == Unit::Metre);
        let counts = |at: &usize| !has_lengths || self.quantities[*at].unit() == Unit::Metre;
        let used = self.used_modes(sizes);
        let k = self.known.len();
        let Some((step, determined)) = self.optimum(sizes, (gram, gradient)) else { return 1.0 };
        let counted: Vec<usize> = (0..self.quantities.len()).filter(counts).collect();
        let left = &self.residuals - self.jacobian.columns(0, self.fitted_columns()) * step;
        let numbers = self.quantities.len() as f64;
        let freedom = (numbers - determined).max(LEAST_FREEDOM * numbers) / numbers * counted.len() as f64;
        let fitted = counted.iter().map(|&at| left[at] * left[at]).sum::<f64>() / freedom;
        let grown = mean_logarithm(parts, |part| {
            let modes = self.modes_without_part(part, &used)?;
            let known = &part.still - &part.follow * &modes;
            let places = part.places.iter().copied().filter(counts);
            let left = places.map(|at| {
                let row = self.jacobian.row(at);
                let of = |columns: usize, step: &DVector<f64>| {
                    row.columns(columns, step.len()).iter().zip(step).map(|(a, b)| a * b).sum::<f64>()
                };
                self.residuals[at] - of(0, &known) - of(k, &modes)
            });
            let (sum, count) = left.fold((0.0, 0), |(sum, count), it| (sum + it * it, count + 1));
            let expected = fitted + self.weight * self.predicted_without(part, &used, counts)?;
            // Half of the growth by the fit's own uncertainty is allowed: other sessions err by more than its model predicts.
            let allowed = (fitted * expected).sqrt();
            Some(sum / count.max(1) as f64 / allowed.max(f64::MIN_POSITIVE))
        });
        let growth = grown.exp();
        if growth.is_finite() { growth.max(1.0) } else { 1.0 }
    }
}

/// Mean over parts of the logarithm of a square; infinite if one has none, since a system that is not positive definite is not eligible.
fn mean_logarithm(parts: &[FoldFit], square: impl Fn(&FoldFit) -> Option<f64> + Sync) -> f64 {
    let logs = threads::map_parts(parts.len(), |at| Some(square(parts.get(at)?)?.max(f64::MIN_POSITIVE).ln()));
    let count = logs.len() as f64;
    logs.into_iter().sum::<Option<f64>>().map_or(f64::INFINITY, |sum| sum / count)
}

impl SquaredErrors {
    fn new(columns: DMatrix<f64>, residuals: DVector<f64>) -> Self {
        if columns.nrows() <= columns.ncols() {
            return SquaredErrors::Rows(columns, residuals);
        }
        SquaredErrors::Products {
            constant: residuals.norm_squared(),
            gradient: columns.tr_mul(&residuals),
            gram: square(&columns),
            numbers: residuals.len(),
        }
    }

    /// Mean of the squares.
    fn mean(&self, modes: &DVector<f64>) -> f64 {
        let (sum, numbers) = match self {
            SquaredErrors::Rows(columns, residuals) => {
                let mut left = residuals.clone();
                left.gemv(-1.0, columns, modes, 1.0);
                (left.norm_squared(), residuals.len())
            }
            SquaredErrors::Products { constant, gradient, gram, numbers } => {
                (constant - 2.0 * gradient.dot(modes) + modes.dot(&(gram * modes)), *numbers)
            }
        };
        sum.max(0.0) / numbers.max(1) as f64
    }
}
