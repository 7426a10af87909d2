//! The search for a step along the order of the rows (theory.md §9, *Events*).

use nalgebra::{DMatrix, DVector};

use super::hypotheses::{HypothesisColumns, MovedPart};
use super::rows::{Optimum, SessionRows};
use super::unsettled_readings::describe_early_readings;
use super::wrong_configurations::without_wrong;
use crate::corrections::CorrectedFit;
use crate::steps::calibrated_fit::CalibratedFit;
use poecal_model::measurement::Dataset;
use poecal_numerics::linalg;

/// Fewest runs of a search, and on each side of a step.
const FEWEST: usize = 12;
const FEWEST_BESIDE: usize = 3;
/// Redundant numbers that a search needs.
const FREEDOM: f64 = 12.0;
/// Prior standard deviation of a step, metres and radians.
const FAR_M: f64 = 0.3;
const FAR_RAD: f64 = 0.3;
/// Least gain of an evident step, as a multiple of the variance of a number: clean sessions have up to 40.
const EVIDENT: f64 = 60.0;
/// Least ratio of this gain to the gain of any step along the order of a joint's values: deficiencies of the model cause such steps.
const OF_TIME: f64 = 2.0;
/// Fewest consecutive runs that a step may have made appear wrong.
const BLOCK: usize = 3;

/// A step.
#[derive(Clone, Debug)]
pub(crate) struct SearchStep {
    pub(crate) moved: MovedPart,
    /// First row after the step; for a drift the first row of all.
    pub(crate) first: u32,
    /// Its unknowns, metres and radians, and marks of those that are angles.
    pub(crate) size: Vec<f64>,
    pub(crate) turns: Vec<bool>,
    /// Explained squares over the variance of a number, in units of the correlation of the numbers of a configuration.
    pub(crate) gain: f64,
    /// Remaining share of the residuals (RMS).
    pub(crate) leaves: f64,
    /// Gain less the gain that its unknowns have on any rows: hypotheses are compared by it.
    score: f64,
    /// Subject and relative gain of the second-best hypothesis of another kind.
    pub(crate) other: Option<(MovedPart, f64)>,
}

/// Findings of a search.
#[derive(Clone, Debug, Default)]
pub(crate) struct SearchFindings {
    /// Rows of wrong configurations.
    pub(crate) wrong: Vec<u32>,
    /// An evident step.
    pub(crate) step: Option<SearchStep>,
    /// Statement about readings that were early in every configuration, if nothing else was found.
    pub(crate) early: Option<String>,
}

/// Searches a session, its rows in the order measured, by its corrected model.
pub(crate) fn search(fit: &CalibratedFit<'_>, found: &CorrectedFit, rows: &[u32]) -> Option<SearchFindings> {
    let rows = SessionRows::new(fit, found, rows)?;
    let data = &*fit.run.data;
    if rows.runs.len() < FEWEST {
        return None;
    }
    let (weights, optimum) = without_wrong(&rows)?;
    if optimum.freedom < FREEDOM {
        return None;
    }
    let is_wrong: Vec<bool> = weights.iter().map(|weight| *weight == 0.0).collect();
    // Several in a row may be right, and an object before or after them moved.
    let single: Vec<f64> = isolated_rows(&is_wrong).into_iter().map(|it| f64::from(u8::from(!it))).collect();
    let optimum = if single == weights { optimum } else { rows.optimum(&single)? };
    let step = best_evident_step(&rows, &optimum, &single, data);
    let of_rows = |wrong: &[bool]| -> Vec<u32> {
        let own = rows.runs.iter().zip(wrong).filter(|(_, wrong)| **wrong);
        own.flat_map(|(run, _)| rows.rows[run.clone()].to_vec()).collect()
    };
    let wrong = if step.is_some() { isolated_rows(&is_wrong) } else { is_wrong };
    let wrong = of_rows(&wrong);
    let early =
        step.is_none().then(|| describe_early_readings(&rows, &optimum, &single, data, &fit.run.robot)).flatten();
    Some(SearchFindings { wrong, step, early })
}

/// Wrong runs that are not part of a series of wrong runs.
fn isolated_rows(wrong: &[bool]) -> Vec<bool> {
    let mut found = wrong.to_vec();
    let mut at = 0;
    for block in wrong.chunk_by(|a, b| a == b) {
        if block.first() == Some(&true) && block.len() >= BLOCK {
            found[at..at + block.len()].fill(false);
        }
        at += block.len();
    }
    found
}

/// The best step of all hypotheses, if it is evident.
fn best_evident_step(rows: &SessionRows, optimum: &Optimum, weights: &[f64], data: &Dataset) -> Option<SearchStep> {
    let time: Vec<usize> = (0..rows.runs.len()).collect();
    let along = |order: &[usize], columns: &HypothesisColumns| strongest_step(rows, optimum, weights, columns, order);
    let all: Vec<(usize, SearchStep)> =
        rows.columns.iter().enumerate().filter_map(|(at, columns)| Some((at, along(&time, columns)?))).collect();
    let (best, step) = all.iter().max_by(|a, b| a.1.score.total_cmp(&b.1.score))?;
    if step.gain < EVIDENT {
        return None;
    }
    // Deficiencies of the model look like a step in the order of some joint's values too.
    let reading = |at: usize, joint: usize| data.readings(rows.rows[rows.runs[at].start] as usize)[joint];
    let of_joint = |joint: usize| {
        let mut order = time.clone();
        order.sort_by(|&a, &b| reading(a, joint).total_cmp(&reading(b, joint)));
        along(&order, rows.columns.get(*best)?).map(|it| it.gain)
    };
    let most = (0..data.reading_names().len()).filter_map(of_joint).fold(0.0, f64::max);
    if step.gain < OF_TIME * most {
        return None;
    }
    let others = all.iter().filter(|(at, _)| at != best).map(|(_, it)| (it.moved, it.score));
    let other = others.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(moved, score)| (moved, step.score - score));
    Some(SearchStep { other, ..step.clone() })
}

/// The runs that see a hypothesis, in an order, with their shares of its step; for a drift the position in time, from -1/2 to 1/2.
fn shares(rows: &SessionRows, weights: &[f64], columns: &HypothesisColumns, order: &[usize]) -> Vec<(usize, f64)> {
    let sees = |at: usize| weights[at] > 0.0 && rows.runs[at].clone().any(|row| columns.sees[row]);
    let seen: Vec<usize> = order.iter().copied().filter(|&at| sees(at)).collect();
    let is_drift = matches!(columns.moved, MovedPart::Drift(_));
    let last = (seen.len().max(2) - 1) as f64;
    let share = |place: usize| if is_drift { place as f64 / last - 0.5 } else { 1.0 };
    seen.into_iter().enumerate().map(|(place, at)| (at, share(place))).collect()
}

/// The step along an order of the runs that explains most; for a drift, the drift.
fn strongest_step(
    rows: &SessionRows,
    optimum: &Optimum,
    weights: &[f64],
    columns: &HypothesisColumns,
    order: &[usize],
) -> Option<SearchStep> {
    let (p, k) = (optimum.whitened.ncols(), columns.of.ncols());
    let far = columns.turns.iter().map(|turns| if *turns { FAR_RAD } else { FAR_M });
    let prior: Vec<f64> = far.map(|far| optimum.variance / (far * far)).collect();
    let seen = shares(rows, weights, columns, order);
    let mut gram = DMatrix::zeros(k, k);
    let mut mixed = DMatrix::zeros(p, k);
    let mut pull = DVector::zeros(k);
    let mut best: Option<(usize, f64, DVector<f64>)> = None;
    for (place, &(at, share)) in seen.iter().enumerate().rev() {
        let numbers = rows.numbers(&rows.runs[at]);
        let (begin, n) = (numbers.start, numbers.len());
        let own = columns.of.rows(begin, n) * share;
        gram += own.tr_mul(&own);
        mixed += optimum.whitened.rows(begin, n).tr_mul(&own);
        pull += own.tr_mul(&optimum.residual.rows(begin, n));
        let is_drift = matches!(columns.moved, MovedPart::Drift(_));
        let after = seen.len() - place;
        let counts = if is_drift { place == 0 } else { after.min(place) >= FEWEST_BESIDE };
        if !counts {
            continue;
        }
        let mut left = &gram - mixed.tr_mul(&mixed);
        prior.iter().enumerate().for_each(|(at, prior)| left[(at, at)] += prior);
        let Some(step) = linalg::solve_symmetric(left, &pull) else { continue };
        let gain = step.dot(&pull) / optimum.variance;
        if best.as_ref().is_none_or(|best| gain > best.1) {
            best = Some((place, gain, step));
        }
    }
    let (place, gain, step) = best?;
    let mut moved = DVector::zeros(optimum.residual.len());
    for &(at, share) in &seen[place..] {
        let numbers = rows.numbers(&rows.runs[at]);
        let of_step = columns.of.rows(numbers.start, numbers.len()) * &step * share;
        moved.rows_mut(numbers.start, numbers.len()).copy_from(&of_step);
    }
    let leaves = (1.0 - gain / optimum.freedom.max(1.0)).max(0.0).sqrt();
    let gain = gain / rows.shared_variance(optimum, weights, &moved);
    let first = *rows.rows.get(rows.runs.get(seen.get(place)?.0)?.start)?;
    let size = step.iter().copied().collect();
    let score = gain - k as f64 * (rows.runs.len() as f64).ln();
    let (moved, turns) = (columns.moved, columns.turns.clone());
    Some(SearchStep { moved, first, size, turns, gain, leaves, score, other: None })
}
