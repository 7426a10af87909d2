//! Data with many targets: a few are fitted, and the others placed by their rows.

use std::borrow::Cow;

use nalgebra::{Matrix3, Vector3};

use super::change::push;
use super::fitter::{Fitter, SAMPLE};
use crate::start::mean_rotation;
use crate::state::{Estimate, Linkage, RowChain};
use poecal_arm::lie::Pose;
use poecal_model::measurement::{Dataset, Observation};

/// Largest number of targets that are all fitted together: each adds unknowns, and a subsample has few rows of each.
const TARGETS: usize = 12;
/// Largest number of targets that are fitted together where fewer have too few rows for a subsample.
const MOST_TARGETS: usize = 24;

/// The rows of a few targets, renumbered.
pub(crate) struct FewTargets<'a, 'd> {
    pub(crate) fitter: Cow<'d, Fitter<'a>>,
    pub(crate) data: Cow<'d, Dataset>,
    /// Numbers of these targets among all; `None` if they are all.
    kept: Option<Vec<usize>>,
}

impl<'a, 'd> FewTargets<'a, 'd> {
    /// True if all targets are fitted together.
    pub(crate) fn are_all(data: &Dataset) -> bool {
        data.targets.len() <= TARGETS
    }

    /// The targets with the most rows; all of them if they are few.
    pub(crate) fn new(fitter: &'d Fitter<'a>, all: &'d Dataset) -> Self {
        if FewTargets::are_all(all) {
            return FewTargets { fitter: Cow::Borrowed(fitter), data: Cow::Borrowed(all), kept: None };
        }
        FewTargets::with_targets(fitter, all, &[])
    }

    /// These targets, and others with the most rows.
    pub(crate) fn with_targets(fitter: &'d Fitter<'a>, all: &'d Dataset, these: &[usize]) -> Self {
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
        let mut start = fitter.start.clone();
        start.base_from_target = kept.iter().map(|&target| fitter.start.base_from_target[target]).collect();
        let fitter = Cow::Owned(Fitter { start, ..fitter.clone() });
        let data = Cow::Owned(reduce_targets(all, &kept).0);
        FewTargets { fitter, data, kept: Some(kept) }
    }

    /// The same rows, fitted with a weak prior.
    pub(crate) fn with_weak_prior(&self) -> FewTargets<'a, '_> {
        let fitter = Cow::Owned(self.fitter.with_weak_prior());
        FewTargets { fitter, data: Cow::Borrowed(&*self.data), kept: self.kept.clone() }
    }

    /// The rows of these targets in changed data.
    pub(crate) fn select_rows(&self, changed: Dataset) -> Dataset {
        match &self.kept {
            Some(kept) => reduce_targets(&changed, kept).0,
            None => changed,
        }
    }

    /// The new number of a target.
    pub(crate) fn number(&self, target: usize) -> Option<usize> {
        match &self.kept {
            Some(kept) => kept.binary_search(&target).ok(),
            None => Some(target),
        }
    }

    /// The rows of these targets among all data.
    pub(crate) fn rows(&self, all: &Dataset) -> Vec<usize> {
        match &self.kept {
            Some(kept) => reduce_targets(all, kept).1,
            None => (0..all.len()).collect(),
        }
    }

    /// An estimate of these targets, with all others at the mean position of their rows (theory.md §6 (32)).
    pub(crate) fn place_others(&self, fitter: &Fitter<'_>, all: &Dataset, found: &Estimate) -> Estimate {
        let Some(kept) = &self.kept else { return found.clone() };
        let mut estimate = fitter.start.clone();
        estimate.base_from_axis.clone_from(&found.base_from_axis);
        estimate.terms.clone_from(&found.terms);
        estimate.device_from_base = found.device_from_base;
        place(fitter, all, &mut estimate);
        for (&target, pose) in kept.iter().zip(&found.base_from_target) {
            estimate.base_from_target[target] = *pose;
        }
        estimate
    }
}

/// The rows of these targets, renumbered, and their indices in all data.
fn reduce_targets(all: &Dataset, kept: &[usize]) -> (Dataset, Vec<usize>) {
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

/// Moves each target to the mean position of its rows.
fn place(fitter: &Fitter<'_>, all: &Dataset, estimate: &mut Estimate) {
    let mut places = vec![(0_usize, Vector3::zeros()); estimate.base_from_target.len()];
    let mut turns: Vec<Vec<Matrix3<f64>>> = vec![Vec::new(); places.len()];
    for_links(fitter, all, estimate, |row, link| {
        let (target, seen) = (all.observations[row].target, &all.observations[row].measurement);
        let model = seen;
        if let Some(position) = model.position() {
            let (count, sum) = &mut places[target];
            *count += 1;
            *sum += link.act(&position);
        }
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

/// Calls `each` with the transformation of every row from measurement to the target at zero joint values, in the base frame.
pub(crate) fn for_links(fitter: &Fitter<'_>, all: &Dataset, estimate: &Estimate, mut each: impl FnMut(usize, &Pose)) {
    let packed = fitter.pack_values(all);
    let linkage = Linkage::new(estimate);
    let mut chain = RowChain::default();
    for (row, seen) in all.observations.iter().enumerate() {
        chain.evaluate(&linkage, &packed, row, seen);
        let home = estimate.base_from_target[seen.target];
        each(row, &(home * chain.target.inverse()));
    }
}
