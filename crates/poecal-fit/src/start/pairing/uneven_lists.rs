//! Pairing of lists of unequal length: some measurements were lost, others were taken twice.

use super::{EVIDENT, RowPair, UnpairedRows};
use crate::state::Estimate;
use poecal_numerics::distributions::median;

/// Configurations of a window, and steps between two windows.
const WINDOW: usize = 9;
const STEP: usize = 4;
/// Rows beyond the difference of the lengths by which a window may be shifted.
const BEYOND: usize = 6;
/// Largest error of a pair in units of the usual one; and the cost of a row without partner, or of one that is taken twice, in squares of
/// it.
const MOST: f64 = 6.0;
const GAP: f64 = 25.0;
/// Rounds of registration and alignment.
const ROUNDS: usize = 12;
/// Largest product of the numbers of rows that are aligned.
const MOST_CELLS: usize = 4_000_000;
/// Largest number of windows that are registered, and fewest positions of them in the measurements: lists whose lengths differ by more have
/// no order.
const MOST_WINDOWS: usize = 2400;
const FEWEST_PLACES: usize = 6;

/// Pairs of lists of unequal length; rows from 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AlignedPairs {
    /// Pairs, in order.
    pub pairs: Vec<RowPair>,
    /// Rows of joint readings without a measurement.
    pub unmeasured: Vec<usize>,
    /// Rows of joint readings with more than one measurement.
    pub repeated: Vec<usize>,
    /// Configurations without readings, or that fit none.
    pub unread: Vec<usize>,
    /// Configurations that fit two neighbouring rows of readings equally well, and are left out.
    pub unclear: Vec<usize>,
    /// Median error of the pairs, metres.
    pub missed_m: f64,
}

/// Last step of the best path to a cell.
#[derive(Clone, Copy, PartialEq)]
enum AlignmentStep {
    Pair,
    Again,
    SkipJoints,
    SkipShot,
}

impl UnpairedRows<'_> {
    /// Pairs in the order of both lists, by the errors of the registered nominal robot: of the best window first, then of all pairs. The
    /// alignment is by dynamic programming.
    #[must_use]
    pub fn align_lists(&self) -> Option<AlignedPairs> {
        let (joints, shots) = (self.joint_rows(), self.shots.len());
        if joints.saturating_mul(shots) > MOST_CELLS {
            return None;
        }
        let band = joints.abs_diff(shots) + BEYOND;
        let (mut estimate, mut usual) = self.best_window(band)?;
        let mut pairs: Vec<RowPair> = Vec::new();
        for _ in 0..ROUNDS {
            let costs = Costs::from_rows(self, &estimate, band);
            let (found, missed) = costs.cheapest(usual, (joints, shots))?;
            let next = self.register_pairs(&found)?;
            let same = found == pairs;
            (pairs, estimate) = (found, next.0);
            usual = missed.max(next.1);
            if same {
                break;
            }
        }
        let costs = Costs::from_rows(self, &estimate, band);
        let is_clear = |&(joint, shot): &RowPair| {
            let own = costs.error_at(joint, shot);
            let neighbours = [joint.checked_sub(1), Some(joint + 1)].into_iter().flatten();
            neighbours.filter(|it| *it < joints).all(|it| costs.error_at(it, shot) > EVIDENT * own)
        };
        let (clear, unclear): (Vec<RowPair>, Vec<RowPair>) = pairs.iter().partition(|it| is_clear(it));
        let used = |row: usize| pairs.iter().filter(|it| it.0 == row).count();
        Some(AlignedPairs {
            unmeasured: (0..joints).filter(|row| used(*row) == 0).collect(),
            repeated: (0..joints).filter(|row| used(*row) > 1).collect(),
            unread: (0..shots).filter(|shot| pairs.iter().all(|it| it.1 != *shot)).collect(),
            unclear: unclear.into_iter().map(|it| it.1).collect(),
            missed_m: usual,
            pairs: clear,
        })
    }

    /// Registration of the window that fits best.
    fn best_window(&self, band: usize) -> Option<(Estimate, f64)> {
        let (joints, shots) = (self.joint_rows(), self.shots.len());
        let size = WINDOW.min(joints).min(shots);
        let starts: Vec<usize> = (0..=shots.saturating_sub(size)).step_by(STEP).collect();
        let each = (2 * band + 1).min(joints.saturating_sub(size) + 1);
        let most = MOST_WINDOWS / each;
        if most < FEWEST_PLACES.min(starts.len()) {
            return None;
        }
        let mut best: Option<(Estimate, f64)> = None;
        for start in starts.iter().copied().step_by(starts.len().div_ceil(most)) {
            for first in start.saturating_sub(band)..=(start + band).min(joints.saturating_sub(size)) {
                let pairs: Vec<RowPair> = (0..size).map(|k| (first + k, start + k)).collect();
                let Some(found) = self.register_pairs(&pairs) else { continue };
                if best.as_ref().is_none_or(|it| found.1 < it.1) {
                    best = Some(found);
                }
            }
        }
        best
    }
}

/// Errors of all pairs near the diagonal.
struct Costs {
    band: usize,
    width: usize,
    errors: Vec<f64>,
}

impl Costs {
    fn from_rows(rows: &UnpairedRows<'_>, estimate: &Estimate, band: usize) -> Self {
        let (joints, shots) = (rows.joint_rows(), rows.shots.len());
        let width = 2 * band + 1;
        let mut pairs = Vec::new();
        let mut places = Vec::new();
        for shot in 0..shots {
            for at in 0..width {
                if let Some(joint) = (shot + at).checked_sub(band).filter(|it| *it < joints) {
                    pairs.push((joint, shot));
                    places.push(shot * width + at);
                }
            }
        }
        let mut errors = vec![f64::INFINITY; shots * width];
        for (place, error) in places.into_iter().zip(rows.errors_of(&pairs, estimate)) {
            if let Some(cell) = errors.get_mut(place) {
                *cell = error;
            }
        }
        Costs { band, width, errors }
    }

    /// Error of a pair, metres; infinite far from the diagonal.
    fn error_at(&self, joint: usize, shot: usize) -> f64 {
        let at = (joint + self.band).checked_sub(shot).filter(|it| *it < self.width);
        at.and_then(|at| self.errors.get(shot * self.width + at)).copied().unwrap_or(f64::INFINITY)
    }

    /// The cheapest pairs in the order of both lists, and their median error.
    fn cheapest(&self, usual: f64, (joints, shots): (usize, usize)) -> Option<(Vec<RowPair>, f64)> {
        let scale = usual.max(1e-6);
        let pair = |joint: usize, shot: usize| {
            let ratio = self.error_at(joint, shot) / scale;
            if ratio <= MOST { ratio * ratio } else { f64::INFINITY }
        };
        let columns = shots + 1;
        let cell = |joint: usize, shot: usize| joint * columns + shot;
        let mut costs = vec![f64::INFINITY; (joints + 1) * columns];
        let mut steps = vec![AlignmentStep::SkipJoints; (joints + 1) * columns];
        costs[0] = 0.0;
        for joint in 0..=joints {
            for shot in 0..=shots {
                let mut best = (costs[cell(joint, shot)], steps[cell(joint, shot)]);
                let mut consider = |cost: f64, step: AlignmentStep| {
                    if cost < best.0 {
                        best = (cost, step);
                    }
                };
                if joint > 0 {
                    consider(costs[cell(joint - 1, shot)] + GAP, AlignmentStep::SkipJoints);
                }
                if shot > 0 {
                    consider(costs[cell(joint, shot - 1)] + GAP, AlignmentStep::SkipShot);
                }
                if joint > 0 && shot > 0 {
                    let own = pair(joint - 1, shot - 1);
                    consider(costs[cell(joint - 1, shot - 1)] + own, AlignmentStep::Pair);
                    // This is the row of the pair before.
                    if matches!(steps[cell(joint, shot - 1)], AlignmentStep::Pair | AlignmentStep::Again) {
                        consider(costs[cell(joint, shot - 1)] + GAP * 0.5 + own, AlignmentStep::Again);
                    }
                }
                (costs[cell(joint, shot)], steps[cell(joint, shot)]) = best;
            }
        }
        let pairs = trace_pairs(&steps, (joints, shots));
        let missed = median(pairs.iter().map(|it| self.error_at(it.0, it.1)))?;
        Some((pairs, missed))
    }
}

/// Pairs along the cheapest alignment, from its last cell to the first.
fn trace_pairs(steps: &[AlignmentStep], (joints, shots): (usize, usize)) -> Vec<RowPair> {
    let (mut joint, mut shot, mut pairs) = (joints, shots, Vec::new());
    while joint > 0 || shot > 0 {
        match steps[joint * (shots + 1) + shot] {
            AlignmentStep::Pair if joint > 0 && shot > 0 => {
                pairs.push((joint - 1, shot - 1));
                (joint, shot) = (joint - 1, shot - 1);
            }
            AlignmentStep::Again if joint > 0 && shot > 0 => {
                pairs.push((joint - 1, shot - 1));
                shot -= 1;
            }
            AlignmentStep::SkipJoints if joint > 0 => joint -= 1,
            AlignmentStep::SkipShot if shot > 0 => shot -= 1,
            AlignmentStep::Pair | AlignmentStep::Again | AlignmentStep::SkipJoints | AlignmentStep::SkipShot => {
                if joint > 0 { joint -= 1 } else { shot -= 1 }
            }
        }
    }
    pairs.reverse();
    pairs
}
