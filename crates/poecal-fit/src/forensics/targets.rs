//! Names of two targets exchanged: in all rows, from a row on, or in single rows.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;

use super::diagnosis::format_short;
use super::exchange::{ExchangeableNames, find_exchange, starts};
use super::few_targets::{FewTargets, for_links};
use super::fitter::{Fitter, Score, subsample, take_rows};
use super::{Diagnosis, DiagnosisKind};
use crate::state::Estimate;
use poecal_model::measurement::Dataset;

/// Least ratio of two targets' distances from their nominal positions before and after the exchange.
const NEARER: f64 = 3.0;
/// Largest number of targets whose names are compared: those that are farthest from nominal.
const MOVED: usize = 200;
/// Largest number of pairs of targets that are tested, and of rows that vote for them.
const PAIRS: usize = 15;
const SUSPECTS: usize = 500;

/// Two targets of the model at each other's positions: their names are exchanged in all rows.
pub(crate) fn names(fitter: &Fitter<'_>, data: &Dataset, found: &Estimate) -> Option<Diagnosis> {
    let of_model: BTreeSet<&String> = fitter.robot.targets.iter().map(|(name, _)| name).collect();
    let known = |target: usize| data.targets.get(target)?.as_ref().filter(|name| of_model.contains(name));
    let nominal = |target: usize| fitter.start.base_from_target.get(target).map(|pose| pose.translation);
    let place = |target: usize| found.base_from_target.get(target).map(|pose| pose.translation);
    let moved = farthest_targets(data.targets.len(), |target| Some((nominal(target)? - place(target)?).norm()));
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
                    format_short(before_mm),
                    format_short(after_mm)
                );
                let kind = DiagnosisKind::TargetsSwapped;
                return Some(Diagnosis { kind, statement, rows: Vec::new(), before_mm, after_mm });
            }
        }
    }
    None
}

/// The targets that are farthest from nominal, in their order.
fn farthest_targets(count: usize, moved_m: impl Fn(usize) -> Option<f64>) -> Vec<usize> {
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
pub(crate) fn rows(
    fitter: &Fitter<'_>,
    data: &Dataset,
    all: &Dataset,
    rows: &[u32],
    base: &Score,
) -> Option<Diagnosis> {
    let found = pairs(fitter, all).into_iter().filter_map(|pair| {
        if FewTargets::are_all(all) {
            return find_exchange(fitter, all, ExchangeableNames::Targets(pair.0, pair.1), base);
        }
        let few = FewTargets::with_targets(fitter, all, &[pair.0, pair.1]);
        let numbers = ExchangeableNames::Targets(few.number(pair.0)?, few.number(pair.1)?);
        let base = few.fitter.judge(&subsample(&few.data)).1;
        let mut found = find_exchange(&few.fitter, &few.data, numbers, &base)?;
        let rows = few.rows(all);
        found.rows = found.rows.into_iter().filter_map(|row| rows.get(row).copied()).collect();
        found.names = ExchangeableNames::Targets(pair.0, pair.1);
        Some(found)
    });
    let best = found.min_by(|a, b| a.error_m.total_cmp(&b.error_m))?;
    let name = |target: usize| data.targets.get(target).cloned().flatten().unwrap_or_else(|| "the tip".to_owned());
    Some(best.diagnosis(data, rows, name))
}

/// Pairs of targets that may be exchanged: all pairs of few targets, otherwise those with the most votes of single rows.
fn pairs(fitter: &Fitter<'_>, all: &Dataset) -> Vec<(usize, usize)> {
    let count = all.targets.len();
    if count * count.saturating_sub(1) / 2 <= PAIRS {
        return (0..count).flat_map(|b| (0..b).map(move |a| (a, b))).collect();
    }
    let mut votes: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for range in starts(all) {
        let part = take_rows(all, &range.map(|row| row as u32).collect::<Vec<_>>());
        let few = FewTargets::new(fitter, &part);
        let (estimate, _) = few.fitter.judge(&subsample(&few.data));
        vote(fitter, all, &few.place_others(fitter, &part, &estimate), &mut votes);
    }
    let mut pairs: Vec<((usize, usize), f64)> = votes.into_iter().collect();
    pairs.sort_by(|a, b| b.1.total_cmp(&a.1));
    pairs.into_iter().take(PAIRS).map(|(pair, _)| pair).collect()
}

/// Votes of the worst rows: for each that fits another target better, the reduction of its squared error.
fn vote(fitter: &Fitter<'_>, all: &Dataset, estimate: &Estimate, votes: &mut BTreeMap<(usize, usize), f64>) {
    let mut seen = Vec::with_capacity(all.len());
    for_links(fitter, all, estimate, |row, link| {
        let position = all.observations[row].measurement.position();
        seen.extend(position.map(|position| (row, link.act(&position))));
    });
    let squared =
        |target: usize, place: &Vector3<f64>| (estimate.base_from_target[target].translation - place).norm_squared();
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
