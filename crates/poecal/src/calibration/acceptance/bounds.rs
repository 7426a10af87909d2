//! Bounds of statistics of errors, each with 95 % confidence: theory.md §9 (47) to (49).

use super::AcceptedStatistic;
use crate::calibration::Statistic;
use crate::distributions::{binomial_at_most, lower_mean_square, upper_mean_square};

/// Probability that a bound does not hold.
const RISK: f64 = 0.05;
/// The share of the errors that the 95 % statistic keeps.
const KEPT: f64 = 0.95;

/// A statistic with its bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::calibration) struct Bounded {
    pub(in crate::calibration) found: f64,
    pub(in crate::calibration) from: f64,
    pub(in crate::calibration) to: Option<f64>,
}

/// Absolute errors of one quantity, rows of one configuration together, and how far the noise of each measurement may be off.
pub(in crate::calibration) struct Errors {
    /// Error and 95 % bound of the noise of each row.
    pub(in crate::calibration) configurations: Vec<Vec<(f64, f64)>>,
    /// Numbers that a row measured.
    pub(in crate::calibration) components: usize,
}

impl Errors {
    pub(in crate::calibration) fn rows(&self) -> usize {
        self.configurations.iter().map(Vec::len).sum()
    }

    pub(in crate::calibration) fn bounded(&self, statistic: AcceptedStatistic) -> Option<Bounded> {
        match statistic {
            AcceptedStatistic::Rms => self.root_mean_square(),
            AcceptedStatistic::P95 => self.quantile(),
            AcceptedStatistic::Max => self.largest(),
        }
    }

    /// (47): a mean square of as many degrees of freedom as its scatter over configurations shows, at most those of independent numbers.
    fn root_mean_square(&self) -> Option<Bounded> {
        let (count, groups) = (self.rows() as f64, self.configurations.len() as f64);
        let square = |rows: &[(f64, f64)]| rows.iter().map(|(error, _)| error * error).sum::<f64>();
        let mean = self.configurations.iter().map(|rows| square(rows)).sum::<f64>() / count;
        if !mean.is_finite() {
            return None;
        }
        if groups < 2.0 || mean == 0.0 {
            return Some(Bounded { found: mean.sqrt(), from: 0.0, to: (mean == 0.0).then_some(0.0) });
        }
        let off = |rows: &Vec<(f64, f64)>| (square(rows) - mean * rows.len() as f64).powi(2);
        let variance =
            self.configurations.iter().map(off).sum::<f64>() / (count * count) * groups / (groups - 1.0);
        let freedom = (2.0 * mean * mean / variance).min(groups * self.components as f64);
        Some(mean_square(mean, freedom))
    }

    /// (48): order statistics, whatever the distribution; a configuration counts by its largest error.
    fn quantile(&self) -> Option<Bounded> {
        let largest = |rows: &Vec<(f64, f64)>| rows.iter().map(|(error, _)| *error).max_by(f64::total_cmp);
        let mut errors: Vec<f64> = self.configurations.iter().filter_map(largest).collect();
        errors.sort_unstable_by(f64::total_cmp);
        let found = Statistic::of(errors.clone())?.p95;
        let count = errors.len();
        // Fewer than k of the errors lie below the quantile with this probability.
        let fewer = |k: usize| k.checked_sub(1).map_or(0.0, |k| binomial_at_most(k, count, KEPT));
        let first = (1..=count).find(|&k| fewer(k) >= 1.0 - RISK);
        let last = (1..=count).rev().find(|&k| fewer(k) <= RISK);
        let at = |k: usize| errors.get(k - 1).copied();
        Some(Bounded { found, from: last.and_then(at).unwrap_or(0.0), to: first.and_then(at) })
    }

    /// (49): the largest error that was found, and how far the noise of its measurement may be off.
    fn largest(&self) -> Option<Bounded> {
        let rows = || self.configurations.iter().flatten();
        let most = |of: fn(&(f64, f64)) -> f64| rows().map(of).max_by(f64::total_cmp);
        let from = most(|(error, noise)| error - noise)?.max(0.0);
        Some(Bounded { found: most(|(error, _)| *error)?, from, to: most(|(error, noise)| error + noise) })
    }
}

/// (47) of a mean square with so many degrees of freedom.
pub(in crate::calibration) fn mean_square(mean: f64, freedom: f64) -> Bounded {
    let of = |square: f64| (mean * square).sqrt();
    Bounded {
        found: mean.sqrt(),
        from: of(1.0 / upper_mean_square(freedom)),
        to: Some(of(1.0 / lower_mean_square(freedom))).filter(|to| to.is_finite()),
    }
}
