//! Two names that are exchanged in some rows: of targets, of stations, or of the sides of a plane.

use std::f64::consts::PI;
use std::ops::Range;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::diagnosis::format_short;
use super::fitter::{Fitter, SHORT, Score, subsample, take_rows};
use super::judge::CALIBRATED_SHARE;
use super::{Diagnosis, DiagnosisKind};
use crate::state::Estimate;
use poecal_arm::lie::{Pose, rotation};
use poecal_model::measurement::{Dataset, Observation, Quantity};

/// Largest number of rounds of reassigning rows and refitting.
const ROUNDS: usize = 6;
/// Least reduction of the error of the rows concerned, and of all rows.
const ROW_GAIN: f64 = 5.0;
const GAIN: f64 = 1.5;
/// Number of parts of a session that make up blocks; blocks that are fitted; and those of them from which rows are assigned.
const BLOCKS: usize = 8;
const NEARER: usize = 16;
const FIRSTS: usize = 4;
/// Largest number of rows in a statement.
const NAMED: usize = 5;

/// Two names that may be exchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ExchangeableNames {
    /// Names of measured targets.
    Targets(usize, usize),
    /// Names of stations: of the device, or of the touched object.
    Stations(usize, usize),
    /// The sides of planes: the names of heights are their signs.
    Sides,
}

impl ExchangeableNames {
    /// Number of mean squared errors by which a row must fit better: heights near zero hardly determine their sign.
    fn margin(self) -> f64 {
        if self == ExchangeableNames::Sides { 1.0 } else { 0.0 }
    }

    /// True if an exchange changes a row: a touched plane has no side.
    fn counts(self, row: &Observation) -> bool {
        match self {
            ExchangeableNames::Targets(a, b) => [a, b].contains(&row.target),
            ExchangeableNames::Stations(a, b) => [a, b].contains(&row.station),
            ExchangeableNames::Sides => row.measurement.has_length_of(Quantity::Height),
        }
    }

    /// Groups of rows for which exchanging all is as good as exchanging none: those of each plane, or all that count.
    fn groups(self, all: &Dataset) -> Vec<Vec<usize>> {
        let place = |row: &usize| if self == ExchangeableNames::Sides { all.observations[*row].station } else { 0 };
        let mut groups = vec![Vec::new(); all.station_count()];
        let rows = (0..all.len()).filter(|&row| self.counts(&all.observations[row]));
        rows.for_each(|row| groups[place(&row)].push(row));
        groups
    }

    /// Exchanges the names in a row that counts.
    fn exchange_in(self, row: &mut Observation) {
        let other = |name: usize, [a, b]: [usize; 2]| if name == a { b } else { a };
        match self {
            ExchangeableNames::Targets(a, b) => row.target = other(row.target, [a, b]),
            ExchangeableNames::Stations(a, b) => row.station = other(row.station, [a, b]),
            ExchangeableNames::Sides => {
                row.measurement.lengths_mut().iter_mut().for_each(|height| *height = -*height);
            }
        }
    }

    /// Exchanges the names in an estimate; for sides, those of the plane of a row.
    fn exchange(self, estimate: &mut Estimate, row: &Observation) {
        match self {
            ExchangeableNames::Targets(a, b) => estimate.base_from_target.swap(a, b),
            ExchangeableNames::Stations(a, b) => {
                let (first, second) = (*estimate.device(a), *estimate.device(b));
                (*estimate.device_mut(a), *estimate.device_mut(b)) = (second, first);
                let (first, second) = (estimate.range(a), estimate.range(b));
                (*estimate.range_mut(a), *estimate.range_mut(b)) = (second, first);
            }
            ExchangeableNames::Sides => {
                let turned = Pose::new(rotation::exp(&Vector3::new(PI, 0.0, 0.0)), Vector3::zeros());
                let device = estimate.device_mut(row.station);
                *device = turned * *device;
            }
        }
    }
}

/// Rows of the first models: all, the first half, and the second.
pub(crate) fn starts(all: &Dataset) -> [Range<usize>; 3] {
    let half = all.len() / 2;
    [0..all.len(), 0..half, half..all.len()]
}

/// Two names, with the rows that fit better if the names are exchanged in them.
pub(crate) struct Exchange {
    /// Error of all rows after the exchange, metres.
    pub(crate) error_m: f64,
    pub(crate) names: ExchangeableNames,
    /// Exchanged rows, of those that were searched.
    pub(crate) rows: Vec<usize>,
    /// Errors of these rows before and after, metres.
    before_m: f64,
    after_m: f64,
}

impl Exchange {
    /// The diagnosis. `searched` are the rows that were searched.
    pub(crate) fn diagnosis(self, data: &Dataset, searched: &[u32], word: impl Fn(usize) -> String) -> Diagnosis {
        let rows: Vec<u32> = self.rows.into_iter().filter_map(|row| searched.get(row).copied()).collect();
        let where_ = where_words(data, searched, self.names, &rows);
        let exchanging = |a, b| format!("exchanging the names of {} and {}", word(a), word(b));
        let (kind, action, what) = match self.names {
            ExchangeableNames::Targets(a, b) => (DiagnosisKind::TargetsSwapped, exchanging(a, b), "the targets' names"),
            ExchangeableNames::Stations(a, b) => {
                (DiagnosisKind::PlacesSwapped, exchanging(a, b), "which of them was meant")
            }
            ExchangeableNames::Sides => (
                DiagnosisKind::HeightSign,
                "counting the heights the other way".to_owned(),
                "on which side of the plane they are, and which way the gauge counts",
            ),
        };
        let (before_mm, after_mm) = (self.before_m * 1e3, self.after_m * 1e3);
        let statement = format!(
            "{action} {where_} lowers the calibrated error of {} from {} to {} mm (RMS): \
             check {what} there",
            if rows.len() == 1 { "that row" } else { "those rows" },
            format_short(before_mm),
            format_short(after_mm)
        );
        Diagnosis { kind, statement, rows, before_mm, after_mm }
    }
}

/// First models: of all rows, and of either half. For sides, those blocks of rows are exchanged that fit best so.
fn firsts(fitter: &Fitter<'_>, all: &Dataset, names: ExchangeableNames) -> Vec<Estimate> {
    if names != ExchangeableNames::Sides {
        let part = |range: Range<usize>| {
            let part = take_rows(all, &range.map(|row| row as u32).collect::<Vec<_>>());
            fitter.roughly_registered(&subsample(&part)).0
        };
        return starts(all).into_iter().map(part).collect();
    }
    let planes = std::iter::once(None).chain((0..all.station_count()).map(Some));
    let ends = |plane| (0..BLOCKS).flat_map(move |a| (a + 1..=BLOCKS).map(move |b| (plane, a, b)));
    let blocks: Vec<(Option<usize>, usize, usize)> = planes.flat_map(ends).collect();
    let exchanged = |&(plane, a, b): &(Option<usize>, usize, usize)| {
        let rows = a * all.len() / BLOCKS..b * all.len() / BLOCKS;
        let is_of = |row: usize| plane.is_none_or(|plane| all.observations[row].station == plane);
        with_exchanged(all, names, |row| rows.contains(&row) && is_of(row))
    };
    let strong = fitter.with_strong_prior();
    let rough = |block| {
        let data = exchanged(block);
        let (estimate, misfit) = fitter.roughly_registered(&subsample(&data));
        (misfit.total_m, estimate, data)
    };
    let mut found: Vec<_> = blocks.par_iter().map(rough).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.truncate(NEARER);
    let firmly = |(_, estimate, data): (f64, Estimate, Dataset)| strong.calibrate(&subsample(&data), &estimate, SHORT);
    let mut found: Vec<_> = found.into_par_iter().map(firmly).collect();
    found.sort_by(|a, b| a.1.total_m.total_cmp(&b.1.total_m));
    found.into_iter().take(FIRSTS).map(|(estimate, _)| estimate).collect()
}

/// Rows of a pair of names that fit better exchanged, from several first models.
pub(crate) fn find_exchange(
    fitter: &Fitter<'_>,
    all: &Dataset,
    names: ExchangeableNames,
    base: &Score,
) -> Option<Exchange> {
    let best = firsts(fitter, all, names)
        .into_iter()
        .filter_map(|first| reassign_rows(fitter, all, first, names, base.calibrated.total_m))
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    let (error_m, rows, before_m, after_m, rest) = best;
    let plausible = !rows.is_empty()
        && before_m > ROW_GAIN * after_m
        && after_m < ROW_GAIN * rest
        && base.calibrated.total_m > GAIN * error_m
        && error_m < CALIBRATED_SHARE * fitter.reach_m();
    plausible.then_some(Exchange { error_m, names, rows, before_m, after_m })
}

/// Error of all rows, exchanged rows, their error before and after, and the error of the others.
type ReassignmentErrors = (f64, Vec<usize>, f64, f64, f64);

/// Reassigns rows to the name that they fit better and refits, until nothing changes.
fn reassign_rows(
    fitter: &Fitter<'_>,
    all: &Dataset,
    mut estimate: Estimate,
    names: ExchangeableNames,
    base_m: f64,
) -> Option<ReassignmentErrors> {
    let exchanged = with_exchanged(all, names, |_| true);
    let mut swapped = vec![false; all.len()];
    let packed = fitter.pack_values(all);
    let errors = |data: &Dataset, estimate: &Estimate| -> Vec<f64> {
        let errors = fitter.session(data, &packed).errors(&data.all_rows(), estimate);
        errors.iter().map(|error| fitter.squared_m2(error)).collect()
    };
    let strong = fitter.with_strong_prior();
    let firmly = fitter.is_constrained().then_some((&strong, f64::INFINITY));
    for (fitter, mut least) in firmly.into_iter().chain([(fitter, base_m)]) {
        for _ in 0..ROUNDS {
            let (kept, other) = (errors(all, &estimate), errors(&exchanged, &estimate));
            let margin = names.margin() * kept.iter().zip(&other).map(|(kept, other)| kept.min(*other)).sum::<f64>()
                / all.len().max(1) as f64;
            let next: Vec<bool> = kept.iter().zip(&other).map(|(kept, other)| other + margin < *kept).collect();
            let data = subsample(&with_exchanged(all, names, |row| next[row]));
            let registered = fitter.roughly_registered(&data).0;
            let (calibrated, misfit) = fitter.calibrate(&data, &registered, SHORT);
            estimate = calibrated;
            let unchanged = next == swapped;
            swapped = next;
            if unchanged || misfit.total_m > least {
                break;
            }
            least = misfit.total_m;
        }
    }
    // The data do not determine which of the two names is right: the smaller set of rows counts as exchanged.
    for group in names.groups(all) {
        let chosen = group.iter().filter(|&&row| swapped[row]).count();
        if let Some(&first) = group.first()
            && 2 * chosen > group.len()
        {
            group.iter().for_each(|&row| swapped[row] = !swapped[row]);
            names.exchange(&mut estimate, &all.observations[first]);
        }
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

/// The data with the names exchanged in the chosen rows that count.
fn with_exchanged(all: &Dataset, names: ExchangeableNames, which: impl Fn(usize) -> bool) -> Dataset {
    let mut data = all.clone();
    for (row, observation) in data.observations.iter_mut().enumerate() {
        if which(row) && names.counts(observation) {
            names.exchange_in(observation);
        }
    }
    data
}

/// Description of some of a pair's rows: from a row on, up to a row, or single rows.
fn where_words(data: &Dataset, rows: &[u32], names: ExchangeableNames, concerned: &[u32]) -> String {
    let own = |row: &u32| names.counts(&data.observations[*row as usize]);
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
