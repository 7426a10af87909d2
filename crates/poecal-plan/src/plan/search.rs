//! Choice among the candidates: a greedy start, exchanges until nothing gains, and a search around each configuration.

use nalgebra::DMatrix;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::blocks::ConfigurationRows;
use super::caches::Caches;
use super::state::{CovarianceState, CriterionContext, WorkspaceErrors};
use poecal_model::simulate::random;

/// Information of a greedy choice beside the prior: that of this number of average rows.
const SOFT: f64 = 1.0;
/// Most candidates among which rows are exchanged at a time: the best ones.
const ACTIVE: usize = 500;
/// Rounds with the best candidates searched again, and most passes over the list in each; with few candidates until nothing gains.
const ROUNDS: usize = 2;
const PASSES: usize = 4;
const PASSES_OF_FEW: usize = 20;
/// Number of candidates from which the best ones are searched only once.
const MANY: usize = 4000;
/// Candidates of many from which the greedy list is chosen, and their least number for each of its rows.
const SOME: usize = 2000;
const FEWEST_EACH: usize = 20;
/// Random lists from which exchanges start beside the greedy one, for geometry alone.
const STARTS: usize = 8;
/// Relative gain of the criterion that counts as none.
const NO_GAIN: f64 = 1e-5;

/// Search for rows of candidates in addition to existing rows.
pub(crate) struct PlanSearch<'a> {
    pub(crate) aim: &'a CriterionContext,
    /// Information of existing rows.
    pub(crate) kept: &'a DMatrix<f64>,
    pub(crate) blocks: &'a ConfigurationRows,
    /// True if two candidates may be in one list.
    pub(crate) apart: &'a (dyn Fn(usize, usize) -> bool + Sync),
}

impl PlanSearch<'_> {
    /// Candidates that gain most, one after the other, after those chosen already.
    pub(crate) fn greedy(&self, mut chosen: Vec<usize>, count: usize) -> Vec<usize> {
        let blocks = self.blocks;
        let every = blocks.count().div_ceil(500).max(1);
        let some: Vec<usize> = (0..blocks.count()).step_by(every).collect();
        let average = blocks.gram(some.iter().copied()) / some.len().max(1) as f64;
        let gram = self.kept + average * SOFT + blocks.gram(chosen.iter().copied());
        let Some((mut state, _)) = CovarianceState::new(self.aim, &gram) else { return chosen };
        let mut caches = Caches::new(&state, self.aim, blocks);
        let mut open: Vec<bool> = (0..blocks.count()).map(|at| self.is_open(at, &chosen)).collect();
        while chosen.len() < count {
            let Some((best, _)) = self.best_candidate(&caches, |at| open[at]) else { break };
            chosen.push(best);
            (0..open.len()).for_each(|at| open[at] = open[at] && at != best && (self.apart)(at, best));
            if chosen.len() == count {
                break;
            }
            let Some(change) = state.change(self.aim, blocks.rows_of_configuration(best), blocks.numbers, 1.0) else {
                break;
            };
            state.apply(&change, blocks.numbers);
            caches.apply(self.aim, blocks, &change);
        }
        chosen
    }

    /// The greedy list; with many candidates that of some, since exchanges consider all.
    fn start(&self, count: usize) -> Vec<usize> {
        if self.blocks.count() <= MANY.max(count * FEWEST_EACH) {
            return self.greedy(Vec::new(), count);
        }
        let every = (self.blocks.count() / SOME.max(count * FEWEST_EACH)).max(1);
        let some: Vec<usize> = (0..self.blocks.count()).step_by(every).collect();
        let blocks = self.blocks.select(&some);
        let apart = |a: usize, b: usize| (self.apart)(some[a], some[b]);
        let found = PlanSearch { blocks: &blocks, apart: &apart, ..*self }.greedy(Vec::new(), count);
        found.into_iter().map(|at| some[at]).collect()
    }

    /// The best list of `count`: from the greedy one, and for geometry alone among few candidates, which takes little time, from random ones too.
    pub(crate) fn list(&self, count: usize, seed: u64) -> Vec<usize> {
        let all = || 0..self.blocks.count();
        if count >= self.blocks.count() && all().all(|a| all().all(|b| a == b || (self.apart)(a, b))) {
            return all().collect();
        }
        let mut best = self.exchange(self.start(count), 0);
        if self.aim.weights.corrected > 0.0 || self.blocks.count() > MANY {
            return best;
        }
        let value = |list: &[usize]| self.squares(list).map_or(f64::INFINITY, |it| it.value(&self.aim.weights));
        let mut least = value(&best);
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(3);
        let mut order: Vec<usize> = (0..self.blocks.count()).collect();
        for _ in 0..STARTS {
            random::shuffle(&mut generator, &mut order);
            let mut start: Vec<usize> = Vec::new();
            for &at in &order {
                if start.len() < count && self.is_open(at, &start) {
                    start.push(at);
                }
            }
            let found = self.exchange(start, 0);
            let own = value(&found);
            if found.len() == count && own < least {
                (best, least) = (found, own);
            }
        }
        best
    }

    fn is_open(&self, at: usize, chosen: &[usize]) -> bool {
        chosen.iter().all(|&other| at != other && (self.apart)(at, other))
    }

    /// The candidate that gains most.
    fn best_candidate(&self, caches: &Caches, is_open: impl Fn(usize) -> bool) -> Option<(usize, f64)> {
        let weights = &self.aim.weights;
        let gains = (0..caches.count()).filter(|&at| is_open(at)).map(|at| (at, caches.gain(at, weights)));
        gains.fold(None, |best, (at, gain)| match best {
            Some((_, most)) if gain <= most => best,
            _ => Some((at, gain)),
        })
    }

    /// Exchanges rows of the list, except its first `fixed` ones, for candidates until nothing gains.
    pub(crate) fn exchange(&self, mut chosen: Vec<usize>, fixed: usize) -> Vec<usize> {
        let rounds = if self.blocks.count() > MANY { 1 } else { ROUNDS };
        for _ in 0..rounds {
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

    /// The candidates with the largest gain beside the list, in their order, with those of the list.
    fn active(&self, chosen: &[usize]) -> Vec<usize> {
        let count = self.blocks.count();
        if count <= ACTIVE {
            return (0..count).collect();
        }
        let gram = self.kept + self.blocks.gram(chosen.iter().copied());
        let Some((state, _)) = CovarianceState::new(self.aim, &gram) else { return chosen.to_vec() };
        let caches = Caches::new(&state, self.aim, self.blocks);
        let mut ranked: Vec<(f64, usize)> = (0..count).map(|at| (caches.gain(at, &self.aim.weights), at)).collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let best = ranked.iter().take(ACTIVE).map(|it| it.1);
        let mut active: Vec<usize> = best.chain(chosen.iter().copied()).collect();
        active.sort_unstable();
        active.dedup();
        active
    }

    fn exchange_among(&self, mut chosen: Vec<usize>, fixed: usize, active: &[usize]) -> Vec<usize> {
        let (aim, m) = (self.aim, self.blocks.numbers);
        let blocks = &self.blocks.select(active);
        let place = |index: usize| active.binary_search(&index).ok();
        let is_few = active.len() == self.blocks.count();
        for _ in 0..if is_few { PASSES_OF_FEW } else { PASSES } {
            let gram = self.kept + self.blocks.gram(chosen.iter().copied());
            let Some((mut state, before)) = CovarianceState::new(aim, &gram) else { break };
            let mut caches = Caches::new(&state, aim, blocks);
            let before = before.value(&aim.weights);
            let unchanged = chosen.clone();
            for position in fixed..chosen.len() {
                let own = chosen[position];
                let Some(without) = state.change(aim, self.blocks.rows_of_configuration(own), m, -1.0) else {
                    continue;
                };
                state.apply(&without, m);
                caches.apply(aim, blocks, &without);
                chosen.swap_remove(position);
                let others = &chosen;
                let open = |at: usize| self.is_open(active[at], others);
                let best = self.best_candidate(&caches, open).map(|(at, gain)| (active[at], gain));
                let kept = place(own).map_or(0.0, |at| caches.gain(at, &aim.weights));
                let next = match best {
                    Some((at, gain)) if gain > kept + NO_GAIN * before.abs() => at,
                    _ => own,
                };
                // The last row took the index of the removed one.
                chosen.push(next);
                let last = chosen.len() - 1;
                chosen.swap(position, last);
                let Some(with) = state.change(aim, self.blocks.rows_of_configuration(next), m, 1.0) else {
                    return unchanged;
                };
                state.apply(&with, m);
                caches.apply(aim, blocks, &with);
            }
            let Some(after) = self.squares(&chosen).map(|it| it.value(&aim.weights)) else {
                return unchanged;
            };
            // Rounding caused a wrong exchange.
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
    pub(crate) fn squares(&self, chosen: &[usize]) -> Option<WorkspaceErrors> {
        let gram = self.kept + self.blocks.gram(chosen.iter().copied());
        CovarianceState::new(self.aim, &gram).map(|(_, squares)| squares)
    }
}

/// Replaces rows of a list by others nearby, round after round. For each row `near` proposes rows; the best is taken if it gains. `rows` are replaced
/// together with their configurations, by `take(row, proposal)`, unless it refuses.
pub(crate) fn improve_nearby(
    aim: &CriterionContext,
    kept: &DMatrix<f64>,
    rows: &mut ConfigurationRows,
    proposals: &ConfigurationRows,
    owners: &[usize],
    mut take: impl FnMut(usize, usize) -> bool,
) {
    let m = rows.numbers;
    let size = m * rows.columns;
    let gram = kept + rows.gram(0..rows.count());
    let Some((mut state, value)) = CovarianceState::new(aim, &gram) else { return };
    let least = NO_GAIN * value.value(&aim.weights).abs() / rows.count().max(1) as f64;
    for row in 0..rows.count() {
        let own: Vec<usize> = (0..owners.len()).filter(|&at| owners[at] == row).collect();
        if own.is_empty() {
            continue;
        }
        let Some(without) = state.change(aim, rows.rows_of_configuration(row), m, -1.0) else { continue };
        state.apply(&without, m);
        let mut candidates = proposals.select(&own);
        candidates.values.extend_from_slice(rows.rows_of_configuration(row));
        let caches = Caches::new(&state, aim, &candidates);
        let kept = caches.gain(own.len(), &aim.weights);
        let best =
            (0..own.len()).map(|at| (at, caches.gain(at, &aim.weights))).fold(None, |best, (at, gain)| match best {
                Some((_, most)) if gain <= most => best,
                _ => Some((at, gain)),
            });
        if let Some((at, gain)) = best
            && gain > kept + least
            && take(row, own[at])
        {
            rows.values[row * size..(row + 1) * size].copy_from_slice(candidates.rows_of_configuration(at));
        }
        let Some(with) = state.change(aim, rows.rows_of_configuration(row), m, 1.0) else { return };
        state.apply(&with, m);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::PlannedFit;
    use crate::plan::experiment::PlannedExperiment;
    use crate::plan::state::CriterionWeights;
    use poecal_model::simulate::{elbow, random_configuration};

    fn setup(fit: &PlannedFit) -> (PlannedExperiment, CriterionContext, ConfigurationRows, Vec<f64>) {
        let experiment = PlannedExperiment::new(&elbow(), fit).unwrap();
        let mut generator = ChaCha8Rng::seed_from_u64(5);
        let readings: Vec<f64> = (0..120).flat_map(|_| random_configuration(&elbow(), &mut generator)).collect();
        let moments = experiment.moments(&readings);
        let weights = CriterionWeights { calibrated: 1.0, corrected: 2.0, determinant: 1e-9 };
        let aim = CriterionContext::new(&experiment.prior, moments, weights, experiment.share());
        let blocks = experiment.blocks(&readings).unwrap();
        (experiment, aim, blocks, readings)
    }

    /// The low-rank updates compared with new inverses: gains of all candidates, after added and removed rows.
    #[test]
    fn gains_are_differences_of_the_criterion() {
        for kind in [poecal_model::simulate::SessionKind::POINT, poecal_model::simulate::SessionKind::POSE] {
            let fit = PlannedFit::default();
            let session = poecal_fit::analysis::PlannedSession { kind, ..fit.session };
            let (_, aim, blocks, _) = setup(&PlannedFit { session, ..fit });
            let m = blocks.numbers;
            let gram = blocks.gram(0..30);
            let (mut state, _) = CovarianceState::new(&aim, &gram).unwrap();
            let mut caches = Caches::new(&state, &aim, &blocks);
            for (row, sign) in [(40, 1.0), (3, -1.0), (41, 1.0), (40, -1.0)] {
                let change = state.change(&aim, blocks.rows_of_configuration(row), m, sign).unwrap();
                state.apply(&change, m);
                caches.apply(&aim, &blocks, &change);
            }
            let now: Vec<usize> = (0..30).filter(|&row| row != 3).chain([41]).collect();
            let value = |rows: &[usize]| {
                CovarianceState::new(&aim, &blocks.gram(rows.iter().copied())).unwrap().1.value(&aim.weights)
            };
            let before = value(&now);
            let mut worst: f64 = 0.0;
            for candidate in 50..70 {
                let mut more = now.clone();
                more.push(candidate);
                let exact = before - value(&more);
                worst = worst.max((caches.gain(candidate, &aim.weights) - exact).abs() / exact.abs());
            }
            println!("{kind:?}: gains after four changes differ by {worst:.1e} of themselves");
            // Rounding of inverses with a condition of about 1e8.
            assert!(worst < 1e-5, "{worst}");
        }
    }

    /// For points, the mean information of rows equals the moments of the targets' motion in units of the noise.
    #[test]
    fn rows_and_moments_are_of_the_same_motions() {
        let (experiment, aim, blocks, _) = setup(&PlannedFit::default());
        let sigma = experiment.noise()[poecal_model::measurement::Quantity::Position];
        let mean = blocks.gram(0..blocks.count()) * (sigma * sigma / blocks.count() as f64);
        let worst = (&mean - &aim.moments).amax() / aim.moments.amax();
        println!("information and moments differ by {worst:.1e}");
        assert!(worst < 1e-9);
    }

    /// An exchange never makes a list worse, and 24 planned rows beat the best of 200 random lists.
    #[test]
    fn planned_lists_are_better_than_random_ones() {
        let (_, aim, blocks, _) = setup(&PlannedFit::default());
        let kept = DMatrix::zeros(blocks.columns, blocks.columns);
        let search = PlanSearch { aim: &aim, kept: &kept, blocks: &blocks, apart: &|_, _| true };
        let value = |rows: &[usize]| search.squares(rows).unwrap().value(&aim.weights);
        let greedy = search.greedy(Vec::new(), 24);
        let found = search.exchange(greedy.clone(), 0);
        let mut generator = ChaCha8Rng::seed_from_u64(6);
        let mut order: Vec<usize> = (0..blocks.count()).collect();
        let best = (0..200)
            .map(|_| {
                random::shuffle(&mut generator, &mut order);
                value(&order[..24])
            })
            .fold(f64::INFINITY, f64::min);
        println!("greedy {:.3e}, exchanged {:.3e}, best of 200 random {best:.3e}", value(&greedy), value(&found));
        assert!(value(&found) <= value(&greedy) && value(&found) < best);
        let mut rows = found.clone();
        rows.sort_unstable();
        rows.dedup();
        assert_eq!(rows.len(), 24);
    }

    /// Twenty rows of 120 compared with a lower bound for any twenty rows: the best share of rows for each candidate, whole or not, with the bound of
    /// convexity from there.
    #[test]
    fn twenty_rows_are_near_the_bound_by_approximate_design() {
        const ROWS: usize = 20;
        for kind in [poecal_model::simulate::SessionKind::POINT, poecal_model::simulate::SessionKind::POSE] {
            let fit = PlannedFit::default();
            let session = poecal_fit::analysis::PlannedSession { kind, ..fit.session };
            let corrections = poecal_model::robot::Corrections::Off;
            let fit = PlannedFit {
                session,
                corrections,
                robot_error: Some(crate::plan::RobotError { calibrated_m: 0.0, corrected_m: None }),
                ..fit
            };
            let (experiment, mut aim, blocks, _) = setup(&fit);
            aim.weights = CriterionWeights { calibrated: 1.0, corrected: 0.0, determinant: 0.0 };
            let count = blocks.count();
            let each: Vec<DMatrix<f64>> = (0..count).map(|at| blocks.gram([at])).collect();
            let mut shares = vec![1.0 / count as f64; count];
            let (mut value, mut bound) = (0.0, 0.0);
            for _ in 0..400 {
                let mut h = experiment.prior.clone();
                for (share, own) in shares.iter().zip(&each) {
                    h += own * (*share * ROWS as f64);
                }
                let inverse = crate::plan::experiment::inverse(&h).unwrap();
                let pull = &inverse * &aim.moments * &inverse;
                value = (&aim.moments * &inverse).trace();
                let gains: Vec<f64> = each.iter().map(|own| ROWS as f64 * own.dot(&pull)).collect();
                let mean: f64 = shares.iter().zip(&gains).map(|(a, b)| a * b).sum();
                bound = value - gains.iter().copied().fold(0.0, f64::max) + mean;
                shares.iter_mut().zip(&gains).for_each(|(share, gain)| *share *= gain.sqrt());
                let sum: f64 = shares.iter().sum();
                shares.iter_mut().for_each(|share| *share /= sum);
            }
            let kept = DMatrix::zeros(blocks.columns, blocks.columns);
            let search = PlanSearch { aim: &aim, kept: &kept, blocks: &blocks, apart: &|_, _| true };
            let found = search.list(ROWS, 1);
            let own = search.squares(&found).unwrap().noise;
            let [own, value, bound] = [own, value, bound].map(|it: f64| 1e3 * it.sqrt());
            println!("{kind:?}: {own:.4} mm of {ROWS} rows, {value:.4} mm of shares, bound {bound:.4} mm");
            // Rows are whole and each of the 120 is used once; the gain by moving them to better positions nearby is left out.
            assert!(own <= 1.05 * bound, "{own} {bound}");
        }
    }

    /// The determinant of a planned list compared with the best that exchanges find from random lists.
    #[test]
    fn the_determinant_is_that_of_the_best_of_many_starts() {
        let fit = PlannedFit {
            corrections: poecal_model::robot::Corrections::Off,
            robot_error: Some(crate::plan::RobotError { calibrated_m: 0.0, corrected_m: None }),
            ..PlannedFit::default()
        };
        let (experiment, mut aim, blocks, _) = setup(&fit);
        aim.weights = CriterionWeights { calibrated: 0.0, corrected: 0.0, determinant: 1.0 };
        let kept = DMatrix::zeros(blocks.columns, blocks.columns);
        let search = PlanSearch { aim: &aim, kept: &kept, blocks: &blocks, apart: &|_, _| true };
        let determinant = |rows: &[usize]| search.squares(rows).unwrap().determinant;
        let own = determinant(&search.list(20, 1));
        let mut generator = ChaCha8Rng::seed_from_u64(8);
        let mut order: Vec<usize> = (0..blocks.count()).collect();
        let starts = 60;
        let best = (0..starts)
            .map(|_| {
                random::shuffle(&mut generator, &mut order);
                determinant(&search.exchange(order[..20].to_vec(), 0))
            })
            .fold(f64::NEG_INFINITY, f64::max);
        let efficiency = ((own - best) / experiment.geometry() as f64).exp();
        println!("efficiency {efficiency:.4} against the best of {starts} random starts");
        assert!(efficiency >= 0.98);
    }
}
