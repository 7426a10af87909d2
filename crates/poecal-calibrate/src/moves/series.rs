//! Change-point test: a step or drift of the mean error along the row order (theory.md §9, *Change points*).

use nalgebra::Vector3;

use poecal_numerics::distributions::{median, median_point};
use poecal_numerics::linalg;

/// Least share of the rows, and least number, on each side of a step. Single regions of the workspace, measured one after the other, may
/// have twice the usual error.
const LEAST_SHARE: f64 = 0.1;
const LEAST_ROWS: usize = 4;
/// Least step over the residual standard deviation of a component, and least explained squares over its variance.
const STEP_SIGMAS: f64 = 3.0;
const STEP_CHANCE: f64 = 40.0;
/// The same for a drift, which has no free position.
const DRIFT_SIGMAS: f64 = 1.5;
const DRIFT_CHANCE: f64 = 25.0;
/// Changes below this are rounding, metres.
const ROUNDING_M: f64 = 1e-6;
/// Errors are limited to this multiple of their median during the search for a step.
const FAR: f64 = 20.0;
/// Errors beyond this multiple of the median beside a step are excluded, up to a share of the rows.
const WRONG: f64 = 8.0;
const MOST_WRONG: f64 = 0.15;
/// Rows for each function of the configuration that is separated from a drift.
const ROWS_PER_SHAPE: usize = 2;

/// Errors in the order of time.
#[derive(Clone, Debug, Default)]
pub(crate) struct ErrorSeries {
    pub(crate) rows: Vec<u32>,
    /// Errors, metres, in axes in which a move shifts them alike.
    pub(crate) values: Vec<Vector3<f64>>,
    /// Functions of each row's configuration that may vary with time; empty if no drift is searched for.
    pub(crate) configurations: Vec<Vec<f64>>,
}

/// A step or a drift.
#[derive(Clone, Debug)]
pub(crate) struct SeriesChange {
    /// First row after the step, as an index into the series; `None` for a drift.
    pub(crate) at: Option<usize>,
    /// Distance, metres; for a drift from the first row to the last.
    pub(crate) distance_m: f64,
    /// Explained sum of squares, square metres.
    pub(crate) explained: f64,
    /// Remaining root mean square error, metres.
    pub(crate) left_m: f64,
}

/// A model of the series, and its explained squares.
struct SeriesModel {
    at: usize,
    change: Vector3<f64>,
    explained: f64,
}

impl ErrorSeries {
    /// The step (or, if `may_drift`, the drift) that explains most, if it is significant: theory.md §9, *Change points*.
    pub(crate) fn change(&self, may_drift: bool) -> Option<SeriesChange> {
        let kept = self.without_wrong()?;
        let values: Vec<Vector3<f64>> = kept.iter().map(|&index| self.values[index]).collect();
        let count = values.len() as f64;
        let mean: Vector3<f64> = values.iter().sum::<Vector3<f64>>() / count;
        let total: f64 = values.iter().map(|value| (value - mean).norm_squared()).sum();
        let variance = |explained: f64| (total - explained).max(0.0) / (3.0 * count - 6.0).max(1.0);
        let step = strongest_step(&values)?;
        let steady = fit_drift(&values);
        if may_drift && steady.explained > step.explained {
            let left = variance(steady.explained);
            let beyond = self.beyond_configurations(&kept, &values, mean)?;
            let is_drift = beyond.explained > DRIFT_CHANCE * left
                && steady.change.norm() > DRIFT_SIGMAS * left.sqrt()
                && steady.change.norm() > ROUNDING_M;
            return is_drift.then(|| SeriesChange {
                at: None,
                distance_m: steady.change.norm(),
                explained: steady.explained,
                left_m: (3.0 * left).sqrt(),
            });
        }
        let left = variance(step.explained);
        let is_step = step.explained > STEP_CHANCE * left
            && step.change.norm() > STEP_SIGMAS * left.sqrt()
            && step.change.norm() > ROUNDING_M;
        is_step.then(|| SeriesChange {
            at: Some(kept[step.at]),
            distance_m: step.change.norm(),
            explained: step.explained,
            left_m: (3.0 * left).sqrt(),
        })
    }

    /// Indices without gross errors; `None` if too few remain.
    fn without_wrong(&self) -> Option<Vec<usize>> {
        let count = self.values.len();
        let far = FAR * median(self.values.iter().map(Vector3::norm))?;
        let near: Vec<Vector3<f64>> =
            self.values.iter().map(|value| value * (far / value.norm().max(far).max(f64::MIN_POSITIVE))).collect();
        let step = strongest_step(&near)?;
        let (before, after) = self.values.split_at(step.at);
        let middles = [median_point(before), median_point(after)];
        let aside = |index: usize| (self.values[index] - middles[usize::from(index >= step.at)]).norm();
        let wrong = WRONG * median((0..count).map(aside))?;
        let kept: Vec<usize> = (0..count).filter(|&index| aside(index) <= wrong).collect();
        if (count - kept.len()) as f64 > MOST_WRONG * count as f64 {
            return Some((0..count).collect());
        }
        Some(kept)
    }

    /// Squares that a drift explains beyond the configurations, which may vary with time.
    fn beyond_configurations(
        &self,
        kept: &[usize],
        values: &[Vector3<f64>],
        mean: Vector3<f64>,
    ) -> Option<SeriesModel> {
        let shapes: Vec<&[f64]> =
            kept.iter().filter_map(|&index| self.configurations.get(index)).map(Vec::as_slice).collect();
        let n = shapes.first()?.len();
        if shapes.len() != values.len() || values.len() < ROWS_PER_SHAPE * n {
            return None;
        }
        let times: Vec<f64> = (0..values.len()).map(|index| time(index, values.len())).collect();
        let mut gram = vec![0.0; n * n];
        let mut pull = vec![0.0; n];
        for (shape, time) in shapes.iter().zip(&times) {
            for i in 0..n {
                pull[i] += shape[i] * time;
                (i..n).for_each(|j| gram[i * n + j] += shape[i] * shape[j]);
            }
        }
        let factor = linalg::cholesky(&gram, n, 1e-9 * values.len() as f64)?;
        let coefficients = linalg::cholesky_solve(&factor, &pull);
        let own =
            |(shape, time): (&&[f64], &f64)| time - shape.iter().zip(&coefficients).map(|(a, b)| a * b).sum::<f64>();
        let own: Vec<f64> = shapes.iter().zip(&times).map(own).collect();
        let squares: f64 = own.iter().map(|time| time * time).sum();
        let sum: Vector3<f64> = own.iter().zip(values).map(|(&time, value)| (value - mean) * time).sum();
        let change = sum / squares.max(f64::MIN_POSITIVE);
        Some(SeriesModel { at: 0, change, explained: change.norm_squared() * squares })
    }
}

/// Time of a row, from -½ to ½.
fn time(index: usize, count: usize) -> f64 {
    index as f64 / (count.max(2) - 1) as f64 - 0.5
}

/// A linear drift, by least squares.
fn fit_drift(values: &[Vector3<f64>]) -> SeriesModel {
    let times = || (0..values.len()).map(|index| time(index, values.len()));
    let squares: f64 = times().map(|time| time * time).sum();
    let change =
        times().zip(values).map(|(time, value)| value * time).sum::<Vector3<f64>>() / squares.max(f64::MIN_POSITIVE);
    SeriesModel { at: 0, change, explained: change.norm_squared() * squares }
}

/// The step that explains most, among all positions with enough rows on both sides.
fn strongest_step(values: &[Vector3<f64>]) -> Option<SeriesModel> {
    let count = values.len();
    let total: Vector3<f64> = values.iter().sum();
    let mut before = Vector3::zeros();
    let mut best: Option<SeriesModel> = None;
    for (index, value) in values.iter().enumerate() {
        before += value;
        let (first, rest) = (index + 1, count - index - 1);
        let fewest = first.min(rest);
        if fewest < LEAST_ROWS || (fewest as f64) < LEAST_SHARE * count as f64 {
            continue;
        }
        let change = (total - before) / rest as f64 - before / first as f64;
        let explained = change.norm_squared() * first as f64 * rest as f64 / count as f64;
        if best.as_ref().is_none_or(|best| explained > best.explained) {
            best = Some(SeriesModel { at: first, change, explained });
        }
    }
    best
}
