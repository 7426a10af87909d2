//! Which of the candidates: a greedy start, exchanges until nothing gains, and a search around each configuration.

use nalgebra::DMatrix;

use super::experiment::Blocks;
use super::state::{Aim, Caches, Squares, State};

/// Information that a greedy choice begins with beside the prior: that of so many average rows.
const SOFT: f64 = 1.0;
/// Most candidates among which rows are exchanged at a time: the best ones.
const ACTIVE: usize = 1200;
/// Rounds with the best candidates found anew, and most passes over the list in each.
const ROUNDS: usize = 3;
const PASSES: usize = 12;
/// Share of the criterion below which a gain is none.
const NO_GAIN: f64 = 1e-5;

/// What is sought: rows of candidates beside those that are there already.
pub(super) struct Search<'a> {
    pub(super) aim: &'a Aim,
    /// Information of rows that are there in any case.
    pub(super) kept: &'a DMatrix<f64>,
    pub(super) blocks: &'a Blocks,
    /// Whether two candidates may be in one list.
    pub(super) apart: &'a (dyn Fn(usize, usize) -> bool + Sync),
}

impl Search<'_> {
    /// Candidates that gain most, one after the other, behind those chosen already.
    pub(super) fn greedy(&self, mut chosen: Vec<usize>, count: usize) -> Vec<usize> {
        let blocks = self.blocks;
        let every = blocks.count().div_ceil(500).max(1);
        let some: Vec<usize> = (0..blocks.count()).step_by(every).collect();
        let average = blocks.gram(some.iter().copied()) / some.len().max(1) as f64;
        let gram = self.kept + average * SOFT + blocks.gram(chosen.iter().copied());
        let Some((mut state, _)) = State::new(self.aim, &gram) else { return chosen };
        let mut caches = Caches::new(&state, self.aim, blocks);
        let mut open: Vec<bool> = (0..blocks.count()).map(|at| self.is_open(at, &chosen)).collect();
        while chosen.len() < count {
            let Some((best, _)) = self.best(&caches, |at| open[at]) else { break };
            chosen.push(best);
            (0..open.len()).for_each(|at| open[at] = open[at] && at != best && (self.apart)(at, best));
            if chosen.len() == count {
                break;
            }
            let Some(change) = state.change(self.aim, blocks.of(best), blocks.numbers, 1.0) else { break };
            state.apply(&change, blocks.numbers);
            caches.apply(self.aim, blocks, &change);
        }
        chosen
    }

    fn is_open(&self, at: usize, chosen: &[usize]) -> bool {
        chosen.iter().all(|&other| at != other && (self.apart)(at, other))
    }

    /// The candidate that gains most.
    fn best(&self, caches: &Caches, is_open: impl Fn(usize) -> bool) -> Option<(usize, f64)> {
        let weights = &self.aim.weights;
        let gains = (0..caches.count()).filter(|&at| is_open(at)).map(|at| (at, caches.gain(at, weights)));
        gains.fold(None, |best, (at, gain)| match best {
            Some((_, most)) if gain <= most => best,
            _ => Some((at, gain)),
        })
    }

    /// Exchanges rows of the list, but not its first `fixed` ones, for candidates until nothing gains.
    pub(super) fn exchange(&self, mut chosen: Vec<usize>, fixed: usize) -> Vec<usize> {
        for _ in 0..ROUNDS {
            let before = self.squares(&chosen);
            let active = self.active(&chosen);
            chosen = self.exchange_among(chosen, fixed, &active);
            let (Some(before), Some(after)) = (before, self.squares(&chosen)) else { break };
            let weights = &self.aim.weights;
            let (before, after) = (before.value(weights), after.value(weights));
            if active.len() == self.blocks.count() || before - after <= NO_GAIN * before.abs() {
                break;
            }
        }
        chosen
    }

    /// The candidates that would gain most beside the list, in their order, with those of the list.
    fn active(&self, chosen: &[usize]) -> Vec<usize> {
        let count = self.blocks.count();
        if count <= ACTIVE {
            return (0..count).collect();
        }
        let gram = self.kept + self.blocks.gram(chosen.iter().copied());
        let Some((state, _)) = State::new(self.aim, &gram) else { return chosen.to_vec() };
        let caches = Caches::new(&state, self.aim, self.blocks);
        let mut ranked: Vec<(f64, usize)> =
            (0..count).map(|at| (caches.gain(at, &self.aim.weights), at)).collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let best = ranked.iter().take(ACTIVE).map(|it| it.1);
        let mut active: Vec<usize> = best.chain(chosen.iter().copied()).collect();
        active.sort_unstable();
        active.dedup();
        active
    }

    fn exchange_among(&self, mut chosen: Vec<usize>, fixed: usize, active: &[usize]) -> Vec<usize> {
        let (aim, m) = (self.aim, self.blocks.numbers);
        let blocks = &self.blocks.only(active);
        let place = |index: usize| active.binary_search(&index).ok();
        for _ in 0..PASSES {
            let gram = self.kept + self.blocks.gram(chosen.iter().copied());
            let Some((mut state, before)) = State::new(aim, &gram) else { break };
            let mut caches = Caches::new(&state, aim, blocks);
            let before = before.value(&aim.weights);
            let unchanged = chosen.clone();
            for position in fixed..chosen.len() {
                let own = chosen[position];
                let Some(without) = state.change(aim, self.blocks.of(own), m, -1.0) else { continue };
                state.apply(&without, m);
                caches.apply(aim, blocks, &without);
                chosen.swap_remove(position);
                let others = &chosen;
                let open = |at: usize| self.is_open(active[at], others);
                let best = self.best(&caches, open).map(|(at, gain)| (active[at], gain));
                let kept = place(own).map_or(0.0, |at| caches.gain(at, &aim.weights));
                let next = match best {
                    Some((at, gain)) if gain > kept + NO_GAIN * before.abs() => at,
                    _ => own,
                };
                // The last row took its place.
                chosen.push(next);
                let last = chosen.len() - 1;
                chosen.swap(position, last);
                let Some(with) = state.change(aim, self.blocks.of(next), m, 1.0) else { return unchanged };
                state.apply(&with, m);
                caches.apply(aim, blocks, &with);
            }
            let Some(after) = self.squares(&chosen).map(|it| it.value(&aim.weights)) else {
                return unchanged;
            };
            // Rounding misled.
            if after > before {
                return unchanged;
            }
            if before - after <= NO_GAIN * before.abs() {
                break;
            }
        }
        chosen
    }

    /// Expected squared errors with rows of these candidates.
    pub(super) fn squares(&self, chosen: &[usize]) -> Option<Squares> {
        let gram = self.kept + self.blocks.gram(chosen.iter().copied());
        State::new(self.aim, &gram).map(|(_, squares)| squares)
    }
}

/// Replaces rows of a list by others nearby, round after round: of each row `near` proposes rows, of which the best is taken if it gains.
/// `rows` are replaced together with what they are rows of, by `take(row, proposal)`, unless it refuses.
pub(super) fn around(
    aim: &Aim,
    kept: &DMatrix<f64>,
    rows: &mut Blocks,
    proposals: &Blocks,
    owners: &[usize],
    mut take: impl FnMut(usize, usize) -> bool,
) {
    let m = rows.numbers;
    let size = m * rows.columns;
    let gram = kept + rows.gram(0..rows.count());
    let Some((mut state, value)) = State::new(aim, &gram) else { return };
    let least = NO_GAIN * value.value(&aim.weights).abs() / rows.count().max(1) as f64;
    for row in 0..rows.count() {
        let own: Vec<usize> = (0..owners.len()).filter(|&at| owners[at] == row).collect();
        if own.is_empty() {
            continue;
        }
        let Some(without) = state.change(aim, rows.of(row), m, -1.0) else { continue };
        state.apply(&without, m);
        let mut candidates = proposals.only(&own);
        candidates.values.extend_from_slice(rows.of(row));
        let caches = Caches::new(&state, aim, &candidates);
        let kept = caches.gain(own.len(), &aim.weights);
        let best =
            (0..own.len()).map(|at| (at, caches.gain(at, &aim.weights))).fold(None, |best, (at, gain)| {
                match best {
                    Some((_, most)) if gain <= most => best,
                    _ => Some((at, gain)),
                }
            });
        if let Some((at, gain)) = best
            && gain > kept + least
            && take(row, own[at])
        {
            rows.values[row * size..(row + 1) * size].copy_from_slice(candidates.of(at));
        }
        let Some(with) = state.change(aim, rows.of(row), m, 1.0) else { return };
        state.apply(&with, m);
    }
}
