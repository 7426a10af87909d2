//! Pairs of equal static intervals of two streams, each with a clock of its own.

use super::{FEWEST_PAIRS, RowPair, UnpairedRows};
use poecal_numerics::distributions::median;

/// Largest difference between the begins of two static intervals that are the same, seconds.
const NEAR_S: f64 = 0.3;
/// Distance of two lags that are different, seconds.
const APART_S: f64 = 0.6;
/// Largest number of lags that are compared by the nominal robot.
const MOST: usize = 80;
/// Least share of the pairs of the best lag that another lag has.
const SHARE: f64 = 0.4;

/// Begin and end of a static interval, seconds; both are equal for a point.
pub type TimeInterval = (f64, f64);

/// Pairs of static intervals at a lag.
#[derive(Clone, Debug, PartialEq)]
pub struct LaggedPairs {
    /// Time of the measurements less that of the joint readings, seconds.
    pub lag_s: f64,
    /// Pairs.
    pub pairs: Vec<RowPair>,
    /// Median error of the nominal robot, metres.
    pub missed_m: f64,
}

impl UnpairedRows<'_> {
    /// Pairs at the lags at which most static intervals coincide, the one with the smallest error first. With a stated lag (and its largest error,
    /// seconds), only lags near it count.
    #[must_use]
    pub fn find_lags(
        &self,
        joints: &[TimeInterval],
        shots: &[TimeInterval],
        stated: Option<(f64, f64)>,
    ) -> Vec<LaggedPairs> {
        let is_allowed = |lag: f64| stated.is_none_or(|(middle, off)| (lag - middle).abs() <= off + NEAR_S);
        let differences = joints.iter().flat_map(|joint| {
            shots.iter().map(move |shot| {
                // A point lies somewhere in its static interval.
                if shot.0 < shot.1 { shot.0 - joint.0 } else { shot.0 - 0.5 * (joint.0 + joint.1) }
            })
        });
        let mut counted: Vec<(usize, f64)> = differences
            .filter(|lag| is_allowed(*lag))
            .map(|lag| (pair_intervals(joints, shots, lag).len(), lag))
            .filter(|it| it.0 >= FEWEST_PAIRS)
            .collect();
        counted.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.total_cmp(&b.1)));
        let most = counted.first().map_or(0, |it| it.0);
        let mut found: Vec<LaggedPairs> = Vec::new();
        for (count, lag) in counted {
            if found.len() >= MOST || (count as f64) < SHARE * most as f64 {
                break;
            }
            let refined = refine_lag(joints, shots, lag);
            if found.iter().any(|it| (it.lag_s - refined).abs() < APART_S) || !is_allowed(refined) {
                continue;
            }
            let pairs = pair_intervals(joints, shots, refined);
            if pairs.len() < FEWEST_PAIRS {
                continue;
            }
            let Some(missed_m) = self.median_error(&pairs) else { continue };
            found.push(LaggedPairs { lag_s: refined, pairs, missed_m });
        }
        found.sort_by(|a, b| a.missed_m.total_cmp(&b.missed_m));
        found
    }
}

/// A lag, refined by the median difference between the begins of its pairs.
fn refine_lag(joints: &[TimeInterval], shots: &[TimeInterval], lag: f64) -> f64 {
    let pairs = pair_intervals(joints, shots, lag);
    let of = |&(joint, shot): &RowPair| {
        let (joint, shot): (&TimeInterval, &TimeInterval) = (joints.get(joint)?, shots.get(shot)?);
        let middle = |it: &TimeInterval| 0.5 * (it.0 + it.1);
        Some(middle(shot) - middle(joint))
    };
    median(pairs.iter().filter_map(of)).unwrap_or(lag)
}

/// Static intervals at the same time, each once: those that begin together, or that overlap if one was interrupted; points in their
/// interval.
fn pair_intervals(joints: &[TimeInterval], shots: &[TimeInterval], lag: f64) -> Vec<RowPair> {
    let mut pairs = Vec::new();
    let mut first = 0;
    for (at, shot) in shots.iter().enumerate() {
        let (from, to) = (shot.0 - lag, shot.1 - lag);
        let is_point = from == to;
        while joints.get(first).is_some_and(|it| it.1 < from) {
            first += 1;
        }
        let Some(joint) = joints.get(first) else { break };
        let overlap = to.min(joint.1) - from.max(joint.0);
        let shorter = (to - from).min(joint.1 - joint.0);
        let is_same = if is_point {
            (joint.0..=joint.1).contains(&from)
        } else {
            overlap > 0.6 * shorter && ((from - joint.0).abs() < NEAR_S || (to - joint.1).abs() < NEAR_S)
        };
        if is_same && (is_point || pairs.last().is_none_or(|it: &RowPair| it.0 != first)) {
            pairs.push((first, at));
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stands_at_the_same_time_are_paired() {
        let joints: Vec<TimeInterval> = [(0.0, 1.0), (2.0, 2.6), (4.0, 5.0), (6.0, 6.5)].to_vec();
        let shots: Vec<TimeInterval> = joints.iter().map(|it| (it.0 + 12.34, it.1 + 12.34)).collect();
        assert_eq!(pair_intervals(&joints, &shots, 12.34), [(0, 0), (1, 1), (2, 2), (3, 3)]);
        assert!((refine_lag(&joints, &shots, 12.4) - 12.34).abs() < 1e-9);
        // One was lost, and one was interrupted.
        assert_eq!(pair_intervals(&joints, &shots[1..], 12.34), [(1, 0), (2, 1), (3, 2)]);
        let points: Vec<TimeInterval> = joints.iter().map(|it| (it.0 + 0.3, it.0 + 0.3)).collect();
        assert_eq!(pair_intervals(&joints, &points, 0.0).len(), 4);
    }
}
