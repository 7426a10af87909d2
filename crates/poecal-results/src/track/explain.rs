//! Explanations of changes: the motions that remove most of them, and whether by more than noise does.

use nalgebra::{DMatrix, DVector};

use super::options::{MOST_M, MOST_RAD};
use super::visit::{ChangeColumns, ColumnSubject};
use poecal_numerics::distributions::{f_quantile, mean_square_quantile};
use poecal_numerics::linalg;

/// Probability to call an unchanged robot changed, of all explanations together.
const CHANCE: f64 = 0.01;
/// Degrees of freedom that represent a known level.
pub(crate) const KNOWN: f64 = 1e6;
/// Share of a motion's own effect below which nothing of it remains beside the free unknowns.
const NOTHING: f64 = 1e-10;
/// Gain, in variances, by which an explanation may be worse than the best and still explain the changes nearly as well.
const NEARLY: f64 = 7.0;
/// Normal quantile of the scatter that a stated repeatability allows: 0.1 %.
const ALLOWED: f64 = 3.09;

/// Number of standard deviations at which a shift becomes visible.
const SHOWN: f64 = 5.0;

/// A kind of explanation, in the order in which they are tried: the simplest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ExplanationKind {
    /// The device at a station.
    Device,
    /// The tool with all targets.
    Tool,
    /// One of several targets.
    Target,
    /// All lengths of the arm: thermal expansion.
    Lengths,
    /// The zero of one joint.
    Zero,
    /// The axis of one joint.
    Axis,
    /// The compliance of one joint.
    Give,
    /// The zeros of two joints.
    TwoZeros,
    /// The zeros of three joints or more.
    Zeros,
}

/// An unknown of an explanation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// Its value, radians, metres or a share.
    pub value: f64,
    /// Its standard deviation.
    pub sigma: f64,
    /// True if it is an angle.
    pub turns: bool,
}

/// A motion that may explain changes, with its derivatives in standard deviations.
#[derive(Clone, Debug)]
pub(crate) struct MotionHypothesis {
    pub(crate) kind: ExplanationKind,
    /// Subjects of its columns.
    pub(crate) of: Vec<ColumnSubject>,
    pub(crate) columns: DMatrix<f64>,
    /// For each unknown, true if it is an angle.
    pub(crate) turns: Vec<bool>,
    /// True if it may be named. It may not if its size would have to exceed the linear range to be seen at all.
    pub(crate) is_candidate: bool,
}

/// Result of one hypothesis.
#[derive(Clone, Debug)]
pub(crate) struct TriedHypothesis {
    /// Its index.
    pub(crate) at: usize,
    /// Number of unknowns that are seen beside the free ones.
    pub(crate) rank: usize,
    /// Reduction of the sum of squares.
    pub(crate) gain: f64,
    /// Its unknowns, each with its standard deviation at level 1.
    pub(crate) step: Vec<(f64, f64)>,
    /// Covariance of these at level 1.
    pub(crate) covariance: DMatrix<f64>,
}

/// The level of the noise: knowledge of the variance of a number, in units of the one by which numbers are whitened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum NoiseLevel {
    /// Known: stated, or estimated from many rows.
    Known(f64),
    /// Sum of squares of repeats, and their degrees of freedom; the remaining changes add to the estimate.
    Found(f64, f64),
}

/// Result of all hypotheses.
#[derive(Clone, Debug)]
pub(crate) struct HypothesisVerdict {
    /// The best explanation, if the changes are more than noise.
    pub(crate) best: Option<TriedHypothesis>,
    /// Others that explain them nearly as well.
    pub(crate) nearly: Vec<TriedHypothesis>,
    /// Variance of a number, and its degrees of freedom.
    pub(crate) variance: f64,
    pub(crate) freedom: f64,
    /// True if the scatter exceeds the stated one.
    pub(crate) is_wider: bool,
    /// Sum of squares that remains with the free unknowns alone, and its degrees of freedom.
    pub(crate) left: (f64, f64),
}

/// Changes with the free unknowns projected out.
pub(crate) struct ProjectedChanges {
    /// Orthonormal basis of the columns of the free unknowns.
    free: DMatrix<f64>,
    residual: DVector<f64>,
    pub(crate) numbers: f64,
}

/// Orthonormal basis of the span of some columns, and the steps of these that form it: `Q = C S`.
fn span_columns(columns: &DMatrix<f64>, before: &[f64]) -> (DMatrix<f64>, DMatrix<f64>) {
    let k = columns.ncols();
    let unit: Vec<f64> = before.iter().map(|norm| if *norm > 0.0 { 1.0 / norm } else { 0.0 }).collect();
    let gram = columns.tr_mul(columns);
    let upper: Vec<f64> = (0..k * k).map(|at| gram[(at / k, at % k)] * unit[at / k] * unit[at % k]).collect();
    let (values, vectors) = linalg::symmetric_eigen(&upper, k);
    let kept: Vec<usize> = (0..k).filter(|&at| values[at] > NOTHING).collect();
    let mut steps = DMatrix::zeros(k, kept.len());
    for (to, &at) in kept.iter().enumerate() {
        for row in 0..k {
            steps[(row, to)] = unit[row] * vectors[(row, at)] / values[at].sqrt();
        }
    }
    (columns * &steps, steps)
}

fn norms(columns: &DMatrix<f64>) -> Vec<f64> {
    columns.column_iter().map(|it| it.norm()).collect()
}

impl ProjectedChanges {
    /// Evidence of whitened changes beside columns of the free unknowns.
    pub(crate) fn new(residual: &DVector<f64>, free: &DMatrix<f64>) -> Self {
        let (free, _) = span_columns(free, &norms(free));
        let residual = residual - &free * free.tr_mul(residual);
        ProjectedChanges { numbers: residual.len() as f64, free, residual }
    }

    /// Sum of squares that remains, and its degrees of freedom.
    pub(crate) fn remaining_squares(&self) -> (f64, f64) {
        (self.residual.norm_squared(), self.numbers - self.free.ncols() as f64)
    }

    /// Orthonormal basis of the part of columns that the free unknowns leave, and the steps that form it.
    fn project_out_free(&self, columns: &DMatrix<f64>) -> (DMatrix<f64>, DMatrix<f64>) {
        let own = columns - &self.free * self.free.tr_mul(columns);
        span_columns(&own, &norms(columns))
    }

    /// Result of a hypothesis; `None` if nothing of it is seen.
    pub(crate) fn try_hypothesis(&self, at: usize, hypothesis: &MotionHypothesis) -> Option<TriedHypothesis> {
        if !hypothesis.is_candidate {
            return None;
        }
        let (own, steps) = self.project_out_free(&hypothesis.columns);
        if own.ncols() == 0 {
            return None;
        }
        let along = own.tr_mul(&self.residual);
        let step = &steps * &along;
        let sigma = steps.row_iter().map(|row| row.norm());
        let step = step.iter().copied().zip(sigma).collect();
        let covariance = &steps * steps.transpose();
        Some(TriedHypothesis { at, rank: own.ncols(), gain: along.norm_squared(), step, covariance })
    }

    /// The unknowns of some columns, each with its standard deviation at level 1; `None` if they are not all seen.
    pub(crate) fn steps(&self, columns: &DMatrix<f64>) -> Option<Vec<(f64, f64)>> {
        let (own, steps) = self.project_out_free(columns);
        let step = &steps * own.tr_mul(&self.residual);
        let all = step.iter().zip(steps.row_iter()).map(|(value, row)| (*value, row.norm()));
        (own.ncols() == columns.ncols()).then(|| all.collect())
    }

    /// Standard deviation at level 1 of the only unknown of some columns; infinite if it is not seen.
    pub(crate) fn sigma(&self, column: &DMatrix<f64>) -> f64 {
        let (_, steps) = self.project_out_free(column);
        if steps.ncols() == 0 { f64::INFINITY } else { steps.row(0).norm() }
    }
}

/// Excludes zeros of joints that are not seen, and pairs with them: their shift would exceed the linear range before it became visible.
pub(crate) fn leave_unseen_out(hypotheses: &mut [MotionHypothesis], evidence: &ProjectedChanges, level: NoiseLevel) {
    let variance = match level {
        NoiseLevel::Known(variance) => variance,
        NoiseLevel::Found(..) => 1.0,
    };
    let is_unseen = |it: &MotionHypothesis| {
        let most = if it.turns.first() == Some(&true) { MOST_RAD } else { MOST_M };
        SHOWN * variance.sqrt() * evidence.sigma(&it.columns) > most
    };
    let unseen = hypotheses.iter().filter(|it| it.kind == ExplanationKind::Zero && is_unseen(it));
    let unseen: Vec<ColumnSubject> = unseen.flat_map(|it| it.of.clone()).collect();
    let own = |it: &MotionHypothesis| matches!(it.kind, ExplanationKind::Zero | ExplanationKind::TwoZeros);
    let all = hypotheses.iter_mut().filter(|it| own(it) && it.of.iter().any(|of| unseen.contains(of)));
    all.for_each(|it| it.is_candidate = false);
}

/// Critical gains of the hypotheses.
pub(crate) struct HypothesisTests {
    /// Significance level of each hypothesis.
    chance: Vec<f64>,
}

impl HypothesisTests {
    /// Tests with the same share of the significance level for each kind, and within a kind for each hypothesis (Bonferroni).
    pub(crate) fn new(hypotheses: &[MotionHypothesis]) -> Self {
        let candidates = || hypotheses.iter().filter(|it| it.is_candidate);
        let of = |kind: ExplanationKind| candidates().filter(move |it| it.kind == kind).count().max(1) as f64;
        let mut kinds: Vec<ExplanationKind> = candidates().map(|it| it.kind).collect();
        kinds.sort_unstable();
        kinds.dedup();
        let kinds = kinds.len().max(1) as f64;
        HypothesisTests { chance: hypotheses.iter().map(|it| CHANCE / kinds / of(it.kind)).collect() }
    }

    /// Gain of so many unknowns, in variances, that noise exceeds with the significance level of a hypothesis.
    pub(crate) fn quantile(&self, at: usize, rank: usize, freedom: f64) -> f64 {
        let rank = rank.max(1) as f64;
        let chance = self.chance.get(at).copied().unwrap_or(CHANCE);
        rank * f_quantile(chance, rank, freedom.clamp(1.0, KNOWN))
    }
}

impl NoiseLevel {
    /// Variance of a number with such a remaining sum of squares, and its degrees of freedom.
    fn variance(self, (squares, freedom): (f64, f64)) -> (f64, f64) {
        match self {
            NoiseLevel::Known(variance) => (variance, KNOWN),
            NoiseLevel::Found(own, count) => {
                let all = (count + freedom).max(1.0);
                (((own + squares) / all).max(f64::MIN_POSITIVE), all)
            }
        }
    }
}

/// The largest ratio of any hypothesis' gain to its critical gain for noise of variance 1.
pub(crate) fn ratio(evidence: &ProjectedChanges, hypotheses: &[MotionHypothesis], tests: &HypothesisTests) -> f64 {
    let tried = hypotheses.iter().enumerate().filter_map(|(at, it)| evidence.try_hypothesis(at, it));
    tried.map(|it| it.gain / tests.quantile(it.at, it.rank, KNOWN)).fold(0.0, f64::max)
}

/// True if a remaining sum of squares is no more than noise of a variance.
pub(crate) fn is_noise(squares: f64, freedom: f64, variance: f64) -> bool {
    freedom >= 1.0 && squares / freedom / variance <= mean_square_quantile(freedom, ALLOWED)
}

/// The simplest sufficient explanation.
pub(crate) fn explain(
    evidence: &ProjectedChanges,
    hypotheses: &[MotionHypothesis],
    tests: &HypothesisTests,
    level: NoiseLevel,
) -> HypothesisVerdict {
    let tried: Vec<TriedHypothesis> =
        hypotheses.iter().enumerate().filter_map(|(at, it)| evidence.try_hypothesis(at, it)).collect();
    let first = judge_hypotheses(evidence, hypotheses, tests, level, &tried);
    let NoiseLevel::Known(stated) = level else { return first };
    // The scatter exceeds the stated one: the rows themselves determine it.
    let (squares, freedom) = evidence.remaining_squares();
    let (gain, rank) =
        tried.iter().map(|it| (it.gain, it.rank)).fold((0.0, 0), |most, it| if it.0 > most.0 { it } else { most });
    let (squares, freedom) = (squares - gain, freedom - rank as f64);
    if freedom < 1.0 || is_noise(squares, freedom, stated) {
        return first;
    }
    HypothesisVerdict {
        is_wider: true,
        ..judge_hypotheses(evidence, hypotheses, tests, NoiseLevel::Found(0.0, 0.0), &tried)
    }
}

fn judge_hypotheses(
    evidence: &ProjectedChanges,
    hypotheses: &[MotionHypothesis],
    tests: &HypothesisTests,
    level: NoiseLevel,
    tried: &[TriedHypothesis],
) -> HypothesisVerdict {
    let left = evidence.remaining_squares();
    let with = |it: &TriedHypothesis| level.variance((left.0 - it.gain, left.1 - it.rank as f64));
    // Excess of each over its critical gain, by its own remaining squares.
    let excess = |it: &TriedHypothesis| {
        let (variance, freedom) = with(it);
        it.gain / variance / tests.quantile(it.at, it.rank, freedom)
    };
    let ratio = tried.iter().map(excess).fold(0.0, f64::max);
    let nothing = level.variance(left);
    let found = HypothesisVerdict {
        best: None,
        nearly: Vec::new(),
        variance: nothing.0,
        freedom: nothing.1,
        is_wider: false,
        left,
    };
    if ratio <= 1.0 {
        return found;
    }
    // All are compared by one variance: that of the explanation with the smallest remaining squares for its unknowns.
    let (variance, freedom) = tried.iter().map(with).fold(nothing, |least, it| if it.0 < least.0 { it } else { least });
    let score = |it: &TriedHypothesis| it.gain / variance - tests.quantile(it.at, it.rank, freedom);
    let kind = |it: &TriedHypothesis| hypotheses[it.at].kind;
    let is_simple = |it: &&TriedHypothesis| kind(it) <= ExplanationKind::Zero;
    let most = |a: &&TriedHypothesis, b: &&TriedHypothesis| score(a).total_cmp(&score(b));
    let mut best = tried.iter().filter(is_simple).max_by(most);
    // A richer explanation must explain more by its critical gain.
    let richer = tried.iter().filter(|it| !is_simple(it)).filter(|it| {
        best.is_none_or(|best| {
            let more = it.rank.saturating_sub(best.rank).max(1);
            (it.gain - best.gain) / variance > tests.quantile(it.at, more, freedom)
        })
    });
    best = richer.max_by(most).or(best);
    let Some(best) = best else { return found };
    let has_all = |one: &MotionHypothesis, other: &MotionHypothesis| other.of.iter().all(|it| one.of.contains(it));
    let nearly = tried.iter().filter(|it| it.at != best.at && score(it) > score(best) - NEARLY && excess(it) > 0.5);
    let nearly =
        nearly.filter(|it| !(hypotheses[it.at].of.len() > 1 && has_all(&hypotheses[it.at], &hypotheses[best.at])));
    let mut nearly: Vec<TriedHypothesis> = nearly.cloned().collect();
    nearly.sort_by(|a, b| score(b).total_cmp(&score(a)));
    let (variance, freedom) = with(best);
    HypothesisVerdict { best: Some(best.clone()), nearly, variance, freedom, ..found }
}

/// Columns by their subjects, in standard deviations.
pub(crate) fn pick_columns(
    jacobian: &DMatrix<f64>,
    columns: &[ChangeColumns],
    wanted: impl Fn(ColumnSubject) -> bool,
) -> DMatrix<f64> {
    let places: Vec<usize> = columns.iter().filter(|it| wanted(it.of)).flat_map(|it| it.places.clone()).collect();
    jacobian.select_columns(&places)
}
