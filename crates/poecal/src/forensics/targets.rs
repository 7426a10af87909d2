//! Names of two targets exchanged: in all rows, from a row on, or in single rows.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use nalgebra::Vector3;

use super::few::{FewTargets, TARGETS, for_links};
use super::fitter::{Fitter, SHORT, Score, sampled, taken};
use super::judge::{CALIBRATED_SHARE, short};
use super::{Diagnosis, DiagnosisKind};
use crate::estimate::Estimate;
use crate::measurement::Dataset;

/// Least ratio of two targets' distances from their nominal places before and after the exchange.
const NEARER: f64 = 3.0;
/// Most rounds of reassigning rows and refitting.
const ROUNDS: usize = 6;
/// Least reduction of the error of the rows concerned, and of all rows.
const ROW_GAIN: f64 = 5.0;
const GAIN: f64 = 1.5;
/// Most targets whose names are compared: those that are farthest from nominal.
const MOVED: usize = 200;
/// Most pairs of targets that are tested, and most rows that vote for them.
const PAIRS: usize = 15;
const SUSPECTS: usize = 500;
/// Most rows in a statement.
const NAMED: usize = 5;

/// Two targets of the model at each other's places: their names are exchanged in all rows.
pub(super) fn names(fitter: &Fitter<'_>, data: &Dataset, found: &Estimate) -> Option<Diagnosis> {
    let of_model: BTreeSet<&String> = fitter.robot.targets.iter().map(|(name, _)| name).collect();
    let known = |target: usize| data.targets.get(target)?.as_ref().filter(|name| of_model.contains(name));
    let nominal = |target: usize| fitter.start.base_from_target.get(target).map(|pose| pose.translation);
    let place = |target: usize| found.base_from_target.get(target).map(|pose| pose.translation);
    let moved = furthest(data.targets.len(), |target| Some((nominal(target)? - place(target)?).norm()));
    for (k, &b) in moved.iter().enumerate() {
        for &a in moved.iter().take(k) {
            let (Some(first), Some(second)) = (known(a), known(b)) else { continue };
            let (Some(from_a), Some(from_b)) = (nominal(a), nominal(b)) else { continue };
            let (Some(at_a), Some(at_b)) = (place(a), place(b)) else { continue };
            let before = (at_a - from_a).norm().hypot((at_b - from_b).norm());
            let after = (at_a - from_b).norm().hypot((at_b - from_a).norm());
            if before > NEARER * after && before > 0.5 * (from_a - from_b).norm() {
                let (before_mm, after_mm) = (before * 1e3, after * 1e3);
                let statement = format!(
                    "exchanging the names of {first} and {second} brings them from {} to {} mm from their places in the \
                     model: check which is which",
                    short(before_mm),
                    short(after_mm)
                );
                let kind = DiagnosisKind::TargetsSwapped;
                return Some(Diagnosis { kind, statement, rows: Vec::new(), before_mm, after_mm });
            }
        }
    }
    None
}

/// The targets that are farthest from nominal, in their order.
fn furthest(count: usize, moved_m: impl Fn(usize) -> Option<f64>) -> Vec<usize> {
    let mut targets: Vec<usize> = (0..count).collect();
    if count > MOVED {
        let moved: Vec<f64> = targets.iter().map(|&target| moved_m(target).unwrap_or(0.0)).collect();
        targets.sort_by(|&a, &b| moved[b].total_cmp(&moved[a]));
        targets.truncate(MOVED);
        targets.sort_unstable();
    }
    targets
}

/// Two targets with exchanged names in some rows. `rows` are those of `all` in the data.
pub(super) fn rows(
    fitter: &Fitter<'_>,
    data: &Dataset,
    all: &Dataset,
    rows: &[u32],
    base: &Score,
) -> Option<Diagnosis> {
    let found = pairs(fitter, all).into_iter().filter_map(|pair| {
        if all.targets.len() <= TARGETS {
            return exchanged(fitter, all, pair, base);
        }
        let few = FewTargets::with(fitter, all, &[pair.0, pair.1]);
        let numbers = (few.number(pair.0)?, few.number(pair.1)?);
        let base = few.fitter.judged(&sampled(&few.data)).1;
        let (error, _, concerned, before, after) = exchanged(&few.fitter, &few.data, numbers, &base)?;
        let rows = few.rows(all);
        let concerned = concerned.into_iter().filter_map(|row| rows.get(row).copied()).collect();
        Some((error, pair, concerned, before, after))
    });
    let (_, pair, concerned, before, after) = found.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let name =
        |target: usize| data.targets.get(target).cloned().flatten().unwrap_or_else(|| "the tip".to_owned());
    let concerned: Vec<u32> = concerned.into_iter().filter_map(|row| rows.get(row).copied()).collect();
    let where_ = where_words(data, rows, pair, &concerned);
    Some(Diagnosis {
        kind: DiagnosisKind::TargetsSwapped,
        statement: format!(
            "exchanging the names of {} and {} {where_} lowers the calibrated error of {} from {} to {} mm (RMS): check the \
             targets' names there",
            name(pair.0),
            name(pair.1),
            if concerned.len() == 1 { "that row" } else { "those rows" },
            short(before * 1e3),
            short(after * 1e3)
        ),
        rows: concerned,
        before_mm: before * 1e3,
        after_mm: after * 1e3,
    })
}

/// Place of some of a pair's rows: from a row on, up to a row, or single rows.
fn where_words(data: &Dataset, rows: &[u32], pair: (usize, usize), concerned: &[u32]) -> String {
    let own = |row: &u32| [pair.0, pair.1].contains(&data.observations[*row as usize].target);
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

/// Pairs of targets that may be exchanged: all pairs of few targets, of many those with the most votes of single rows.
fn pairs(fitter: &Fitter<'_>, all: &Dataset) -> Vec<(usize, usize)> {
    let count = all.targets.len();
    if count * count.saturating_sub(1) / 2 <= PAIRS {
        return (0..count).flat_map(|b| (0..b).map(move |a| (a, b))).collect();
    }
    let mut votes: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for range in starts(all) {
        let part = taken(all, &range.map(|row| row as u32).collect::<Vec<_>>());
        let few = FewTargets::of(fitter, &part);
        let (estimate, _) = few.fitter.judged(&sampled(&few.data));
        vote(fitter, all, &few.placed(fitter, &part, &estimate), &mut votes);
    }
    let mut pairs: Vec<((usize, usize), f64)> = votes.into_iter().collect();
    pairs.sort_by(|a, b| b.1.total_cmp(&a.1));
    pairs.into_iter().take(PAIRS).map(|(pair, _)| pair).collect()
}

/// Votes of the worst rows: for each that fits another target better, the reduction of its squared error.
fn vote(fitter: &Fitter<'_>, all: &Dataset, estimate: &Estimate, votes: &mut BTreeMap<(usize, usize), f64>) {
    let mut seen = Vec::with_capacity(all.len());
    for_links(fitter, all, estimate, |row, link| {
        let position = all.observations[row].measurement.observe().position();
        seen.extend(position.map(|position| (row, link.act(&position))));
    });
    let squared = |target: usize, place: &Vector3<f64>| {
        (estimate.base_from_target[target].translation - place).norm_squared()
    };
    let own = |(row, place): &(usize, Vector3<f64>)| squared(all.observations[*row].target, place);
    seen.sort_by(|a, b| own(b).total_cmp(&own(a)));
    seen.truncate(SUSPECTS);
    for one in &seen {
        let (target, own) = (all.observations[one.0].target, own(one));
        let others = (0..all.targets.len()).filter(|&other| other != target);
        let nearest = others.map(|other| (squared(other, &one.1), other)).min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((squared, other)) = nearest.filter(|(squared, _)| *squared < own) {
            *votes.entry((target.min(other), target.max(other))).or_default() += own - squared;
        }
    }
}

/// Rows of the first models: all, the first half, and the second.
fn starts(all: &Dataset) -> [Range<usize>; 3] {
    let half = all.len() / 2;
    [0..all.len(), 0..half, half..all.len()]
}

/// Error after the exchange, the pair, its rows, and their errors before and after.
type Exchange = (f64, (usize, usize), Vec<usize>, f64, f64);

/// The rows of a pair that fit better exchanged, from first models of all rows and of either half.
fn exchanged(fitter: &Fitter<'_>, all: &Dataset, pair: (usize, usize), base: &Score) -> Option<Exchange> {
    let best = starts(all)
        .into_iter()
        .filter_map(|range| {
            let part: Vec<u32> = range.map(|row| row as u32).collect();
            reassigned(fitter, all, &taken(all, &part), pair, base.calibrated.total_m)
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    let (error, concerned, before, after, rest) = best;
    let plausible = !concerned.is_empty()
        && before > ROW_GAIN * after
        && after < ROW_GAIN * rest
        && base.calibrated.total_m > GAIN * error
        && error < CALIBRATED_SHARE * fitter.reach_m();
    plausible.then_some((error, pair, concerned, before, after))
}

/// Error of all rows, exchanged rows, their error before and after, and the error of the others.
type Reassigned = (f64, Vec<usize>, f64, f64, f64);

/// Reassigns rows to the target that they fit better and refits, until nothing changes.
fn reassigned(
    fitter: &Fitter<'_>,
    all: &Dataset,
    first: &Dataset,
    pair: (usize, usize),
    base_m: f64,
) -> Option<Reassigned> {
    let exchanged = with_exchanged(all, pair, |_| true);
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
        let data = sampled(&with_exchanged(all, pair, |row| next[row]));
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
    let members = all.observations.iter().filter(|row| row.target == pair.0 || row.target == pair.1).count();
    let chosen = swapped.iter().filter(|swapped| **swapped).count();
    // The data do not show which of the two names is right: the smaller set of rows counts as exchanged.
    if 2 * chosen > members {
        let turned = all.observations.iter().map(|row| row.target == pair.0 || row.target == pair.1);
        swapped.iter_mut().zip(turned).for_each(|(swapped, member)| *swapped = member && !*swapped);
        estimate.base_from_target.swap(pair.0, pair.1);
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

/// The data with a pair of targets exchanged in some rows.
fn with_exchanged(all: &Dataset, pair: (usize, usize), which: impl Fn(usize) -> bool) -> Dataset {
    let mut data = all.clone();
    for (row, observation) in data.observations.iter_mut().enumerate() {
        if which(row) {
            observation.target = match observation.target {
                target if target == pair.0 => pair.1,
                target if target == pair.1 => pair.0,
                target => target,
            };
        }
    }
    data
}
