//! Explanations of changes: which motions take the most of them away, and whether by more than noise does.

use nalgebra::{DMatrix, DVector};

use super::options::{MOST_M, MOST_RAD};
use super::visit::{Columns, Of};
use poecal_numerics::distributions::{f_quantile, mean_square_quantile};
use poecal_numerics::linalg;

/// Probability to call an unchanged robot changed, of all explanations together.
const CHANCE: f64 = 0.01;
/// Degrees of freedom that stand for a level that is known.
pub(crate) const KNOWN: f64 = 1e6;
/// Share of a motion's own effect below which, beside what is free, nothing is left of it.
const NOTHING: f64 = 1e-10;
/// Gain, in variances, by which an explanation may be worse than the best and still explain the changes nearly as well.
const NEARLY: f64 = 7.0;
/// Normal quantile of the scatter that a stated repeatability allows: 0.1 %.
const ALLOWED: f64 = 3.09;

/// Standard deviations of a shift at which it would show.
const SHOWN: f64 = 5.0;

/// A kind of explanation, in the order in which they are tried: the simplest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// The device at a station.
    Device,
    /// The tool with all targets.
    Tool,
    /// One of several targets.
    Target,
    /// All lengths of the arm: warmth.
    Lengths,
    /// The zero of one joint.
    Zero,
    /// The axis of one joint.
    Axis,
    /// What one joint gives under weight.
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
    /// Whether it is an angle.
    pub turns: bool,
}

/// A motion that may explain changes, with its derivatives in standard deviations.
#[derive(Clone, Debug)]
pub(crate) struct Hypothesis {
    pub(crate) kind: Kind,
    /// What it is of.
    pub(crate) of: Vec<Of>,
    pub(crate) columns: DMatrix<f64>,
    /// Whether each unknown is an angle.
    pub(crate) turns: Vec<bool>,
    /// Whether it may be named: not where its size would have to be beyond what is linear to be seen at all.
    pub(crate) is_candidate: bool,
}

/// What a hypothesis explains.
#[derive(Clone, Debug)]
pub(crate) struct Tried {
    /// Its index.
    pub(crate) at: usize,
    /// How many unknowns are seen beside what is free.
    pub(crate) rank: usize,
    /// Squares that it takes away.
    pub(crate) gain: f64,
    /// Its unknowns, each with its standard deviation at level 1.
    pub(crate) step: Vec<(f64, f64)>,
    /// Covariance of these at level 1.
    pub(crate) covariance: DMatrix<f64>,
}

/// The level of the noise: what is known of the variance of a number, in units of that by which numbers are whitened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Level {
    /// Known: stated, or found on many rows.
    Known(f64),
    /// Squares of repeats, and their degrees of freedom: the changes that are left say the rest.
    Found(f64, f64),
}

/// What was found by all hypotheses.
#[derive(Clone, Debug)]
pub(crate) struct Verdict {
    /// The best explanation, if the changes are more than noise.
    pub(crate) best: Option<Tried>,
    /// Others that explain them nearly as well.
    pub(crate) nearly: Vec<Tried>,
    /// Variance of a number, and its degrees of freedom.
    pub(crate) variance: f64,
    pub(crate) freedom: f64,
    /// Whether more scatters than was stated.
    pub(crate) is_wider: bool,
    /// Squares that are left with what is free alone, and their degrees of freedom.
    pub(crate) left: (f64, f64),
}

/// Changes with what is free taken out.
pub(crate) struct Evidence {
    /// Orthonormal columns of what is free.
    free: DMatrix<f64>,
    residual: DVector<f64>,
    pub(crate) numbers: f64,
}

/// Orthonormal columns that span some columns, and by which steps of these: `Q = C S`.
fn spanned(columns: &DMatrix<f64>, before: &[f64]) -> (DMatrix<f64>, DMatrix<f64>) {
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

impl Evidence {
    /// Of whitened changes beside columns of what is free.
    pub(crate) fn new(residual: &DVector<f64>, free: &DMatrix<f64>) -> Self {
        let (free, _) = spanned(free, &norms(free));
        let residual = residual - &free * free.tr_mul(residual);
        Evidence { numbers: residual.len() as f64, free, residual }
    }

    /// Squares that are left, and their degrees of freedom.
    pub(crate) fn left(&self) -> (f64, f64) {
        (self.residual.norm_squared(), self.numbers - self.free.ncols() as f64)
    }

    /// What is left of columns beside what is free: orthonormal, and by which steps.
    fn beside(&self, columns: &DMatrix<f64>) -> (DMatrix<f64>, DMatrix<f64>) {
        let own = columns - &self.free * self.free.tr_mul(columns);
        spanned(&own, &norms(columns))
    }

    /// What a hypothesis explains; `None` where nothing is seen of it.
    pub(crate) fn tried(&self, at: usize, hypothesis: &Hypothesis) -> Option<Tried> {
        if !hypothesis.is_candidate {
            return None;
        }
        let (own, steps) = self.beside(&hypothesis.columns);
        if own.ncols() == 0 {
            return None;
        }
        let along = own.tr_mul(&self.residual);
        let step = &steps * &along;
        let sigma = steps.row_iter().map(|row| row.norm());
        let step = step.iter().copied().zip(sigma).collect();
        let covariance = &steps * steps.transpose();
        Some(Tried { at, rank: own.ncols(), gain: along.norm_squared(), step, covariance })
    }

    /// The unknowns of some columns, each with its standard deviation at level 1; `None` where they are not all seen.
    pub(crate) fn steps(&self, columns: &DMatrix<f64>) -> Option<Vec<(f64, f64)>> {
        let (own, steps) = self.beside(columns);
        let step = &steps * own.tr_mul(&self.residual);
        let all = step.iter().zip(steps.row_iter()).map(|(value, row)| (*value, row.norm()));
        (own.ncols() == columns.ncols()).then(|| all.collect())
    }

    /// Standard deviation at level 1 of the only unknown of some columns; infinite where it is not seen.
    pub(crate) fn sigma(&self, column: &DMatrix<f64>) -> f64 {
        let (_, steps) = self.beside(column);
        if steps.ncols() == 0 { f64::INFINITY } else { steps.row(0).norm() }
    }
}

/// Leaves out zeros of joints that are not seen, and pairs with them: their shift would be beyond what is linear before it showed.
pub(crate) fn leave_unseen_out(hypotheses: &mut [Hypothesis], evidence: &Evidence, level: Level) {
    let variance = match level {
        Level::Known(variance) => variance,
        Level::Found(..) => 1.0,
    };
    let is_unseen = |it: &Hypothesis| {
        let most = if it.turns.first() == Some(&true) { MOST_RAD } else { MOST_M };
        SHOWN * variance.sqrt() * evidence.sigma(&it.columns) > most
    };
    let unseen = hypotheses.iter().filter(|it| it.kind == Kind::Zero && is_unseen(it));
    let unseen: Vec<Of> = unseen.flat_map(|it| it.of.clone()).collect();
    let own = |it: &Hypothesis| matches!(it.kind, Kind::Zero | Kind::TwoZeros);
    let all = hypotheses.iter_mut().filter(|it| own(it) && it.of.iter().any(|of| unseen.contains(of)));
    all.for_each(|it| it.is_candidate = false);
}

/// Hypotheses with how much each must explain.
pub(crate) struct Tests {
    /// Probability of each hypothesis.
    chance: Vec<f64>,
}

impl Tests {
    /// Each kind has the same share of the probability, and within it each hypothesis.
    pub(crate) fn new(hypotheses: &[Hypothesis]) -> Self {
        let candidates = || hypotheses.iter().filter(|it| it.is_candidate);
        let of = |kind: Kind| candidates().filter(move |it| it.kind == kind).count().max(1) as f64;
        let mut kinds: Vec<Kind> = candidates().map(|it| it.kind).collect();
        kinds.sort_unstable();
        kinds.dedup();
        let kinds = kinds.len().max(1) as f64;
        Tests { chance: hypotheses.iter().map(|it| CHANCE / kinds / of(it.kind)).collect() }
    }

    /// What a gain of so many unknowns exceeds by noise with the probability of a hypothesis, in variances.
    pub(crate) fn quantile(&self, at: usize, rank: usize, freedom: f64) -> f64 {
        let rank = rank.max(1) as f64;
        let chance = self.chance.get(at).copied().unwrap_or(CHANCE);
        rank * f_quantile(chance, rank, freedom.clamp(1.0, KNOWN))
    }
}

impl Level {
    /// Variance of a number with so many squares left, and its degrees of freedom.
    fn variance(self, (squares, freedom): (f64, f64)) -> (f64, f64) {
        match self {
            Level::Known(variance) => (variance, KNOWN),
            Level::Found(own, count) => {
                let all = (count + freedom).max(1.0);
                (((own + squares) / all).max(f64::MIN_POSITIVE), all)
            }
        }
    }
}

/// The largest gain of any hypothesis over what noise of variance 1 is allowed.
pub(crate) fn ratio(evidence: &Evidence, hypotheses: &[Hypothesis], tests: &Tests) -> f64 {
    let tried = hypotheses.iter().enumerate().filter_map(|(at, it)| evidence.tried(at, it));
    tried.map(|it| it.gain / tests.quantile(it.at, it.rank, KNOWN)).fold(0.0, f64::max)
}

/// Whether squares that are left are no more than noise of a variance.
pub(crate) fn is_noise(squares: f64, freedom: f64, variance: f64) -> bool {
    freedom >= 1.0 && squares / freedom / variance <= mean_square_quantile(freedom, ALLOWED)
}

/// The simplest explanation that suffices.
pub(crate) fn explain(
    evidence: &Evidence,
    hypotheses: &[Hypothesis],
    tests: &Tests,
    level: Level,
) -> Verdict {
    let tried: Vec<Tried> =
        hypotheses.iter().enumerate().filter_map(|(at, it)| evidence.tried(at, it)).collect();
    let first = judged(evidence, hypotheses, tests, level, &tried);
    let Level::Known(stated) = level else { return first };
    // More than was stated scatters: the rows themselves say how much.
    let (squares, freedom) = evidence.left();
    let (gain, rank) = tried
        .iter()
        .map(|it| (it.gain, it.rank))
        .fold((0.0, 0), |most, it| if it.0 > most.0 { it } else { most });
    let (squares, freedom) = (squares - gain, freedom - rank as f64);
    if freedom < 1.0 || is_noise(squares, freedom, stated) {
        return first;
    }
    Verdict { is_wider: true, ..judged(evidence, hypotheses, tests, Level::Found(0.0, 0.0), &tried) }
}

fn judged(
    evidence: &Evidence,
    hypotheses: &[Hypothesis],
    tests: &Tests,
    level: Level,
    tried: &[Tried],
) -> Verdict {
    let left = evidence.left();
    let with = |it: &Tried| level.variance((left.0 - it.gain, left.1 - it.rank as f64));
    // How far each exceeds what noise is allowed, by what it leaves itself.
    let excess = |it: &Tried| {
        let (variance, freedom) = with(it);
        it.gain / variance / tests.quantile(it.at, it.rank, freedom)
    };
    let ratio = tried.iter().map(excess).fold(0.0, f64::max);
    let nothing = level.variance(left);
    let found = Verdict {
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
    // All are compared by one variance: that of the explanation that leaves least for its unknowns.
    let (variance, freedom) =
        tried.iter().map(with).fold(nothing, |least, it| if it.0 < least.0 { it } else { least });
    let score = |it: &Tried| it.gain / variance - tests.quantile(it.at, it.rank, freedom);
    let kind = |it: &Tried| hypotheses[it.at].kind;
    let is_simple = |it: &&Tried| kind(it) <= Kind::Zero;
    let most = |a: &&Tried, b: &&Tried| score(a).total_cmp(&score(b));
    let mut best = tried.iter().filter(is_simple).max_by(most);
    // A richer one must explain more by as much as noise is allowed.
    let richer = tried.iter().filter(|it| !is_simple(it)).filter(|it| {
        best.is_none_or(|best| {
            let more = it.rank.saturating_sub(best.rank).max(1);
            (it.gain - best.gain) / variance > tests.quantile(it.at, more, freedom)
        })
    });
    best = richer.max_by(most).or(best);
    let Some(best) = best else { return found };
    let has_all = |one: &Hypothesis, other: &Hypothesis| other.of.iter().all(|it| one.of.contains(it));
    let nearly =
        tried.iter().filter(|it| it.at != best.at && score(it) > score(best) - NEARLY && excess(it) > 0.5);
    let nearly = nearly
        .filter(|it| !(hypotheses[it.at].of.len() > 1 && has_all(&hypotheses[it.at], &hypotheses[best.at])));
    let mut nearly: Vec<Tried> = nearly.cloned().collect();
    nearly.sort_by(|a, b| score(b).total_cmp(&score(a)));
    let (variance, freedom) = with(best);
    Verdict { best: Some(best.clone()), nearly, variance, freedom, ..found }
}

/// Columns by what they are of, in standard deviations.
pub(crate) fn picked(
    jacobian: &DMatrix<f64>,
    columns: &[Columns],
    wanted: impl Fn(Of) -> bool,
) -> DMatrix<f64> {
    let places: Vec<usize> =
        columns.iter().filter(|it| wanted(it.of)).flat_map(|it| it.places.clone()).collect();
    jacobian.select_columns(&places)
}
