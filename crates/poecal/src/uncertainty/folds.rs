//! Cross-validation without fitting again: the information that some rows leave tells where the fit would have ended without them.

use std::collections::BTreeMap;

use nalgebra::DMatrix;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::clusters::clusters;
use super::view::View;
use super::{TOGETHER, covariance, factor, motions};
use crate::estimate::{Estimate, Linkage, RowError, sample_rows};
use crate::linalg;
use crate::problem::Layout;
use crate::simulate::random;
use crate::solve::LeastSquares;

/// Rows on which cross-validation is done, if there are more.
const SAMPLE: usize = 2000;
/// Random folds; a tail has as many rows as one of them.
const FOLDS: usize = 5;

/// Names by which rows are grouped, at most, and rows of a name on average, at least: others are names of rows, not of groups.
const MOST_GROUPS: usize = 30;
const LEAST_ROWS: usize = 4;
/// Rows of each place of the device that a block must leave.
const FEWEST_OF_STATION: usize = 6;

/// Rows to leave out together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Fold {
    pub(super) name: String,
    pub(super) rows: Vec<u32>,
}

/// What the other rows predict of those that were left out.
///
/// ```
/// use poecal::uncertainty::LeftOut;
/// let fold = LeftOut { name: "the low end of joint2".into(), rows: 40, position_rms_m: 1e-4, rotation_rms_rad: None, growth: 1.0 };
/// assert_eq!(fold.rows, 40);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// What these rows have in common.
    pub name: String,
    /// How many they are.
    pub rows: usize,
    /// Root mean square error of position, metres.
    pub position_rms_m: f64,
    /// Root mean square error of rotation, radians, where measured.
    pub rotation_rms_rad: Option<f64>,
    /// How much the squared error of position grew by leaving them out, over what the covariance of the unknowns makes of it (theory.md §9 (43)).
    pub growth: f64,
}

/// Cross-validation of a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossValidation {
    /// Random parts left out in turn; one entry for all of them.
    pub random: LeftOut,
    /// Parts that belong together left out: the ends of each joint's range, files, groups of equal `id`.
    pub blocked: Vec<LeftOut>,
    /// Share of the fitted rows that this was done on.
    pub sampled: f64,
}

impl CrossValidation {
    /// The block that was predicted worst.
    #[must_use]
    pub fn worst(&self) -> Option<&LeftOut> {
        self.blocked.iter().max_by(|a, b| a.position_rms_m.total_cmp(&b.position_rms_m))
    }
}

/// Random folds, and blocks: tails of every joint's range, each file and each repeated `id`.
#[must_use]
pub fn cross_validate(view: &View<'_>, seed: u64) -> Option<CrossValidation> {
    let sample = sample_rows(view.rows, SAMPLE);
    if sample.len() < 2 * FOLDS {
        return None;
    }
    let left = Left::new(view, &sample)?;
    let mut random = Sums::default();
    for fold in random_folds(view, &sample, seed) {
        random.add(&left.sums(&fold.rows)?);
    }
    let name = format!("random, {FOLDS} folds");
    let blocked = blocks(view, &sample)
        .into_iter()
        .filter_map(|fold| Some(left.sums(&fold.rows)?.result(fold.name)))
        .collect();
    let sampled = sample.len() as f64 / view.rows.len() as f64;
    Some(CrossValidation { random: random.result(name), blocked, sampled })
}

fn random_folds(view: &View<'_>, sample: &[u32], seed: u64) -> Vec<Fold> {
    // Rows of one configuration are left out together: a copy would tell the fit what it is asked for.
    let mut configurations = view.data.configurations(sample);
    random::shuffle(&mut ChaCha8Rng::seed_from_u64(seed ^ 0xf01d), &mut configurations);
    let part = configurations.len().div_ceil(FOLDS);
    configurations.chunks(part).map(|part| Fold { name: String::new(), rows: part.concat() }).collect()
}

/// The ends of each joint's range, the rows of each file, and those of each `id` that several rows share.
fn blocks(view: &View<'_>, sample: &[u32]) -> Vec<Fold> {
    let mut folds = Vec::new();
    let size = sample.len() / FOLDS;
    for (joint, _) in view.spans(sample).iter().enumerate().filter(|(_, span)| **span > 0.0) {
        let sorted = view.sorted_by(sample, joint);
        let name = &view.robot.joints[joint].name;
        folds.push(Fold { name: format!("the lowest fifth of {name}"), rows: sorted[..size].to_vec() });
        let rows = sorted[sorted.len() - size..].to_vec();
        folds.push(Fold { name: format!("the highest fifth of {name}"), rows });
    }
    let file = |row: u32| {
        let index = view.data.observations[row as usize].source.file as usize;
        view.data.files.get(index).map(|path| format!("the file {}", path.display()))
    };
    folds.extend(groups(sample, file));
    if !view.data.ids.is_empty() {
        folds.extend(groups(sample, |row| {
            view.data.ids.get(row as usize).map(|id| format!("the rows of id {id}"))
        }));
    }
    folds.retain(|fold| leaves_all_stations(view, sample, fold));
    folds
}

/// Whether the rows that a fold leaves still tell where the device stood, at each of several places: nothing else does.
fn leaves_all_stations(view: &View<'_>, sample: &[u32], fold: &Fold) -> bool {
    let stations = view.data.station_count();
    let count = |rows: &[u32], station| view.data.seen_from(station, rows).len();
    stations == 1 || (0..stations).all(|it| count(sample, it) >= count(&fold.rows, it) + FEWEST_OF_STATION)
}

/// Rows of one name together, if the names are those of groups.
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

/// Sums over rows that were left out.
#[derive(Clone, Copy, Default)]
struct Sums {
    rows: usize,
    turned: usize,
    position: f64,
    rotation: f64,
    /// Squared position errors of the fit of all rows.
    before: f64,
    /// What the covariances make of the growth.
    expected: f64,
}

impl Sums {
    fn add(&mut self, other: &Sums) {
        self.rows += other.rows;
        self.turned += other.turned;
        self.position += other.position;
        self.rotation += other.rotation;
        self.before += other.before;
        self.expected += other.expected;
    }

    fn result(self, name: String) -> LeftOut {
        LeftOut {
            name,
            rows: self.rows,
            position_rms_m: (self.position / self.rows.max(1) as f64).sqrt(),
            rotation_rms_rad: (self.turned > 0).then(|| (self.rotation / self.turned as f64).sqrt()),
            growth: (self.position - self.before) / self.expected.max(f64::MIN_POSITIVE),
        }
    }
}

/// A fit of a sample, ready to lose rows.
struct Left<'a> {
    view: View<'a>,
    estimate: Estimate,
    gram: Vec<f64>,
    variance: f64,
    covariance: Vec<f64>,
}

impl<'a> Left<'a> {
    /// The optimum of the sample is one step from that of all rows.
    fn new(view: &View<'a>, sample: &[u32]) -> Option<Self> {
        let problem = view.problem(sample.to_vec());
        let normal = problem.normal(view.estimate);
        let n = problem.dim();
        let variance = view.variance;
        let factor = factor(&normal.gram, n, view.belief, variance)?;
        let pull: Vec<f64> = normal
            .gradient
            .iter()
            .zip(&view.belief.normal.gradient)
            .map(|(seen, believed)| seen + variance * believed)
            .collect();
        let step = linalg::cholesky_solve(&factor, &pull);
        Some(Left {
            view: *view,
            estimate: problem.retract(view.estimate, &step),
            covariance: covariance(&factor, variance)?,
            gram: normal.gram,
            variance,
        })
    }

    /// Leaves rows out: `N - N_fold` and `-g_fold` are information and gradient of the others at the optimum of all (theory.md §9 (42)).
    fn sums(&self, rows: &[u32]) -> Option<Sums> {
        let problem = self.view.problem(rows.to_vec());
        let part = problem.normal(&self.estimate);
        let rest: Vec<f64> = self.gram.iter().zip(&part.gram).map(|(all, part)| all - part).collect();
        let gradient: Vec<f64> = part.gradient.iter().map(|g| -g).collect();
        let n = gradient.len();
        let factor = factor(&rest, n, self.view.belief, self.variance)?;
        let without = problem.retract(&self.estimate, &linalg::cholesky_solve(&factor, &gradient));
        let covariance = covariance(&factor, self.variance)?;
        let both = DMatrix::from_iterator(n, n, covariance.iter().zip(&self.covariance).map(|(a, b)| a + b));
        let expected = self.position_variance(problem.layout(), rows, &both);
        let mut sums = Sums { rows: rows.len(), expected, ..Sums::default() };
        for error in self.view.errors(rows, &without) {
            sums.position += error.position_m.norm_squared();
            if let Some(turn) = error.rotation_rad {
                sums.rotation += turn.norm_squared();
                sums.turned += 1;
            }
        }
        let before = self.view.errors(rows, &self.estimate);
        sums.before = before.iter().map(|error| error.position_m.norm_squared()).sum();
        Some(sums)
    }

    /// Sum over rows of the variance of the predicted place, square metres.
    fn position_variance(&self, layout: &Layout, rows: &[u32], covariance: &DMatrix<f64>) -> f64 {
        let linkage = Linkage::new(&self.estimate);
        let of = |some: &[u32]| {
            let motions = motions(layout, &linkage, self.view.packed, &self.view.with_sights(some), 1);
            (&motions * covariance).dot(&motions)
        };
        rows.chunks(TOGETHER).map(of).sum()
    }
}

/// Clusters of configurations that are left out together when fits are compared.
const CLUSTERS: usize = 10;

/// Mean loss of the rows of each of some clusters of configurations by the fit of the others (theory.md §9 (42)), whose rows, one weight a
/// row of the data, count as they do in the fit; on a sample of the rows if they are many. `None` where a part of them tells too little.
#[must_use]
pub fn leave_clusters_out(
    view: &View<'_>,
    weights: &[f64],
    loss: impl Fn(u32, &RowError) -> f64,
) -> Option<f64> {
    let rows = sample_rows(view.rows, SAMPLE);
    let sample = View { rows: &rows, ..*view };
    let whole = view.problem(rows.clone()).with_weights(weights).normal(view.estimate);
    let n = whole.dim();
    let mut sum = 0.0;
    for cluster in clusters(&sample, CLUSTERS) {
        let problem = view.problem(cluster.clone()).with_weights(weights);
        let part = problem.normal(view.estimate);
        let rest: Vec<f64> = whole.gram.iter().zip(&part.gram).map(|(all, part)| all - part).collect();
        let factor = factor(&rest, n, view.belief, view.variance)?;
        let gradient: Vec<f64> = part.gradient.iter().map(|g| -g).collect();
        let without = problem.retract(view.estimate, &linalg::cholesky_solve(&factor, &gradient));
        let errors = view.errors(&cluster, &without);
        sum += cluster.iter().zip(&errors).map(|(&row, error)| loss(row, error)).sum::<f64>();
    }
    Some(sum / rows.len().max(1) as f64)
}
