//! Cross-validation without further fits: rows are removed from the normal equations, and one step leads to the fit of the others.

use std::collections::BTreeMap;

use nalgebra::DMatrix;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::clusters::clusters;
use super::view::FitView;
use super::{TOGETHER, covariance, factor, motions};
use crate::analysis::ranges;
use crate::problem::{Layout, Problem};
use crate::state::{Estimate, Linkage, RowError, sample_rows};
use poecal_model::measurement::{ByQuantity, MeasuredQuantities};
use poecal_model::simulate::random;
use poecal_numerics::linalg;
use poecal_numerics::solve::LeastSquares;

/// Largest number of rows of a cross-validation: more are sampled.
const SAMPLE: usize = 2000;
/// Number of random folds. An end of a joint's range has as many rows as one of them.
const FOLDS: usize = 5;
/// Fewest rows that are cross-validated.
pub const FEWEST_VALIDATED: usize = 2 * FOLDS;
/// Number of clusters, and of random folds, by which sizes of terms are chosen.
const NEIGHBOURHOODS: usize = 8;
/// An id column defines groups if it has at most [`MOST_GROUPS`] values with [`LEAST_ROWS`] rows each on average; otherwise its values
/// name single rows.
const MOST_GROUPS: usize = 30;
const LEAST_ROWS: usize = 4;
/// Fewest rows of each station outside a block.
const FEWEST_OF_STATION: usize = 6;

/// Distance from the range of the other rows, as a share of it, beyond which a value counts as outside; and its least length, radians or
/// metres.
const BEYOND: f64 = 0.1;
const JITTER: f64 = 1e-3;

/// Step over which errors change nearly to first order, metres.
const SMALL_M: f64 = 1e-4;

/// Rows that are left out together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Fold {
    pub(crate) name: String,
    pub(crate) rows: Vec<u32>,
}

/// Errors of the rows of a fold or block, predicted by the fit of the others.
#[derive(Clone, Debug, PartialEq)]
pub struct FoldErrors {
    /// Name of the block.
    pub name: String,
    /// Number of rows.
    pub rows: usize,
    /// Root mean square error of each measured quantity, metres or radians.
    pub rms: MeasuredQuantities<f64>,
    /// Growth of the squared error of lengths, such as positions, if these rows are left out. It is relative to its expectation by the
    /// covariance of the unknowns (theory.md §9 (43)).
    pub growth: f64,
}

/// Rows of random folds with a joint beyond the range of the rows by which they were predicted.
#[derive(Clone, Debug, PartialEq)]
pub struct OutsideRange {
    /// Number of rows.
    pub rows: usize,
    /// Root mean square error of each measured quantity, metres or radians.
    pub rms: MeasuredQuantities<f64>,
}

/// Cross-validation of a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossValidation {
    /// Random folds, left out in turn; one entry for all of them.
    pub random: FoldErrors,
    /// Rows of random folds, in order, with their errors.
    pub errors: Vec<(u32, RowError)>,
    /// Rows outside the range of the others; `None` if there are none.
    pub outside: Option<OutsideRange>,
    /// Root mean square error of each measured quantity in the other rows.
    pub inside: MeasuredQuantities<f64>,
    /// Blocks, left out in turn: the ends of each joint's range, files, groups of equal `id`.
    pub blocked: Vec<FoldErrors>,
    /// Share of the fitted rows in the subsample of the cross-validation.
    pub sampled: f64,
}

impl CrossValidation {
    /// Block with the largest error.
    #[must_use]
    pub fn worst_block(&self) -> Option<&FoldErrors> {
        self.blocked.iter().max_by(|a, b| a.rms.lead().total_cmp(&b.rms.lead()))
    }
}

/// Cross-validation (theory.md §9 (42) and (43)) over random folds and over blocks: the ends of every joint's range, each file and each
/// repeated `id`. `None` if the rows are too few or leave a system that is not positive definite.
#[must_use]
pub fn cross_validate(view: &FitView<'_>, seed: u64) -> Option<CrossValidation> {
    let sample = sample_rows(view.rows, SAMPLE);
    if sample.len() < FEWEST_VALIDATED {
        return None;
    }
    let downdated = DowndatedEquations::new(view, &sample)?;
    let mut random = ErrorSums::default();
    let (mut inside, mut outside) = (ErrorSums::default(), ErrorSums::default());
    let mut errors: Vec<(u32, RowError)> = Vec::with_capacity(sample.len());
    for fold in random_folds(view, &sample, FOLDS, seed) {
        let (sums, each) = downdated.errors_without(&fold.rows)?;
        random.add(&sums);
        let is_outside = outside_of_others(view, &sample, &fold.rows);
        for ((&row, error), is_outside) in fold.rows.iter().zip(each).zip(is_outside) {
            if is_outside {
                outside.add_row(&error)
            } else {
                inside.add_row(&error)
            }
            errors.push((row, error));
        }
    }
    errors.sort_unstable_by_key(|(row, _)| *row);
    let name = format!("random, {FOLDS} folds");
    let blocked = blocks(view, &sample)
        .into_iter()
        .filter_map(|fold| Some(downdated.errors_without(&fold.rows)?.0.result(fold.name)))
        .collect();
    let sampled = sample.len() as f64 / view.rows.len() as f64;
    let outside = (outside.rows > 0).then(|| OutsideRange { rows: outside.rows, rms: outside.rms() });
    let inside = inside.rms();
    Some(CrossValidation { random: random.result(name), errors, outside, inside, blocked, sampled })
}

/// For each row of a fold, true if it has a joint beyond the range of the other rows.
fn outside_of_others(view: &FitView<'_>, sample: &[u32], fold: &[u32]) -> Vec<bool> {
    let others: Vec<u32> = sample.iter().copied().filter(|row| !fold.contains(row)).collect();
    let ranges = ranges(&view.session, &others);
    let is_outside = |row: &u32| {
        view.values(*row).iter().zip(&ranges).any(|(value, (least, most))| {
            let beyond = (BEYOND * (most - least)).max(JITTER);
            *value < least - beyond || *value > most + beyond
        })
    };
    fold.iter().map(is_outside).collect()
}

/// Parts of a subsample of at most `most` rows that are left out in turn, and the subsample. They are the ends of every joint's range,
/// each file and each repeated `id`, clusters of neighbouring configurations, and random folds.
pub fn parts_to_leave_out(view: &FitView<'_>, most: usize, seed: u64) -> (Vec<u32>, Vec<Vec<u32>>) {
    let sample = sample_rows(view.rows, most);
    let few = FitView { rows: &sample, ..*view };
    let mut parts: Vec<Vec<u32>> = blocks(&few, &sample).into_iter().map(|fold| fold.rows).collect();
    let configurations = view.session.data.configurations(&sample).len();
    parts.extend(clusters(&few, NEIGHBOURHOODS.min(configurations / 4).max(1)));
    parts.extend(random_folds(&few, &sample, NEIGHBOURHOODS, seed).into_iter().map(|fold| fold.rows));
    parts.retain(|rows| !rows.is_empty() && 2 * rows.len() < sample.len() && leaves_all_stations(view, &sample, rows));
    (sample, parts)
}

fn random_folds(view: &FitView<'_>, sample: &[u32], count: usize, seed: u64) -> Vec<Fold> {
    // Rows of one configuration are left out together: a copy in the training rows would make its prediction trivial.
    let mut configurations = view.session.data.configurations(sample);
    random::shuffle(&mut ChaCha8Rng::seed_from_u64(seed ^ 0xf01d), &mut configurations);
    let part = configurations.len().div_ceil(count);
    configurations.chunks(part).map(|part| Fold { name: String::new(), rows: part.concat() }).collect()
}

/// Ends of each joint's range, the rows of each file, and those of each `id` that several rows share.
fn blocks(view: &FitView<'_>, sample: &[u32]) -> Vec<Fold> {
    let mut folds = Vec::new();
    let size = sample.len() / FOLDS;
    for (joint, _) in view.spans(sample).iter().enumerate().filter(|(_, span)| **span > 0.0) {
        let sorted = view.sorted_by(sample, joint);
        let name = &view.session.robot.joints[joint].name;
        folds.push(Fold { name: format!("the lowest fifth of {name}"), rows: sorted[..size].to_vec() });
        let rows = sorted[sorted.len() - size..].to_vec();
        folds.push(Fold { name: format!("the highest fifth of {name}"), rows });
    }
    let file = |row: u32| {
        let index = view.session.observation(row).source.file as usize;
        view.session.data.files.get(index).map(|path| format!("the file {}", path.display()))
    };
    folds.extend(groups(sample, file));
    if !view.session.data.ids.is_empty() {
        folds.extend(groups(sample, |row| {
            view.session.data.ids.get(row as usize).map(|id| format!("the rows of id {id}"))
        }));
    }
    folds.retain(|fold| leaves_all_stations(view, sample, &fold.rows));
    folds
}

/// True if the rows outside a fold still determine the device frame of each of several stations.
fn leaves_all_stations(view: &FitView<'_>, sample: &[u32], fold: &[u32]) -> bool {
    let stations = view.session.data.station_count();
    let count = |rows: &[u32], station| view.session.data.seen_from(station, rows).len();
    // Stations without fitted rows do not count.
    let fitted = || (0..stations).filter(|it| count(sample, *it) > 0);
    fitted().count() == 1 || fitted().all(|it| count(sample, it) >= count(fold, it) + FEWEST_OF_STATION)
}

/// Rows grouped by name, if the names define groups.
fn groups(sample: &[u32], name: impl Fn(u32) -> Option<String>) -> Vec<Fold> {
    let mut groups: BTreeMap<String, Vec<u32>> = BTreeMap::new();
    for &row in sample {
        if let Some(name) = name(row) {
            groups.entry(name).or_default().push(row);
        }
    }
    if groups.len() < 2 || groups.len() > MOST_GROUPS || groups.len() * LEAST_ROWS > sample.len() {
        return Vec::new();
    }
    groups.into_iter().map(|(name, rows)| Fold { name, rows }).collect()
}

/// Sums over rows that were left out: squared errors in m² and rad².
#[derive(Clone, Copy, Default)]
struct ErrorSums {
    rows: usize,
    /// Squared error of each quantity, with the number of rows that measured it.
    parts: ByQuantity<(f64, usize)>,
    /// Squared error of all lengths.
    lengths: f64,
    /// Squared error of all lengths by the fit of all rows.
    before: f64,
    /// Expected growth of the squared errors of lengths, by the covariances: denominator of theory.md §9 (43).
    expected: f64,
}

impl ErrorSums {
    fn add(&mut self, other: &ErrorSums) {
        self.rows += other.rows;
        for (quantity, (squares, count)) in self.parts.values_mut() {
            *squares += other.parts[quantity].0;
            *count += other.parts[quantity].1;
        }
        self.lengths += other.lengths;
        self.before += other.before;
        self.expected += other.expected;
    }

    /// Adds the error of a row.
    fn add_row(&mut self, error: &RowError) {
        self.rows += 1;
        for (quantity, (squares, count)) in self.parts.values_mut() {
            *squares += error.square(quantity);
            *count += usize::from(!error.part(quantity).is_empty());
        }
        self.lengths += error.square_m2();
    }

    fn rms(&self) -> MeasuredQuantities<f64> {
        MeasuredQuantities::from_fn(|quantity| {
            let (squares, count) = self.parts[quantity];
            (count > 0).then(|| (squares / count as f64).sqrt())
        })
    }

    fn result(self, name: String) -> FoldErrors {
        FoldErrors {
            name,
            rows: self.rows,
            rms: self.rms(),
            growth: (self.lengths - self.before) / self.expected.max(f64::MIN_POSITIVE),
        }
    }
}

/// Normal equations of a subsample, from which blocks of rows are removed.
struct DowndatedEquations<'a> {
    view: FitView<'a>,
    estimate: Estimate,
    gram: Vec<f64>,
    variance: f64,
    covariance: Vec<f64>,
}

impl<'a> DowndatedEquations<'a> {
    /// The subsample's optimum is one step from that of all rows.
    fn new(view: &FitView<'a>, sample: &[u32]) -> Option<Self> {
        let problem = view.problem(sample.to_vec());
        let normal = problem.normal(view.estimate);
        let n = problem.dim();
        let variance = view.variance;
        let factor = factor(&normal.gram, n, view.prior, variance)?;
        let pull: Vec<f64> = normal
            .gradient
            .iter()
            .zip(&view.prior.normal.gradient)
            .map(|(measured, prior)| measured + variance * prior)
            .collect();
        let step = linalg::cholesky_solve(&factor, &pull);
        Some(DowndatedEquations {
            view: *view,
            estimate: problem.retract(view.estimate, &step),
            covariance: covariance(&factor, variance)?,
            gram: normal.gram,
            variance,
        })
    }

    /// Errors of some rows by the fit of the others: at the optimum of all rows, `N - N_b` and `-g_b` are information and gradient
    /// without the block b (theory.md §9 (42)).
    fn errors_without(&self, rows: &[u32]) -> Option<(ErrorSums, Vec<RowError>)> {
        let problem = self.view.problem(rows.to_vec());
        let part = problem.normal(&self.estimate);
        let rest: Vec<f64> = self.gram.iter().zip(&part.gram).map(|(all, part)| all - part).collect();
        let gradient: Vec<f64> = part.gradient.iter().map(|g| -g).collect();
        let n = gradient.len();
        let factor = factor(&rest, n, self.view.prior, self.variance)?;
        let step = linalg::cholesky_solve(&factor, &gradient);
        let before = self.view.session.errors(rows, &self.estimate);
        let without = moved_errors(&problem, &self.estimate, rows, &step, &before);
        let covariance = covariance(&factor, self.variance)?;
        let both = DMatrix::from_iterator(n, n, covariance.iter().zip(&self.covariance).map(|(a, b)| a + b));
        let expected = self.position_variance(problem.layout(), rows, &both);
        let mut sums = ErrorSums { expected, ..ErrorSums::default() };
        without.iter().for_each(|error| sums.add_row(error));
        sums.before = before.iter().map(RowError::square_m2).sum();
        Some((sums, without))
    }

    /// Sum over rows of `tr P_p`, the variance of the predicted position in square metres (theory.md §9 (43)).
    fn position_variance(&self, layout: &Layout, rows: &[u32], covariance: &DMatrix<f64>) -> f64 {
        let linkage = Linkage::new(&self.estimate);
        let of = |some: &[u32]| {
            let motions = motions(layout, &linkage, self.view.session.packed, &self.view.with_sights(some), 1);
            (&motions * covariance).dot(&motions)
        };
        rows.chunks(TOGETHER).map(of).sum()
    }
}

/// Errors of some rows after a step, to first order. Steps are long in directions that the rows hardly determine, along which a fit follows
/// a curved valley. The end of the straight step has errors that no fit has.
fn moved_errors(
    problem: &Problem<'_>,
    estimate: &Estimate,
    rows: &[u32],
    step: &[f64],
    before: &[RowError],
) -> Vec<RowError> {
    let far = step.iter().fold(0.0, |far: f64, it| far.max(it.abs()));
    let share = (SMALL_M / far).min(1.0);
    let part: Vec<f64> = step.iter().map(|it| share * it).collect();
    let after = problem.session().errors(rows, &problem.retract(estimate, &part));
    after.iter().zip(before).map(|(after, before)| before.interpolate(after, 1.0 / share)).collect()
}

/// Number of clusters of configurations that are left out in turn when fits are compared.
const CLUSTERS: usize = 10;

/// Mean loss of the rows, each predicted by the fit without its cluster of configurations (theory.md §9 (42)). `weights` has the weight of
/// each row of the data in the fit; many rows are sampled. `None` if the rows without a cluster do not determine the unknowns.
#[must_use]
pub fn leave_clusters_out(view: &FitView<'_>, weights: &[f64], loss: impl Fn(u32, &RowError) -> f64) -> Option<f64> {
    let rows = sample_rows(view.rows, SAMPLE);
    let sample = FitView { rows: &rows, ..*view };
    let whole = view.problem(rows.clone()).with_weights(weights).normal(view.estimate);
    let n = whole.dim();
    let mut sum = 0.0;
    for cluster in clusters(&sample, CLUSTERS) {
        let problem = view.problem(cluster.clone()).with_weights(weights);
        let part = problem.normal(view.estimate);
        let rest: Vec<f64> = whole.gram.iter().zip(&part.gram).map(|(all, part)| all - part).collect();
        let factor = factor(&rest, n, view.prior, view.variance)?;
        let gradient: Vec<f64> = part.gradient.iter().map(|g| -g).collect();
        let step = linalg::cholesky_solve(&factor, &gradient);
        let before = view.session.errors(&cluster, view.estimate);
        let errors = moved_errors(&problem, view.estimate, &cluster, &step, &before);
        sum += cluster.iter().zip(&errors).map(|(&row, error)| loss(row, error)).sum::<f64>();
    }
    Some(sum / rows.len().max(1) as f64)
}
