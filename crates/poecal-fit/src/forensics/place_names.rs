//! Stations under another name, and known distances of stations that differ from the stated ones.

use std::collections::BTreeMap;

use super::diagnosis::format_short;
use super::exchange::{ExchangeableNames, find_exchange};
use super::fitter::{Fitter, Score, subsample};
use super::judge::CALIBRATED_SHARE;
use super::{Diagnosis, DiagnosisKind};
use crate::state::Estimate;
use poecal_model::measurement::{Dataset, KnownLength, Observation, Quantity};

/// Largest number of pairs of stations that are exchanged.
const PAIRS: usize = 15;
/// Least difference of a known distance from the distance that is estimated without it: as a share, and in errors of a row.
const OTHER_SHARE: f64 = 0.05;
const OTHER_ERRORS: f64 = 4.0;

/// Two stations whose names are exchanged in some rows, or the two sides of one. `rows` are those of `all` in the data.
pub(crate) fn names(
    fitter: &Fitter<'_>,
    data: &Dataset,
    all: &Dataset,
    rows: &[u32],
    estimate: &Estimate,
    base: &Score,
) -> Option<Diagnosis> {
    if !fitter.is_constrained() {
        return None;
    }
    let has_heights = all.observations.iter().any(|row| row.measurement.has_length_of(Quantity::Height));
    let pairs = pairs(fitter, all, estimate).into_iter().map(|(a, b)| ExchangeableNames::Stations(a, b));
    let all_names = pairs.chain(has_heights.then_some(ExchangeableNames::Sides));
    let found = all_names.filter_map(|names| find_exchange(fitter, all, names, base));
    let best = found.min_by(|a, b| a.error_m.total_cmp(&b.error_m))?;
    Some(best.diagnosis(data, rows, |station| data.station_words(station)))
}

/// Pairs of stations that may be exchanged: all pairs if there are few of one kind, otherwise those with the most votes of single rows.
fn pairs(fitter: &Fitter<'_>, all: &Dataset, estimate: &Estimate) -> Vec<(usize, usize)> {
    let count = all.station_count();
    let is_alike = |a: usize, b: usize| all.station_word(a) == all.station_word(b);
    let words = |a: usize| (0..a).filter(move |&b| is_alike(a, b)).map(move |b| (b, a));
    let alike: Vec<(usize, usize)> = (0..count).flat_map(words).collect();
    if alike.len() <= PAIRS {
        return alike;
    }
    let packed = fitter.pack_values(all);
    let mut votes: BTreeMap<(usize, usize), f64> = alike.iter().map(|&pair| (pair, 0.0)).collect();
    let squares = |data: &Dataset| -> Vec<f64> {
        let errors = fitter.session(data, &packed).errors(&data.all_rows(), estimate);
        errors.iter().map(|error| fitter.squared_m2(error)).collect()
    };
    let own = squares(all);
    for other in 0..count {
        let mut moved = all.clone();
        moved.observations.iter_mut().for_each(|row: &mut Observation| row.station = other);
        for (row, (own, there)) in own.iter().zip(squares(&moved)).enumerate() {
            let named = all.observations[row].station;
            if let Some(votes) = votes.get_mut(&(named.min(other), named.max(other)))
                && named != other
            {
                *votes += (own - there).max(0.0);
            }
        }
    }
    let mut pairs: Vec<((usize, usize), f64)> = votes.into_iter().filter(|(_, votes)| *votes > 0.0).collect();
    pairs.sort_by(|a, b| b.1.total_cmp(&a.1));
    pairs.into_iter().take(PAIRS).map(|(pair, _)| pair).collect()
}

/// A known distance that the robot contradicts, by a calibration without it.
pub(crate) fn known_length(fitter: &Fitter<'_>, data: &Dataset, all: &Dataset) -> Option<Diagnosis> {
    if data.lengths.is_empty() {
        return None;
    }
    let mut without = subsample(all);
    without.lengths.clear();
    let (estimate, score) = fitter.judge(&without);
    let error_m = score.calibrated.total_m;
    if error_m > CALIBRATED_SHARE * fitter.reach_m() {
        return None;
    }
    let found_m = |known: &KnownLength| {
        let [a, b] = known.stations.map(|station| estimate.device(station).inverse().translation);
        (a - b).norm()
    };
    let off_m = |known: &KnownLength| (found_m(known) - known.length_m).abs();
    let is_seen =
        |known: &&KnownLength| known.stations.iter().all(|&at| !without.seen_from(at, &without.all_rows()).is_empty());
    let is_other = |known: &&KnownLength| {
        off_m(known) > OTHER_SHARE * known.length_m.max(found_m(known)) && off_m(known) > OTHER_ERRORS * error_m
    };
    let others = data.lengths.iter().filter(is_seen).filter(is_other);
    let worst = others.max_by(|a, b| off_m(a).total_cmp(&off_m(b)))?;
    let [first, second] = worst.stations.map(|station| data.station_words(station));
    Some(Diagnosis {
        kind: DiagnosisKind::KnownLength,
        statement: format!(
            "the distance of {first} and {second} is stated as {} mm, and without it the robot finds {} mm: check the number, its \
             unit, and between which of them it was measured",
            format_short(worst.length_m * 1e3),
            format_short(found_m(worst) * 1e3)
        ),
        rows: Vec::new(),
        before_mm: off_m(worst) * 1e3,
        after_mm: error_m * 1e3,
    })
}
