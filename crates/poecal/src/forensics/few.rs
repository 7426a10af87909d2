//! Sessions of many targets: what is fitted sees a few of them, and the others are placed by what those say.

use std::borrow::Cow;

use nalgebra::{Matrix3, Vector3};

use super::change::push;
use super::session::{SAMPLE, Session};
use crate::estimate::{Chain, Estimate, Linkage};
use crate::lie::Pose;
use crate::measurement::{Dataset, Observation};
use crate::start::mean_rotation;

/// Targets up to which all are fitted together: each adds unknowns, and a sample has few rows of each of many.
pub(super) const TARGETS: usize = 12;
/// Targets that are fitted together at most, where fewer have too few rows for a sample.
const MOST_TARGETS: usize = 24;

/// The rows of a few targets, which are numbered anew.
pub(super) struct Few<'a, 'd> {
    pub(super) session: Cow<'d, Session<'a>>,
    pub(super) data: Cow<'d, Dataset>,
    /// The targets by their numbers in all data; none if they are all.
    kept: Option<Vec<usize>>,
}

impl<'a, 'd> Few<'a, 'd> {
    /// The targets with the most rows, or all if they are few.
    pub(super) fn of(session: &'d Session<'a>, all: &'d Dataset) -> Self {
        if all.targets.len() <= TARGETS {
            return Few { session: Cow::Borrowed(session), data: Cow::Borrowed(all), kept: None };
        }
        Few::with(session, all, &[])
    }

    /// These targets, and others with the most rows.
    pub(super) fn with(session: &'d Session<'a>, all: &'d Dataset, these: &[usize]) -> Self {
        let mut counts = vec![0_usize; all.targets.len()];
        all.observations.iter().for_each(|row| counts[row.target] += 1);
        let mut kept: Vec<usize> = (0..counts.len()).collect();
        kept.sort_by_key(|target| (!these.contains(target), std::cmp::Reverse(counts[*target])));
        let mut rows = 0;
        let enough = kept.iter().take_while(|&&target| {
            let was_too_few = rows < SAMPLE;
            rows += counts[target];
            was_too_few
        });
        let enough = enough.count().clamp(TARGETS, MOST_TARGETS);
        kept.truncate(enough);
        kept.sort_unstable();
        let mut start = session.start.clone();
        start.base_from_target = kept.iter().map(|&target| session.start.base_from_target[target]).collect();
        let session = Cow::Owned(Session { start, ..session.clone() });
        let data = Cow::Owned(reduced(all, &kept).0);
        Few { session, data, kept: Some(kept) }
    }

    /// The same targets' rows of data that were changed.
    pub(super) fn among(&self, changed: Dataset) -> Dataset {
        match &self.kept {
            Some(kept) => reduced(&changed, kept).0,
            None => changed,
        }
    }

    /// The number that a target has among these.
    pub(super) fn number(&self, target: usize) -> Option<usize> {
        match &self.kept {
            Some(kept) => kept.binary_search(&target).ok(),
            None => Some(target),
        }
    }

    /// The rows of all data that are among these, in their order.
    pub(super) fn rows(&self, all: &Dataset) -> Vec<usize> {
        match &self.kept {
            Some(kept) => reduced(all, kept).1,
            None => (0..all.len()).collect(),
        }
    }

    /// An estimate of these targets with all others where their rows see them on average (theory.md §6 (32)).
    pub(super) fn placed(&self, session: &Session<'_>, all: &Dataset, found: &Estimate) -> Estimate {
        let Some(kept) = &self.kept else { return found.clone() };
        let mut estimate = session.start.clone();
        estimate.base_from_axis.clone_from(&found.base_from_axis);
        estimate.joint_offset.clone_from(&found.joint_offset);
        estimate.device_from_base = found.device_from_base;
        place(session, all, &mut estimate);
        for (&target, pose) in kept.iter().zip(&found.base_from_target) {
            estimate.base_from_target[target] = *pose;
        }
        estimate
    }
}

/// Rows of these targets, numbered in their order, and which rows they are.
fn reduced(all: &Dataset, kept: &[usize]) -> (Dataset, Vec<usize>) {
    let mut numbers = vec![None; all.targets.len()];
    kept.iter().enumerate().for_each(|(number, &target)| numbers[target] = Some(number));
    let mut few = Dataset::new(all.reading_names().to_vec());
    few.targets = kept.iter().filter_map(|&target| all.targets.get(target).cloned()).collect();
    let mut rows = Vec::new();
    for (row, seen) in all.observations.iter().enumerate() {
        if let Some(target) = numbers.get(seen.target).copied().flatten() {
            push(&mut few, all.readings(row), Observation { target, ..*seen });
            rows.push(row);
        }
    }
    (few, rows)
}

/// Puts each target where its rows see it on average.
fn place(session: &Session<'_>, all: &Dataset, estimate: &mut Estimate) {
    let mut places = vec![(0_usize, Vector3::zeros()); estimate.base_from_target.len()];
    let mut turns: Vec<Vec<Matrix3<f64>>> = vec![Vec::new(); places.len()];
    for_links(session, all, estimate, |row, link| {
        let (target, seen) = (all.observations[row].target, &all.observations[row].measurement);
        let model = seen.residual_model();
        let (count, sum) = &mut places[target];
        *count += 1;
        *sum += link.act(&model.position());
        turns[target].extend(model.orientation().map(|turned| link.rotation * turned));
    });
    for (target, ((count, sum), turned)) in places.into_iter().zip(turns).enumerate() {
        let pose = &mut estimate.base_from_target[target];
        if count > 0 {
            pose.translation = sum / count as f64;
        }
        if !turned.is_empty() {
            pose.rotation = mean_rotation(turned.into_iter());
        }
    }
}

/// Gives for each row what brings a measurement to where the target was at zero joint values, in the base frame.
pub(super) fn for_links(
    session: &Session<'_>,
    all: &Dataset,
    estimate: &Estimate,
    mut each: impl FnMut(usize, &Pose),
) {
    let packed = session.packed(all);
    let linkage = Linkage::new(estimate);
    let mut chain = Chain::default();
    for (row, seen) in all.observations.iter().enumerate() {
        chain.evaluate(&linkage, &packed, row, seen);
        let home = estimate.base_from_target[seen.target];
        each(row, &(home * chain.target.inverse()));
    }
}
