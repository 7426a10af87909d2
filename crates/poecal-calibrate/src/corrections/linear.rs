//! Rows of a session as linear functions of all unknowns about one estimate, with the terms turned into modes (theory.md §6,
//! *Corrections*).

use nalgebra::{DMatrix, DVector};

use super::matrices::{ROUNDING_OF_TERMS, cholesky, of_some, square};
use super::modes::{Class, ModeColumns, NEGLIGIBLE, TermMode, modes};
use crate::run::task::FitTask;
use poecal_fit::problem::{Layout, Problem};
use poecal_fit::start::device_parameter;
use poecal_fit::state::Estimate;
use poecal_model::measurement::{Noise, Quantity};
use poecal_model::robot::{CorrectionModel, Sizes, TermGroup};
use poecal_numerics::solve::NormalEquations;
use poecal_numerics::{linalg, threads};

/// Rows that one thread differentiates at a time.
const CHUNK: usize = 128;
/// Rounds of estimating the noise.
const ROUNDS: usize = 3;
/// Least share of the numbers that is left as degrees of freedom.
pub(crate) const LEAST_FREEDOM: f64 = 0.2;
/// Degrees of freedom with which the noise of geometry alone counts: with few rows beyond the unknowns terms explain noise too.
const FREEDOM_OF_GEOMETRY: f64 = 6.0;

/// Rows as linear functions of the unknowns. Columns: the unknowns of geometry alone, then the modes, then device frames that are held in the fit.
pub(crate) struct LinearRows {
    pub(crate) estimate: Estimate,
    pub(crate) layout: Layout,
    /// Number of columns of geometry, and the index of each in the layout.
    pub(crate) known: Vec<usize>,
    pub(crate) modes: Vec<TermMode>,
    /// Columns of device frames.
    pub(crate) devices: Vec<usize>,
    /// Step of each term's scaled unknown along each mode, and the indices of the terms.
    pub(crate) turn: DMatrix<f64>,
    pub(crate) own: Vec<usize>,
    /// Numbers of each row of the sample, as a range.
    pub(crate) sample: Vec<u32>,
    pub(crate) starts: Vec<usize>,
    pub(crate) jacobian: DMatrix<f64>,
    pub(crate) residuals: DVector<f64>,
    pub(crate) quantities: Vec<Quantity>,
    /// Prior of the screws.
    pub(crate) prior: NormalEquations,
    /// Weight of this prior and of the modes' priors.
    pub(crate) weight: f64,
}

impl LinearRows {
    /// The rows of a sample about an estimate. `weight` is the weight of the priors.
    pub(crate) fn new(
        task: &FitTask<'_>,
        model: &CorrectionModel,
        (estimate, noise): (&Estimate, Noise),
        (sample, weight): (&[u32], f64),
        classes: &[Class],
    ) -> Option<Self> {
        let session = &task.session;
        let mut free = task.free_parameters(estimate);
        let first = session.data.first_station(sample);
        let held = session.base_free().then(|| device_parameter(session.data, first, sample));
        free.extend(held);
        let problem = Problem::new(*session, sample.to_vec(), free, noise);
        let problem = match task.weights {
            Some(weights) => problem.with_weights(weights),
            None => problem,
        };
        let layout = problem.layout().clone();
        let columns = ModeColumns::new(&layout, model, classes, held.map(|_| first));
        let sample = problem.rows().to_vec();
        let (starts, quantities) = numbers(&problem, &sample);
        let total = quantities.len();
        let (whole, residuals) = rows(&problem, estimate, &sample, &starts, total);
        let mut prior = NormalEquations::new(layout.dim());
        if let Some((of_screws, _)) = task.prior {
            of_screws.clone().without_terms().add(estimate, &layout, 1.0, &mut prior);
        }
        let prior = of_some(&prior, &columns.known);
        let known = whole.select_columns(&columns.known);
        let places: Vec<usize> = columns.terms.iter().map(|it| it.place).collect();
        let unit = DVector::from_iterator(columns.terms.len(), columns.terms.iter().map(|it| it.unit));
        let unit = DMatrix::from_diagonal(&unit);
        let terms = whole.select_columns(&places) * &unit;
        let (modes, turn) = modes(&columns, classes, (&known, &terms), (&prior, weight))?;
        let held = whole.select_columns(&columns.held);
        let own = &terms * &turn;
        let mut jacobian = DMatrix::zeros(total, known.ncols() + own.ncols() + held.ncols());
        jacobian.columns_mut(0, known.ncols()).copy_from(&known);
        jacobian.columns_mut(known.ncols(), own.ncols()).copy_from(&own);
        jacobian.columns_mut(known.ncols() + own.ncols(), held.ncols()).copy_from(&held);
        let devices = columns.devices.iter().copied();
        let behind = known.ncols() + own.ncols();
        Some(LinearRows {
            estimate: estimate.clone(),
            known: columns.known,
            devices: devices.chain(behind..behind + held.ncols()).collect(),
            own: places,
            turn: unit * turn,
            layout,
            modes,
            sample,
            starts,
            jacobian,
            residuals,
            quantities,
            prior,
            weight,
        })
    }

    /// True if the rows are informative about terms of some groups.
    pub(crate) fn has_any(&self, groups: &[TermGroup]) -> bool {
        self.modes.iter().any(|mode| groups.contains(&mode.group))
    }

    /// Number of columns that are fitted: geometry and modes.
    pub(crate) fn fitted_columns(&self) -> usize {
        self.known.len() + self.modes.len()
    }

    /// Prior information of each mode of a size above 0 about which the rows are informative.
    pub(crate) fn used_modes(&self, sizes: &Sizes) -> Vec<(usize, f64)> {
        let size = |mode: &TermMode| sizes[mode.group];
        let is_used = |mode: &TermMode| mode.information * size(mode).powi(2) >= NEGLIGIBLE * self.weight;
        let all = self.modes.iter().enumerate().filter(|(_, mode)| is_used(mode));
        all.map(|(at, mode)| (at, size(mode).powi(-2))).collect()
    }

    /// Whitens the rows by the noise estimated from the residuals of a fit with terms of these sizes. Returns the factor of each quantity.
    pub(crate) fn whiten(&mut self, sizes: &Sizes) -> Vec<(Quantity, f64)> {
        let found = self.noise_factors(sizes, true);
        let of = |quantity: Quantity| found.iter().find(|it| it.0 == quantity).map_or(1.0, |it| it.1);
        for (at, quantity) in self.quantities.iter().enumerate() {
            let factor = 1.0 / of(*quantity);
            self.residuals[at] *= factor;
            self.jacobian.row_mut(at).iter_mut().for_each(|it| *it *= factor);
        }
        let least = found.iter().map(|it| it.1).fold(f64::INFINITY, f64::min);
        self.modes.iter_mut().for_each(|mode| mode.information /= least * least);
        found
    }

    /// Weights the priors by the variance of the whitened residuals if it is above 1, and returns it: the robot causes the errors that stated noise
    /// does not explain.
    pub(crate) fn weigh_priors(&mut self, sizes: &Sizes) -> f64 {
        let found = self.noise_factors(sizes, false);
        let squares: f64 = found.iter().map(|(quantity, factor)| self.count(*quantity) * factor * factor).sum();
        let variance = (squares / self.quantities.len().max(1) as f64).max(1.0);
        self.weight *= variance;
        variance
    }

    /// Number of measured components of a quantity.
    fn count(&self, quantity: Quantity) -> f64 {
        self.quantities.iter().filter(|it| **it == quantity).count() as f64
    }

    /// Number of measured components of all rows.
    pub(crate) fn numbers(&self) -> f64 {
        self.quantities.len() as f64
    }

    /// Noise of each quantity relative to the noise by which rows are whitened, from the residuals of a fit with terms of these sizes; shrunk towards
    /// those units if they are the noise of geometry alone.
    fn noise_factors(&self, sizes: &Sizes, is_of_geometry: bool) -> Vec<(Quantity, f64)> {
        let mut present = self.quantities.clone();
        present.sort_unstable();
        present.dedup();
        let used = self.used_modes(sizes);
        let columns: Vec<usize> =
            (0..self.known.len()).chain(used.iter().map(|(mode, _)| self.known.len() + mode)).collect();
        let n = columns.len();
        let each: Vec<(Quantity, DMatrix<f64>, DVector<f64>)> = present
            .iter()
            .map(|&quantity| {
                let places: Vec<usize> =
                    (0..self.quantities.len()).filter(|&at| self.quantities[at] == quantity).collect();
                let rows = self.jacobian.select_rows(&places).select_columns(&columns);
                (quantity, rows, self.residuals.select_rows(&places))
            })
            .collect();
        let grams: Vec<(DMatrix<f64>, DVector<f64>)> =
            each.iter().map(|(_, rows, residuals)| (square(rows), rows.tr_mul(residuals))).collect();
        let mut factors = vec![1.0; each.len()];
        for _ in 0..ROUNDS {
            let mut gram = DMatrix::zeros(n, n);
            let mut gradient = DVector::zeros(n);
            for ((own, pull), factor) in grams.iter().zip(&factors) {
                gram += own / (factor * factor);
                gradient += pull / (factor * factor);
            }
            self.add_prior(&mut gram, &mut gradient);
            used.iter().enumerate().for_each(|(at, (_, prior))| {
                gram[(self.known.len() + at, self.known.len() + at)] += self.weight * prior;
            });
            let Some(factor) = cholesky(&gram, ROUNDING_OF_TERMS) else { break };
            let found = DVector::from_vec(linalg::cholesky_solve(&factor, gradient.as_slice()));
            let inverse = DMatrix::from_row_slice(n, n, &linalg::inverse(&factor));
            for (((_, rows, residuals), (own, _)), factor) in each.iter().zip(&grams).zip(&mut factors) {
                let left = (residuals - rows * &found).norm_squared();
                let numbers = residuals.len() as f64;
                let determined = own.dot(&inverse) / (*factor * *factor);
                let freedom = numbers - determined;
                let deviation = if is_of_geometry {
                    draw_deviation(1.0, left, freedom)
                } else {
                    (left / freedom.max(LEAST_FREEDOM * numbers)).sqrt()
                };
                *factor = deviation.max(f64::MIN_POSITIVE.sqrt());
            }
        }
        present.into_iter().zip(factors).collect()
    }

    pub(crate) fn add_prior(&self, gram: &mut DMatrix<f64>, gradient: &mut DVector<f64>) {
        let k = self.known.len();
        for i in 0..k {
            gradient[i] += self.weight * self.prior.gradient[i];
            for j in 0..k {
                gram[(i, j)] += self.weight * self.prior.gram[i * k + j];
            }
        }
    }

    /// Normal information of all rows.
    pub(crate) fn normal_information(&self) -> (DMatrix<f64>, DVector<f64>) {
        let rows = self.jacobian.columns(0, self.fitted_columns());
        (square(&rows.into_owned()), rows.tr_mul(&self.residuals))
    }

    /// The optimum with terms of these sizes, as an estimate.
    pub(crate) fn solution(&self, sizes: &Sizes, whole: &(DMatrix<f64>, DVector<f64>)) -> Option<Estimate> {
        let (found, _) = self.optimum(sizes, (&whole.0, &whole.1))?;
        let k = self.known.len();
        let mut step = vec![0.0; self.layout.dim()];
        self.known.iter().zip(found.iter()).for_each(|(&place, value)| step[place] = *value);
        let terms = &self.turn * found.rows(k, self.modes.len());
        self.own.iter().zip(terms.iter()).for_each(|(&place, value)| step[place] = *value);
        Some(self.layout.retract(&self.estimate, &step))
    }

    /// Sum over the numbers of the logarithm of the noise that a fit with terms of these sizes leaves.
    pub(crate) fn logarithm_of_noise(&self, sizes: &Sizes) -> f64 {
        let found = self.noise_factors(sizes, false);
        found.into_iter().map(|(quantity, factor)| self.count(quantity) * factor.ln()).sum()
    }

    /// The optimal step of all fitted columns, and the effective number of unknowns that the rows determine.
    pub(crate) fn optimum(
        &self,
        sizes: &Sizes,
        (gram, gradient): (&DMatrix<f64>, &DVector<f64>),
    ) -> Option<(DVector<f64>, f64)> {
        let (mut both, mut pull) = (gram.clone(), gradient.clone());
        self.add_prior(&mut both, &mut pull);
        let k = self.known.len();
        let used = self.used_modes(sizes);
        let columns: Vec<usize> = (0..k).chain(used.iter().map(|(mode, _)| k + mode)).collect();
        let of_columns = |matrix: &DMatrix<f64>| matrix.select_rows(&columns).select_columns(&columns);
        let (mut both, pull) = (of_columns(&both), pull.select_rows(&columns));
        used.iter().enumerate().for_each(|(at, (_, prior))| both[(k + at, k + at)] += self.weight * prior);
        let factor = cholesky(&both, ROUNDING_OF_TERMS)?;
        let found = linalg::cholesky_solve(&factor, pull.as_slice());
        let n = columns.len();
        let determined = DMatrix::from_row_slice(n, n, &linalg::inverse(&factor)).dot(&of_columns(gram));
        let mut step = DVector::zeros(self.fitted_columns());
        columns.iter().zip(&found).for_each(|(&at, value)| step[at] = *value);
        Some((step, determined))
    }
}

/// Start index of each row's numbers, and the whitened Jacobian and residuals of all rows of a problem.
pub fn whitened_rows(
    problem: &Problem<'_>,
    estimate: &Estimate,
    sample: &[u32],
) -> (Vec<usize>, DMatrix<f64>, DVector<f64>) {
    let (starts, quantities) = numbers(problem, sample);
    let (jacobian, residuals) = rows(problem, estimate, sample, &starts, quantities.len());
    (starts, jacobian, residuals)
}

/// Start index of each row's numbers, and the quantity of each number.
fn numbers(problem: &Problem<'_>, sample: &[u32]) -> (Vec<usize>, Vec<Quantity>) {
    let (mut starts, mut quantities) = (vec![0], Vec::new());
    for &row in sample {
        let channels = problem.session().observation(row).measurement.channels();
        quantities.extend(channels.iter().map(|channel| channel.quantity));
        starts.push(quantities.len());
    }
    (starts, quantities)
}

/// Whitened Jacobian and residuals of the rows of a sample.
fn rows(
    problem: &Problem<'_>,
    estimate: &Estimate,
    sample: &[u32],
    starts: &[usize],
    total: usize,
) -> (DMatrix<f64>, DVector<f64>) {
    let n = problem.layout().dim();
    let parts = threads::map_chunks(sample, CHUNK, |index, rows| {
        let first = index * CHUNK;
        let begin = starts[first];
        let count = starts[first + rows.len()] - begin;
        let (mut jacobian, mut residuals) = (DMatrix::zeros(count, n), DVector::zeros(count));
        problem.for_row_blocks(estimate, rows, |places, block| {
            for (lane, &place) in places.iter().enumerate() {
                let own = starts[first + place as usize] - begin;
                for number in 0..block.numbers[lane] {
                    residuals[own + number] = block.residual[number].0[lane];
                    for (column, values) in block.jacobian.iter().enumerate() {
                        jacobian[(own + number, column)] = values[number].0[lane];
                    }
                }
            }
        });
        (begin, jacobian, residuals)
    });
    let (mut jacobian, mut residuals) = (DMatrix::zeros(total, n), DVector::zeros(total));
    for (begin, part, own) in parts {
        jacobian.rows_mut(begin, part.nrows()).copy_from(&part);
        residuals.rows_mut(begin, own.len()).copy_from(&own);
    }
    (jacobian, residuals)
}

/// Standard deviation from a sum of squares with these degrees of freedom, shrunk in logarithms towards that of geometry alone.
pub(crate) fn draw_deviation(of_geometry: f64, squares: f64, freedom: f64) -> f64 {
    let freedom = freedom.max(f64::MIN_POSITIVE);
    let found = (squares / freedom).sqrt().max(f64::MIN_POSITIVE);
    let share = freedom / (freedom + FREEDOM_OF_GEOMETRY);
    of_geometry * (found / of_geometry).powf(share)
}
