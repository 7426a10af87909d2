//! Two names that are exchanged in some rows: of targets, or of places.

use std::ops::Range;

use super::fitter::{Fitter, SHORT, Score, sampled, taken};
use super::judge::{CALIBRATED_SHARE, short};
use super::{Diagnosis, DiagnosisKind};
use crate::estimate::Estimate;
use crate::measurement::{Dataset, Observation};

/// Most rounds of reassigning rows and refitting.
const ROUNDS: usize = 6;
/// Least reduction of the error of the rows concerned, and of all rows.
const ROW_GAIN: f64 = 5.0;
const GAIN: f64 = 1.5;
/// Most rows in a statement.
const NAMED: usize = 5;

/// What is named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Names {
    /// What was seen.
    Targets,
    /// From where it was seen, or what it touched.
    Stations,
}

impl Names {
    fn of(self, row: &Observation) -> usize {
        match self {
            Names::Targets => row.target,
            Names::Stations => row.station,
        }
    }

    fn of_mut(self, row: &mut Observation) -> &mut usize {
        match self {
            Names::Targets => &mut row.target,
            Names::Stations => &mut row.station,
        }
    }

    /// Exchanges two in an estimate.
    fn exchange(self, estimate: &mut Estimate, pair: (usize, usize)) {
        match self {
            Names::Targets => estimate.base_from_target.swap(pair.0, pair.1),
            Names::Stations => {
                let (first, second) = (*estimate.device(pair.0), *estimate.device(pair.1));
                (*estimate.device_mut(pair.0), *estimate.device_mut(pair.1)) = (second, first);
                let (first, second) = (estimate.range(pair.0), estimate.range(pair.1));
                *estimate.range_mut(pair.0) = second;
                *estimate.range_mut(pair.1) = first;
            }
        }
    }
}

/// Rows of the first models: all, the first half, and the second.
pub(super) fn starts(all: &Dataset) -> [Range<usize>; 3] {
    let half = all.len() / 2;
    [0..all.len(), 0..half, half..all.len()]
}

/// Two names, with the rows that fit better if they are exchanged in them.
pub(super) struct Exchange {
    /// Error of all rows after the exchange, metres.
    pub(super) error_m: f64,
    pub(super) pair: (usize, usize),
    /// The rows, of those that were searched.
    pub(super) rows: Vec<usize>,
    /// Their errors before and after, metres.
    before_m: f64,
    after_m: f64,
}

impl Exchange {
    /// The diagnosis. `searched` are the rows that were searched.
    pub(super) fn told(
        self,
        data: &Dataset,
        searched: &[u32],
        names: Names,
        words: [String; 2],
    ) -> Diagnosis {
        let rows: Vec<u32> = self.rows.into_iter().filter_map(|row| searched.get(row).copied()).collect();
        let where_ = where_words(data, searched, names, self.pair, &rows);
        let (kind, what) = match names {
            Names::Targets => (DiagnosisKind::TargetsSwapped, "the targets' names"),
            Names::Stations => (DiagnosisKind::PlacesSwapped, "which of them was meant"),
        };
        let [first, second] = words;
        let (before_mm, after_mm) = (self.before_m * 1e3, self.after_m * 1e3);
        let statement = format!(
            "exchanging the names of {first} and {second} {where_} lowers the calibrated error of {} from {} to {} mm (RMS): \
             check {what} there",
            if rows.len() == 1 { "that row" } else { "those rows" },
            short(before_mm),
            short(after_mm)
        );
        Diagnosis { kind, statement, rows, before_mm, after_mm }
    }
}

/// The rows of a pair that fit better exchanged, from first models of all rows and of either half.
pub(super) fn exchanged(
    fitter: &Fitter<'_>,
    all: &Dataset,
    names: Names,
    pair: (usize, usize),
    base: &Score,
) -> Option<Exchange> {
    let best = starts(all)
        .into_iter()
        .filter_map(|range| {
            let part: Vec<u32> = range.map(|row| row as u32).collect();
            reassigned(fitter, all, &taken(all, &part), names, pair, base.calibrated.total_m)
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    let (error_m, rows, before_m, after_m, rest) = best;
    let plausible = !rows.is_empty()
        && before_m > ROW_GAIN * after_m
        && after_m < ROW_GAIN * rest
        && base.calibrated.total_m > GAIN * error_m
        && error_m < CALIBRATED_SHARE * fitter.reach_m();
    plausible.then_some(Exchange { error_m, pair, rows, before_m, after_m })
}

/// Error of all rows, exchanged rows, their error before and after, and the error of the others.
type Reassigned = (f64, Vec<usize>, f64, f64, f64);

/// Reassigns rows to the name that they fit better and refits, until nothing changes.
fn reassigned(
    fitter: &Fitter<'_>,
    all: &Dataset,
    first: &Dataset,
    names: Names,
    pair: (usize, usize),
    base_m: f64,
) -> Option<Reassigned> {
    let exchanged = with_exchanged(all, names, pair, |_| true);
    let mut estimate = fitter.roughly_registered(&sampled(first)).0;
    let mut swapped = vec![false; all.len()];
    let packed = fitter.packed(all);
    let errors = |data: &Dataset, estimate: &Estimate| -> Vec<f64> {
        let errors = fitter.session(data, &packed).errors(&data.all_rows(), estimate);
        errors.iter().map(|error| fitter.squared_m2(error)).collect()
    };
    let mut least = base_m;
    for _ in 0..ROUNDS {
        let (kept, other) = (errors(all, &estimate), errors(&exchanged, &estimate));
        let next: Vec<bool> = kept.iter().zip(&other).map(|(kept, other)| other < kept).collect();
        let data = sampled(&with_exchanged(all, names, pair, |row| next[row]));
        let registered = fitter.roughly_registered(&data).0;
        let (calibrated, misfit) = fitter.calibrated(&data, &registered, SHORT);
        estimate = calibrated;
        let unchanged = next == swapped;
        swapped = next;
        if unchanged || misfit.total_m > least {
            break;
        }
        least = misfit.total_m;
    }
    let is_member = |row: &Observation| [pair.0, pair.1].contains(&names.of(row));
    let members = all.observations.iter().filter(|row| is_member(row)).count();
    let chosen = swapped.iter().filter(|swapped| **swapped).count();
    // The data do not show which of the two names is right: the smaller set of rows counts as exchanged.
    if 2 * chosen > members {
        let turned = all.observations.iter().map(is_member);
        swapped.iter_mut().zip(turned).for_each(|(swapped, member)| *swapped = member && !*swapped);
        names.exchange(&mut estimate, pair);
    }
    let (kept, other) = (errors(all, &estimate), errors(&exchanged, &estimate));
    let concerned: Vec<usize> = (0..all.len()).filter(|&row| swapped[row]).collect();
    let rms = |values: Vec<f64>| (values.iter().sum::<f64>() / values.len().max(1) as f64).sqrt();
    let before = rms(concerned.iter().map(|&row| kept[row]).collect());
    let after = rms(concerned.iter().map(|&row| other[row]).collect());
    let rest = rms((0..all.len()).filter(|&row| !swapped[row]).map(|row| kept[row]).collect());
    let error = rms((0..all.len()).map(|row| if swapped[row] { other[row] } else { kept[row] }).collect());
    error.is_finite().then_some((error, concerned, before, after, rest))
}

/// The data with a pair of names exchanged in some rows.
fn with_exchanged(
    all: &Dataset,
    names: Names,
    pair: (usize, usize),
    which: impl Fn(usize) -> bool,
) -> Dataset {
    let mut data = all.clone();
    for (row, observation) in data.observations.iter_mut().enumerate() {
        if which(row) {
            let name = names.of_mut(observation);
            *name = match *name {
                name if name == pair.0 => pair.1,
                name if name == pair.1 => pair.0,
                name => name,
            };
        }
    }
    data
}

/// Place of some of a pair's rows: from a row on, up to a row, or single rows.
fn where_words(
    data: &Dataset,
    rows: &[u32],
    names: Names,
    pair: (usize, usize),
    concerned: &[u32],
) -> String {
    let own = |row: &u32| [pair.0, pair.1].contains(&names.of(&data.observations[*row as usize]));
    let own: Vec<u32> = rows.iter().copied().filter(own).collect();
    match concerned {
        [first, .., _] if own.ends_with(concerned) => format!("from {} on", data.place(*first)),
        [_, .., last] if own.starts_with(concerned) => format!("up to {}", data.place(*last)),
        _ => {
            let named: Vec<String> = concerned.iter().take(NAMED).map(|&row| data.place(row)).collect();
            format!("in {}{}", named.join(", "), if concerned.len() > NAMED { ", …" } else { "" })
        }
    }
}
