//! State of a watched session once it has enough rows: the present fit, which judges rows and chooses the next.

use nalgebra::{DMatrix, DVector};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::blocks::ConfigurationRows;
use super::caches::Caches;
use super::error_curve::ExpectedErrors;
use super::experiment::{PlannedExperiment, inverse};
use super::order::TravelDistance;
use super::search::PlanSearch;
use super::state::{CovarianceState, CriterionContext, CriterionWeights, WorkspaceErrors};
use super::watched_row::{Mistake, WatchOptions, WatchedRow};
use poecal_fit::problem::Prior;
use poecal_fit::start::{Registration, register};
use poecal_fit::state::{PackedValues, Session, nominal_estimate};
use poecal_model::measurement::{Dataset, Quantity};
use poecal_model::robot::{Robot, Tolerance};
use poecal_model::simulate::Configurations;
use poecal_numerics::distributions::f_quantile;
use poecal_numerics::error::Result;
use poecal_numerics::linalg;

/// Probability with which an expected row is reported nevertheless, for normal errors; for those of real robots it is higher.
const BY_CHANCE: f64 = 2e-4;
/// Probability above which the remaining deviation counts as explained by a mistake.
const EXPLAINED: f64 = 0.05;
/// Degrees of freedom of the prior belief in the noise.
const BELIEVED: f64 = 8.0;
/// Number of configurations to choose the next from, and of the workspace.
const CANDIDATES: usize = 200;
const WORKSPACE: usize = 300;
/// Candidates among which the rows ahead are exchanged: those with the largest single gain.
const GAINING: usize = 50;
/// Number of rows that are planned ahead.
const AHEAD: usize = 10;
/// Distance to a measured configuration, in all joints, below which a candidate counts as measured, radians.
const MEASURED_RAD: f64 = 2e-3;
/// Change of a reading for a difference, radians or metres.
const DIFFERENCE: f64 = 1e-5;

/// State of the session with enough rows.
pub(crate) struct RunningFit {
    experiment: PlannedExperiment,
    aim: CriterionContext,
    candidates: Vec<f64>,
    /// Marks each candidate that is not measured yet.
    open: Vec<bool>,
    /// The best candidates to add to the rows so far, at the last search.
    ahead: Vec<usize>,
    blocks: ConfigurationRows,
    gram: DMatrix<f64>,
    covariance: DMatrix<f64>,
    rows: DMatrix<f64>,
    residuals: DVector<f64>,
    /// Variance of the whitened residuals, its degrees of freedom, and the factor on the terms' variance.
    pub(crate) scale: f64,
    pub(crate) freedom: f64,
    terms: f64,
    /// Targets and instruments of the data.
    pub(crate) names: [usize; 2],
}

/// Deviation of a row from its prediction.
pub(crate) struct RowComparison {
    pub(crate) ratio: f64,
    pub(crate) noticed_m: f64,
    pub(crate) off_m: f64,
}

impl RunningFit {
    pub(crate) fn new(robot: &Robot, options: &WatchOptions, data: &Dataset) -> Result<Self> {
        let packed = PackedValues::from_dataset(robot, data);
        let rows = data.all_rows();
        let session = Session::new(robot, data, &packed, options.fit.session.device_free);
        let prior = Prior::from_session(&session, options.fit.tolerance.unwrap_or(Tolerance::WIDE));
        let noise = options.fit.session.noise;
        let registration = Registration { session, rows: &rows, noise, targets_free: true, prior: Some((&prior, 1.0)) };
        let registered = register(&registration, &nominal_estimate(robot, data)).0;
        let experiment = PlannedExperiment::from_begun(robot, &options.fit, data, &registered)?;
        let mut generator = ChaCha8Rng::seed_from_u64(options.seed);
        let configurations = Configurations::new(robot);
        let mut draw =
            |count: usize| -> Vec<f64> { (0..count).flat_map(|_| configurations.random(&mut generator)).collect() };
        let candidates = options.candidates.clone().unwrap_or_else(|| draw(CANDIDATES));
        let workspace = options.workspace.clone().unwrap_or_else(|| draw(WORKSPACE));
        let blocks = experiment.blocks(&candidates)?;
        let n = blocks.columns;
        let corrected = if n > experiment.geometry() { 1.0 } else { 0.0 };
        let weights = CriterionWeights { calibrated: 1.0, corrected, determinant: 0.0 };
        let aim = CriterionContext::new(&experiment.prior, experiment.moments(&workspace), weights, experiment.share());
        let mut known = RunningFit {
            experiment,
            aim,
            open: vec![true; blocks.count()],
            ahead: Vec::new(),
            candidates,
            blocks,
            gram: DMatrix::zeros(n, n),
            covariance: DMatrix::identity(n, n),
            rows: DMatrix::zeros(0, n),
            residuals: DVector::zeros(0),
            scale: 1.0,
            freedom: BELIEVED,
            terms: 1.0,
            names: [data.targets.len(), data.station_count()],
        };
        known.fit(data);
        Ok(known)
    }

    /// Fits rows, and estimates the noise and the size of the terms.
    pub(crate) fn fit(&mut self, data: &Dataset) {
        let (estimate, _) = self.experiment.fit_terms(data);
        self.experiment.estimate = estimate;
        (self.rows, self.residuals) = self.experiment.rows(data);
        self.gram = self.rows.transpose() * &self.rows;
        let travel = TravelDistance::new(&self.experiment.robot, self.experiment.length_m());
        for (open, own) in self.open.iter_mut().zip(self.candidates.chunks_exact(self.experiment.width())) {
            *open = (0..data.len()).all(|row| travel.distance(own, data.readings(row)) > MEASURED_RAD);
        }
        let n = self.gram.nrows();
        if let Some(covariance) = inverse(&(&self.gram + &self.aim.prior)) {
            self.covariance = covariance;
        }
        // Number of unknowns that the rows determine beyond the prior.
        let determined = n as f64 - self.covariance.dot(&self.aim.prior);
        let left = (self.residuals.len() as f64 - determined).max(0.0);
        self.freedom = BELIEVED + left;
        self.scale = (BELIEVED + self.residuals.norm_squared()) / self.freedom;
        let g = self.experiment.geometry();
        let (size, count) = self.experiment.size_of_terms(&self.covariance, g);
        self.terms = (BELIEVED + size) / (BELIEVED + count);
    }

    /// Judges a row before it is fitted: its innovation against its covariance.
    pub(crate) fn judge(&self, data: &Dataset, row: u32) -> RowComparison {
        self.innovation(&data.select_rows(&[row]))
    }

    fn innovation(&self, one: &Dataset) -> RowComparison {
        let (rows, residuals) = self.experiment.rows(one);
        let m = residuals.len();
        let mut covariance = &rows * &self.covariance * rows.transpose();
        (0..m).for_each(|k| covariance[(k, k)] += 1.0);
        let (values, _) = linalg::symmetric_eigen(covariance.as_slice(), m);
        let largest = values.last().copied().unwrap_or(1.0);
        let square = linalg::solve_symmetric(covariance, &residuals).map_or(f64::INFINITY, |it| it.dot(&residuals));
        let limit = f_quantile(BY_CHANCE, m as f64, self.freedom) * m as f64 * self.scale;
        let sigma_m = self.experiment.noise()[Quantity::Position];
        RowComparison {
            ratio: square / limit,
            noticed_m: (limit * largest).sqrt() * sigma_m,
            off_m: residuals.rows(0, m.min(3)).norm() * sigma_m,
        }
    }

    /// Explanation of an unexpected row.
    pub(crate) fn mistake(&self, data: &Dataset, row: u32, before: Option<u32>, off_m: f64) -> Mistake {
        let at = row as usize;
        let observation = &data.observations[at];
        let with = |readings: &[f64]| -> Option<Dataset> {
            let mut one = data.select_rows(&[]);
            one.push_observation(readings, *observation).ok()?;
            Some(one)
        };
        let own = data.readings(at);
        let chance = f_quantile(BY_CHANCE, observation.measurement.dim() as f64, self.freedom);
        let enough = f_quantile(EXPLAINED, observation.measurement.dim() as f64, self.freedom) / chance;
        let ratio = |readings: &[f64]| with(readings).map_or(f64::INFINITY, |one| self.innovation(&one).ratio);
        let mut best: (f64, Option<Mistake>) = (enough, None);
        let mut propose = |ratio: f64, mistake: Mistake| {
            if ratio < best.0 {
                best = (ratio, Some(mistake));
            }
        };
        if let Some(before) = before {
            propose(ratio(data.readings(before as usize)), Mistake::Stale);
        }
        let names = data.reading_names();
        for (joint, name) in names.iter().enumerate() {
            let mut turned = own.to_vec();
            turned[joint] = -turned[joint];
            propose(ratio(&turned), Mistake::Sign(name.clone()));
            if let Some((by, left)) = self.joint_off(&with, own, joint) {
                // One more unknown fits better by itself.
                propose(2.0 * left, Mistake::Joint(name.clone(), by));
            }
        }
        best.1.unwrap_or(Mistake::Off(off_m))
    }

    /// The change of one reading that explains a row best, and the remaining ratio.
    fn joint_off(&self, with: &impl Fn(&[f64]) -> Option<Dataset>, own: &[f64], joint: usize) -> Option<(f64, f64)> {
        let mut readings = own.to_vec();
        let mut by = 0.0;
        // Several steps: an offset may be large.
        for _ in 0..6 {
            let (rows, residuals) = self.experiment.rows(&with(&readings)?);
            let mut near = readings.clone();
            near[joint] += DIFFERENCE;
            let (_, moved) = self.experiment.rows(&with(&near)?);
            let slope = (moved - &residuals) / DIFFERENCE;
            let m = residuals.len();
            let mut covariance = &rows * &self.covariance * rows.transpose();
            (0..m).for_each(|k| covariance[(k, k)] += 1.0);
            let weighed = linalg::solve_symmetric(covariance, &slope)?;
            let step = -weighed.dot(&residuals) / weighed.dot(&slope).max(f64::MIN_POSITIVE);
            by += step;
            readings[joint] += step;
            if !by.is_finite() || by.abs() > 1.0 {
                return None;
            }
        }
        Some((by, self.innovation(&with(&readings)?).ratio))
    }

    /// Displacement of the target of some of the fitted rows, if it is evident; `before` is the scale and its degrees of freedom before them.
    pub(crate) fn shift(
        &self,
        data: &Dataset,
        good: &[u32],
        last: &[u32],
        target: usize,
        before: (f64, f64),
    ) -> Option<f64> {
        let columns = self.experiment.shifts_of(target);
        let numbers = |row: &u32| data.observations.get(*row as usize).map_or(0, |it| it.measurement.dim());
        let mut moved = DMatrix::zeros(self.rows.nrows(), columns.len());
        let mut at = 0;
        for row in good {
            let count = numbers(row);
            if last.contains(row) {
                for (k, &column) in columns.iter().enumerate() {
                    moved.view_mut((at, k), (count, 1)).copy_from(&self.rows.view((at, column), (count, 1)));
                }
            }
            at += count;
        }
        if at != self.rows.nrows() || columns.is_empty() {
            return None;
        }
        let pull = moved.transpose() * &self.residuals;
        let shared = self.rows.transpose() * &moved;
        let information = moved.transpose() * &moved - shared.transpose() * &self.covariance * &shared;
        let step = linalg::solve_symmetric(information, &pull)?;
        let (scale, freedom) = before;
        let k = columns.len() as f64;
        let limit = f_quantile(BY_CHANCE, k, freedom) * k * scale;
        (step.dot(&pull) > limit).then(|| step.norm())
    }

    /// Expected errors now and after more rows, and the next configuration: from the best list of [`AHEAD`] rows, which begins with that of the row
    /// before, the one with the largest single gain.
    pub(crate) fn foresee(&mut self, found: &mut WatchedRow) {
        let Some((state, squares)) = CovarianceState::new(&self.aim, &self.gram) else { return };
        found.now = Some(self.errors(&squares));
        let mut aim = self.aim.clone();
        if aim.weights.corrected > 0.0 {
            aim.weights.calibrated = 1.0 / squares.calibrated_error().max(f64::MIN_POSITIVE);
            aim.weights.corrected = 1.0 / squares.corrected.max(f64::MIN_POSITIVE);
        }
        let caches = Caches::new(&state, &aim, &self.blocks);
        let mut ranked: Vec<(f64, usize)> = (0..self.blocks.count())
            .filter(|&at| self.open[at])
            .map(|at| (caches.gain(at, &aim.weights), at))
            .collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let begun = self.ahead.iter().copied().filter(|&at| self.open[at]);
        let mut open: Vec<usize> = ranked.iter().take(GAINING).map(|it| it.1).chain(begun).collect();
        open.sort_unstable();
        open.dedup();
        let blocks = self.blocks.select(&open);
        let search = PlanSearch { aim: &aim, kept: &self.gram, blocks: &blocks, apart: &|_, _| true };
        let begun = self.ahead.iter().filter_map(|at| open.binary_search(at).ok()).collect();
        let chosen = search.exchange(search.greedy(begun, AHEAD.min(open.len())), 0);
        found.after = search.squares(&chosen).map(|squares| self.errors(&squares));
        self.ahead = chosen.into_iter().map(|at| open[at]).collect();
        let next = ranked.iter().find(|(_, at)| self.ahead.contains(at));
        let mut each = self.candidates.chunks_exact(self.experiment.width());
        found.next = next.and_then(|&(_, at)| each.nth(at)).map(<[f64]>::to_vec);
    }

    /// Errors with noise and terms as large as estimated from the rows.
    fn errors(&self, squares: &WorkspaceErrors) -> ExpectedErrors {
        let seen = WorkspaceErrors {
            true_noise: squares.true_noise * self.scale,
            terms: squares.terms * self.terms,
            corrected: squares.corrected * self.scale,
            ..*squares
        };
        ExpectedErrors::from_seen_noise(&self.experiment, &seen, [self.scale, self.terms])
    }
}
