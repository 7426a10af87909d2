//! Rows of a session as linear functions of all unknowns about one estimate, with the terms turned into modes (theory.md §6,
//! *Corrections*).

use nalgebra::{DMatrix, DVector};

use crate::calibration::fit::Task;
use crate::estimate::Estimate;
use crate::linalg::{self, Factor};
use crate::measurement::{Noise, Quantity};
use crate::parameters::Subject;
use crate::problem::{Layout, Problem};
use crate::robot::{CorrectionModel, Sizes, TermGroup};
use crate::solve::Normal;
use crate::start::device_parameter;
use crate::threads;
use crate::unit::Unit;

/// Rows that one thread differentiates at a time.
const CHUNK: usize = 128;
/// Information of a mode, as a share of its prior's, below which it stays where the prior has it.
const NEGLIGIBLE: f64 = 0.1;
/// Rounding of a matrix, as a share of its largest diagonal element.
const ROUNDING: f64 = 1e-16;
/// The same where columns of terms and screws may be one.
const ROUNDING_OF_TERMS: f64 = 1e-13;
/// Rounds of estimating the noise.
const ROUNDS: usize = 3;
/// Least share of the numbers that is left as degrees of freedom.
const LEAST_FREEDOM: f64 = 0.2;
/// Degrees of freedom for which the noise of geometry alone counts: with few rows beyond the unknowns terms explain noise too.
const FREEDOM_OF_GEOMETRY: f64 = 6.0;
/// Information that is added to each unknown of geometry where the rows do not determine them all, as a share of the largest.
const RIDGE: f64 = 1e-10;

/// Rows as linear functions of the unknowns. Columns: what geometry alone has, then the modes, then device frames that are held in the
/// fit.
pub(super) struct Linear {
    estimate: Estimate,
    layout: Layout,
    /// Number of columns of geometry, and the place of each in the layout.
    known: Vec<usize>,
    modes: Vec<Mode>,
    /// Columns of device frames.
    devices: Vec<usize>,
    /// Step of each term's scaled unknown along each mode, and the places of the terms.
    turn: DMatrix<f64>,
    own: Vec<usize>,
    /// Numbers of each row of the sample, as a range.
    sample: Vec<u32>,
    starts: Vec<usize>,
    jacobian: DMatrix<f64>,
    residuals: DVector<f64>,
    quantities: Vec<Quantity>,
    /// Prior of the screws.
    prior: Normal,
    /// Its weight, and that of the modes' priors.
    weight: f64,
}

/// Groups of one size, and the largest that it may be.
pub(super) type Class = (&'static [TermGroup], f64);

/// A combination of terms of groups whose sizes are one: its coefficient has their prior.
#[derive(Clone, Copy)]
struct Mode {
    /// A group of its class.
    group: TermGroup,
    /// What all rows say of it, with geometry free.
    information: f64,
}

/// `|e - E t|²` as a function of the modes t: by the rows, or of many rows by their products.
enum Squares {
    Rows(DMatrix<f64>, DVector<f64>),
    Products { constant: f64, gradient: DVector<f64>, gram: DMatrix<f64>, numbers: usize },
}

/// A part of the rows, and the fit of the others.
pub(super) struct LeftOutPart {
    /// Of the modes, with all else at its optimum.
    information: DMatrix<f64>,
    pull: DVector<f64>,
    /// Squared residuals of the part with its device frames fitted to it.
    fitted: Squares,
    /// Numbers of the part, how all else follows each mode, and where it is without.
    places: Vec<usize>,
    follow: DMatrix<f64>,
    still: DVector<f64>,
    /// Covariance of geometry where the modes are known.
    covariance: DMatrix<f64>,
}

impl Linear {
    /// The rows of a sample about an estimate. `weight` is that of the priors.
    pub(super) fn new(
        task: &Task<'_>,
        model: &CorrectionModel,
        (estimate, noise): (&Estimate, Noise),
        (sample, weight): (&[u32], f64),
        classes: &[Class],
    ) -> Option<Self> {
        let session = &task.session;
        let mut free = task.free(estimate);
        let held = session.base_free().then(|| device_parameter(session.data, 0, sample));
        free.extend(held);
        let problem = Problem::new(*session, sample.to_vec(), free, noise);
        let problem = match task.weights {
            Some(weights) => problem.with_weights(weights),
            None => problem,
        };
        let layout = problem.layout().clone();
        let columns = Columns::new(&layout, model, classes, held.is_some());
        let sample = problem.rows().to_vec();
        let (starts, quantities) = numbers(&problem, &sample);
        let total = quantities.len();
        let (whole, residuals) = rows(&problem, estimate, &sample, &starts, total);
        let mut prior = Normal::new(layout.dim());
        if let Some((of_screws, _)) = task.prior {
            of_screws.clone().without_terms().add(estimate, &layout, 1.0, &mut prior);
        }
        let prior = of_some(&prior, &columns.known);
        let known = whole.select_columns(&columns.known);
        let terms = whole.select_columns(&columns.terms.iter().map(|it| it.place).collect::<Vec<_>>())
            * DMatrix::from_diagonal(&DVector::from_iterator(
                columns.terms.len(),
                columns.terms.iter().map(|it| it.unit),
            ));
        let (modes, turn) = modes(&columns, classes, (&known, &terms), (&prior, weight))?;
        let held = whole.select_columns(&columns.held);
        let own = &terms * &turn;
        let unit = DVector::from_iterator(columns.terms.len(), columns.terms.iter().map(|it| it.unit));
        let mut jacobian = DMatrix::zeros(total, known.ncols() + own.ncols() + held.ncols());
        jacobian.columns_mut(0, known.ncols()).copy_from(&known);
        jacobian.columns_mut(known.ncols(), own.ncols()).copy_from(&own);
        jacobian.columns_mut(known.ncols() + own.ncols(), held.ncols()).copy_from(&held);
        let devices = columns.devices.iter().copied();
        let behind = known.ncols() + own.ncols();
        Some(Linear {
            estimate: estimate.clone(),
            known: columns.known,
            devices: devices.chain(behind..behind + held.ncols()).collect(),
            own: columns.terms.iter().map(|it| it.place).collect(),
            turn: DMatrix::from_diagonal(&unit) * turn,
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

    /// Whether the rows say anything of terms of some groups.
    pub(super) fn has_any(&self, groups: &[TermGroup]) -> bool {
        self.modes.iter().any(|mode| groups.contains(&mode.group))
    }

    /// Number of columns that are fitted: geometry and modes.
    fn fitted(&self) -> usize {
        self.known.len() + self.modes.len()
    }

    /// Prior information of each mode of a size above 0 that the rows say something of.
    fn used(&self, sizes: &Sizes) -> Vec<(usize, f64)> {
        let size = |mode: &Mode| sizes[mode.group];
        let is_used = |mode: &Mode| mode.information * size(mode).powi(2) >= NEGLIGIBLE * self.weight;
        let all = self.modes.iter().enumerate().filter(|(_, mode)| is_used(mode));
        all.map(|(at, mode)| (at, size(mode).powi(-2))).collect()
    }

    /// Whitens the rows by the noise that the residuals of a fit with terms of these sizes show. Returns the factor of each quantity.
    pub(super) fn whiten(&mut self, sizes: &Sizes) -> Vec<(Quantity, f64)> {
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

    /// Weighs the priors by the variance of the whitened residuals, if that is above 1: what stated noise does not explain is the robot's.
    /// Returns it.
    pub(super) fn weigh_priors(&mut self, sizes: &Sizes) -> f64 {
        let found = self.noise_factors(sizes, false);
        let squares: f64 =
            found.iter().map(|(quantity, factor)| self.count(*quantity) * factor * factor).sum();
        let variance = (squares / self.quantities.len().max(1) as f64).max(1.0);
        self.weight *= variance;
        variance
    }

    /// Number of the numbers of a quantity.
    fn count(&self, quantity: Quantity) -> f64 {
        self.quantities.iter().filter(|it| **it == quantity).count() as f64
    }

    /// Noise of each quantity in units of that by which rows are whitened, from the residuals of a fit with terms of these sizes; drawn to
    /// those units if they are the noise of geometry alone.
    fn noise_factors(&self, sizes: &Sizes, is_of_geometry: bool) -> Vec<(Quantity, f64)> {
        let mut present = self.quantities.clone();
        present.sort_unstable();
        present.dedup();
        let used = self.used(sizes);
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
                    between(1.0, left, freedom)
                } else {
                    (left / freedom.max(LEAST_FREEDOM * numbers)).sqrt()
                };
                *factor = deviation.max(f64::MIN_POSITIVE.sqrt());
            }
        }
        present.into_iter().zip(factors).collect()
    }

    fn add_prior(&self, gram: &mut DMatrix<f64>, gradient: &mut DVector<f64>) {
        let k = self.known.len();
        for i in 0..k {
            gradient[i] += self.weight * self.prior.gradient[i];
            for j in 0..k {
                gram[(i, j)] += self.weight * self.prior.gram[i * k + j];
            }
        }
    }

    /// Normal information of all rows.
    pub(super) fn whole(&self) -> (DMatrix<f64>, DVector<f64>) {
        let rows = self.jacobian.columns(0, self.fitted());
        (square(&rows.into_owned()), rows.tr_mul(&self.residuals))
    }

    /// The optimum with terms of these sizes, as an estimate.
    pub(super) fn solution(&self, sizes: &Sizes, whole: &(DMatrix<f64>, DVector<f64>)) -> Option<Estimate> {
        let (found, _) = self.optimum(sizes, (&whole.0, &whole.1))?;
        let k = self.known.len();
        let mut step = vec![0.0; self.layout.dim()];
        self.known.iter().zip(found.iter()).for_each(|(&place, value)| step[place] = *value);
        let terms = &self.turn * found.rows(k, self.modes.len());
        self.own.iter().zip(terms.iter()).for_each(|(&place, value)| step[place] = *value);
        Some(self.layout.retract(&self.estimate, &step))
    }

    /// Sum over the numbers of the logarithm of the noise that a fit with terms of these sizes leaves.
    pub(super) fn logarithm_of_noise(&self, sizes: &Sizes) -> f64 {
        let found = self.noise_factors(sizes, false);
        found.into_iter().map(|(quantity, factor)| self.count(quantity) * factor.ln()).sum()
    }

    /// The optimal step of all fitted columns, and the effective number of unknowns that the rows determine.
    fn optimum(
        &self,
        sizes: &Sizes,
        (gram, gradient): (&DMatrix<f64>, &DVector<f64>),
    ) -> Option<(DVector<f64>, f64)> {
        let (mut both, mut pull) = (gram.clone(), gradient.clone());
        self.add_prior(&mut both, &mut pull);
        let k = self.known.len();
        let used = self.used(sizes);
        let columns: Vec<usize> = (0..k).chain(used.iter().map(|(mode, _)| k + mode)).collect();
        let of_columns = |matrix: &DMatrix<f64>| matrix.select_rows(&columns).select_columns(&columns);
        let (mut both, pull) = (of_columns(&both), pull.select_rows(&columns));
        used.iter().enumerate().for_each(|(at, (_, prior))| both[(k + at, k + at)] += self.weight * prior);
        let factor = cholesky(&both, ROUNDING_OF_TERMS)?;
        let found = linalg::cholesky_solve(&factor, pull.as_slice());
        let n = columns.len();
        let determined = DMatrix::from_row_slice(n, n, &linalg::inverse(&factor)).dot(&of_columns(gram));
        let mut step = DVector::zeros(self.fitted());
        columns.iter().zip(&found).for_each(|(&at, value)| step[at] = *value);
        Some((step, determined))
    }

    /// The parts that are left out in turn.
    pub(super) fn parts(
        &self,
        parts: &[Vec<u32>],
        (gram, gradient): &(DMatrix<f64>, DVector<f64>),
    ) -> Vec<LeftOutPart> {
        let (mut gram, mut gradient) = (gram.clone(), gradient.clone());
        self.add_prior(&mut gram, &mut gradient);
        let each = threads::map_parts(parts.len(), |at| self.part(parts.get(at)?, &gram, &gradient));
        each.into_iter().flatten().collect()
    }

    fn part(&self, rows: &[u32], gram: &DMatrix<f64>, gradient: &DVector<f64>) -> Option<LeftOutPart> {
        let (k, m) = (self.known.len(), self.modes.len());
        let of_row = |row: &u32| {
            let at = self.sample.binary_search(row).ok()?;
            Some(self.starts[at]..self.starts[at + 1])
        };
        let places: Vec<usize> = rows.iter().filter_map(of_row).flatten().collect();
        let own = self.jacobian.select_rows(&places);
        let residuals = self.residuals.select_rows(&places);
        let fitted = own.columns(0, k + m).into_owned();
        let rest = gram - square(&fitted);
        let pull = gradient - fitted.tr_mul(&residuals);
        let factor = of_geometry(rest.view((0, 0), (k, k)).into_owned())?;
        let mixed = rest.view((0, k), (k, m)).into_owned();
        // How the other unknowns follow each mode, and where they are without.
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
            Squares::new(columns, left)
        } else {
            let factor = cholesky(&square(&frames), 1e-9)?;
            let moved = solved(&factor, &(frames.transpose() * &columns));
            let of_still =
                DVector::from_vec(linalg::cholesky_solve(&factor, frames.tr_mul(&left).as_slice()));
            Squares::new(columns - &frames * moved, left - &frames * of_still)
        };
        Some(LeftOutPart { information, pull, fitted, places, follow, still, covariance })
    }

    /// The modes of these sizes by the fit without a part; none if that is not positive definite.
    fn without(&self, part: &LeftOutPart, used: &[(usize, f64)]) -> Option<DVector<f64>> {
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
    fn factor_without(&self, part: &LeftOutPart, used: &[(usize, f64)]) -> Option<(Factor, Vec<f64>)> {
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

    /// Variance of what the fit without a part predicts for some of its numbers, mean over them, by its information alone.
    fn predicted_without(
        &self,
        part: &LeftOutPart,
        used: &[(usize, f64)],
        counts: impl Fn(&usize) -> bool,
    ) -> Option<f64> {
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
    pub(super) fn left_out(&self, parts: &[LeftOutPart], sizes: &Sizes) -> f64 {
        let used = self.used(sizes);
        mean_logarithm(parts, |part| Some(part.fitted.mean(&self.without(part, &used)?)))
    }

    /// Mean squared error of the lengths of the parts, by the fits of the others and their device frames, over what the residuals of all rows
    /// and the uncertainty of these fits let expect, at least 1; without lengths that of all numbers.
    pub(super) fn growth(
        &self,
        parts: &[LeftOutPart],
        (gram, gradient): &(DMatrix<f64>, DVector<f64>),
        sizes: &Sizes,
    ) -> f64 {
        let has_lengths = self.quantities.iter().any(|quantity| quantity.unit() == Unit::Metre);
        let counts = |at: &usize| !has_lengths || self.quantities[*at].unit() == Unit::Metre;
        let used = self.used(sizes);
        let k = self.known.len();
        let Some((step, determined)) = self.optimum(sizes, (gram, gradient)) else { return 1.0 };
        let counted: Vec<usize> = (0..self.quantities.len()).filter(counts).collect();
        let left = &self.residuals - self.jacobian.columns(0, self.fitted()) * step;
        let numbers = self.quantities.len() as f64;
        let freedom = (numbers - determined).max(LEAST_FREEDOM * numbers) / numbers * counted.len() as f64;
        let fitted = counted.iter().map(|&at| left[at] * left[at]).sum::<f64>() / freedom;
        let grown = mean_logarithm(parts, |part| {
            let modes = self.without(part, &used)?;
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
            // Half of what the fit's own uncertainty explains: other sessions err by more than its model knows.
            let allowed = (fitted * expected).sqrt();
            Some(sum / count.max(1) as f64 / allowed.max(f64::MIN_POSITIVE))
        });
        let growth = grown.exp();
        if growth.is_finite() { growth.max(1.0) } else { 1.0 }
    }
}

/// Mean over parts of the logarithm of a square; infinite if one has none, since a system that is not positive definite is no choice.
fn mean_logarithm(parts: &[LeftOutPart], square: impl Fn(&LeftOutPart) -> Option<f64> + Sync) -> f64 {
    let logs =
        threads::map_parts(parts.len(), |at| Some(square(parts.get(at)?)?.max(f64::MIN_POSITIVE).ln()));
    let count = logs.len() as f64;
    logs.into_iter().sum::<Option<f64>>().map_or(f64::INFINITY, |sum| sum / count)
}

impl Squares {
    fn new(columns: DMatrix<f64>, residuals: DVector<f64>) -> Self {
        if columns.nrows() <= columns.ncols() {
            return Squares::Rows(columns, residuals);
        }
        Squares::Products {
            constant: residuals.norm_squared(),
            gradient: columns.tr_mul(&residuals),
            gram: square(&columns),
            numbers: residuals.len(),
        }
    }

    /// Their mean.
    fn mean(&self, modes: &DVector<f64>) -> f64 {
        let (sum, numbers) = match self {
            Squares::Rows(columns, residuals) => {
                let mut left = residuals.clone();
                left.gemv(-1.0, columns, modes, 1.0);
                (left.norm_squared(), residuals.len())
            }
            Squares::Products { constant, gradient, gram, numbers } => {
                (constant - 2.0 * gradient.dot(modes) + modes.dot(&(gram * modes)), *numbers)
            }
        };
        sum.max(0.0) / numbers.max(1) as f64
    }
}

/// Which columns of a layout are of what.
struct Columns {
    known: Vec<usize>,
    /// Indices among the known ones.
    devices: Vec<usize>,
    /// Device frames that the fit holds.
    held: Vec<usize>,
    terms: Vec<TermColumn>,
}

struct TermColumn {
    place: usize,
    /// Index of its class.
    class: usize,
    /// Scaled unknown of a coefficient whose size is 1.
    unit: f64,
}

impl Columns {
    fn new(layout: &Layout, model: &CorrectionModel, classes: &[Class], holds_frame: bool) -> Self {
        let groups: Vec<_> = model.terms().zip(model.groups.iter().zip(model.shares())).collect();
        let (mut known, mut devices, mut held, mut terms) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (parameter, places) in layout.parameters() {
            let at = |(place, _): &(usize, f64)| *place;
            let group = parameter
                .value_term()
                .and_then(|it| groups.iter().find(|(of, _)| *of == (it.joint, it.term)))
                .map(|(_, group)| group);
            if let (Some((group, share)), Some(&(place, scale))) = (group, places.first()) {
                let class = classes.iter().position(|(of, _)| of.contains(group)).unwrap_or_default();
                terms.push(TermColumn { place, class, unit: share.sqrt() * scale });
                continue;
            }
            match parameter.model().subject() {
                Subject::Instrument(0) if holds_frame => held.extend(places.iter().map(at)),
                Subject::Instrument(_) => {
                    devices.extend(known.len()..known.len() + places.len());
                    known.extend(places.iter().map(at));
                }
                Subject::Joint(_) | Subject::Target(_) => known.extend(places.iter().map(at)),
            }
        }
        Columns { known, devices, held, terms }
    }
}

/// Turns the terms of each class, whose coefficients have one size, so that what the rows say of them is told apart: the prior stays what
/// it is, and what nothing is said of is left out.
fn modes(
    columns: &Columns,
    classes: &[Class],
    (known, terms): (&DMatrix<f64>, &DMatrix<f64>),
    (prior, weight): (&Normal, f64),
) -> Option<(Vec<Mode>, DMatrix<f64>)> {
    let k = columns.known.len();
    let mut gram = square(known);
    for i in 0..k {
        for j in 0..k {
            gram[(i, j)] += weight * prior.gram[i * k + j];
        }
    }
    let factor = of_geometry(gram)?;
    let mixed = known.transpose() * terms;
    let whole = square(terms) - mixed.transpose() * solved(&factor, &mixed);
    let (mut modes, mut turns): (Vec<Mode>, Vec<DVector<f64>>) = (Vec::new(), Vec::new());
    for (class, (groups, largest)) in classes.iter().enumerate() {
        let Some(&group) = groups.first() else { continue };
        let own: Vec<usize> =
            (0..columns.terms.len()).filter(|&at| columns.terms[at].class == class).collect();
        let n = own.len();
        let (values, vectors) =
            linalg::symmetric_eigen(whole.select_rows(&own).select_columns(&own).as_slice(), n);
        for (at, information) in values.into_iter().enumerate().rev() {
            if information * largest * largest < NEGLIGIBLE * weight {
                break;
            }
            let mut turn = DVector::zeros(columns.terms.len());
            own.iter().zip(vectors.column(at).iter()).for_each(|(&place, value)| turn[place] = *value);
            modes.push(Mode { group, information });
            turns.push(turn);
        }
    }
    let turn =
        if turns.is_empty() { DMatrix::zeros(columns.terms.len(), 0) } else { DMatrix::from_columns(&turns) };
    Some((modes, turn))
}

/// Where the numbers of each row begin, and the quantity of each number.
fn numbers(problem: &Problem<'_>, sample: &[u32]) -> (Vec<usize>, Vec<Quantity>) {
    let (mut starts, mut quantities) = (vec![0], Vec::new());
    for &row in sample {
        let channels = problem.session().observation(row).measurement.observe().channels();
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

/// Normal information of some of the unknowns.
fn of_some(normal: &Normal, places: &[usize]) -> Normal {
    let (n, k) = (normal.dim(), places.len());
    let mut found = Normal::new(k);
    for (i, &a) in places.iter().enumerate() {
        found.gradient[i] = normal.gradient[a];
        for (j, &b) in places.iter().enumerate() {
            found.gram[i * k + j] = normal.gram[a.min(b) * n + a.max(b)];
        }
    }
    found
}

/// `AᵀA`.
fn square(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    matrix.transpose() * matrix
}

/// Factor of a symmetric matrix; rounding is a share of its largest diagonal element.
fn cholesky(matrix: &DMatrix<f64>, rounding: f64) -> Option<Factor> {
    let largest = matrix.diagonal().iter().copied().fold(0.0, f64::max);
    linalg::cholesky(matrix.as_slice(), matrix.nrows(), rounding * largest)
}

/// Factor of the information of geometry, which may leave unknowns open.
fn of_geometry(mut matrix: DMatrix<f64>) -> Option<Factor> {
    cholesky(&matrix, ROUNDING).or_else(|| {
        let largest = matrix.diagonal().iter().copied().fold(0.0, f64::max);
        (0..matrix.nrows()).for_each(|at| matrix[(at, at)] += RIDGE * largest);
        cholesky(&matrix, ROUNDING)
    })
}

/// Standard deviation from a sum of squares with so many degrees of freedom, drawn in logarithms to that of geometry alone.
pub(super) fn between(of_geometry: f64, squares: f64, freedom: f64) -> f64 {
    let freedom = freedom.max(f64::MIN_POSITIVE);
    let found = (squares / freedom).sqrt().max(f64::MIN_POSITIVE);
    let share = freedom / (freedom + FREEDOM_OF_GEOMETRY);
    of_geometry * (found / of_geometry).powf(share)
}

/// `A⁻¹ B` from the factor of A, by one product.
fn solved(factor: &Factor, right: &DMatrix<f64>) -> DMatrix<f64> {
    let n = right.nrows();
    DMatrix::from_column_slice(n, n, &linalg::inverse(factor)) * right
}
