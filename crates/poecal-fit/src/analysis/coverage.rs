//! Sampled share of each joint's range.

use serde::{Deserialize, Serialize};

use crate::state::{PackedValues, Session};
use poecal_model::robot::{JointKind, JointLimits, Robot};
use poecal_numerics::threads;

/// Rows of one work item.
const CHUNK: usize = 8192;

/// Sampled and allowed values of a joint (radians; metres of a prismatic joint).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct JointCoverage {
    /// The joint.
    pub joint: String,
    /// Smallest value sampled.
    pub sampled_min: f64,
    /// Largest value sampled.
    pub sampled_max: f64,
    /// Share of the sampled range, at its ends, that at most a fiftieth of the rows reach. A gap of more than 15 % of the range separates
    /// it from the rest. It does not count as sampled.
    #[serde(default)]
    pub isolated_share: f64,
    /// Smallest allowed value; null without limits, or with placeholders.
    pub limit_min: Option<f64>,
    /// Largest allowed value.
    pub limit_max: Option<f64>,
}

impl JointCoverage {
    /// Coverage of a compliant joint, which has no range.
    pub fn of_give(name: &str) -> Self {
        let joint = name.to_owned();
        let (limit_min, limit_max) = (None, None);
        JointCoverage { joint, sampled_min: 0.0, sampled_max: 0.0, isolated_share: 0.0, limit_min, limit_max }
    }

    /// Sampled share of the allowed range, 0 to 1 (theory.md §9, *Verdict*). A revolute joint is allowed at most one turn, also without
    /// limits: whole turns change no geometry. `None` for a prismatic joint without limits.
    #[must_use]
    pub fn share(&self, kind: JointKind) -> Option<f64> {
        let turn = std::f64::consts::TAU;
        let limits = self.limit_min.zip(self.limit_max).map(|(least, most)| most - least);
        let allowed = match kind {
            JointKind::Revolute => limits.map_or(turn, |span| span.min(turn)),
            JointKind::Prismatic => limits?,
        };
        let sampled = (self.sampled_max - self.sampled_min) * (1.0 - self.isolated_share);
        (allowed > 0.0).then(|| (sampled / allowed).min(1.0))
    }

    /// True if [`Self::share`] is of one turn, since the limits span more.
    #[must_use]
    pub fn is_of_a_turn(&self, kind: JointKind) -> bool {
        let span = self.limit_min.zip(self.limit_max).map(|(least, most)| most - least);
        kind == JointKind::Revolute && span.is_some_and(|span| span > JointLimits::TURN_RAD)
    }

    /// True if a value is in the sampled range; for a revolute joint also after whole turns.
    #[must_use]
    pub fn contains(&self, kind: JointKind, value: f64) -> bool {
        // Readings are rounded: smaller differences do not count.
        const ROUNDING: f64 = 1e-6;
        let (least, most) = (self.sampled_min - ROUNDING, self.sampled_max + ROUNDING);
        match kind {
            JointKind::Prismatic => (least..=most).contains(&value),
            JointKind::Revolute => {
                let turn = std::f64::consts::TAU;
                value - turn * ((value - least) / turn).floor() <= most
            }
        }
    }
}

/// Coverage of each joint's range by some rows, from base to tip; empty without rows.
#[must_use]
pub fn coverage(session: &Session<'_>, rows: &[u32]) -> Vec<JointCoverage> {
    let ranges = ranges(session, rows);
    let joints = &session.robot.joints;
    joints
        .iter()
        .zip(ranges)
        .filter(|(_, (least, most))| least <= most)
        .enumerate()
        .map(|(index, (joint, sampled))| {
            let limits = joint.limits.filter(|limits| {
                joint.kind == JointKind::Revolute || limits.upper - limits.lower < JointLimits::PLACEHOLDER_M
            });
            let turns_on = joint.kind == JointKind::Revolute
                && limits.is_none_or(|it| it.upper - it.lower > std::f64::consts::TAU);
            let (sampled_min, sampled_max) =
                if turns_on { on_circle(session.packed, rows, index, sampled) } else { sampled };
            JointCoverage {
                joint: joint.name.clone(),
                sampled_min,
                sampled_max,
                isolated_share: isolated_share(session.packed, rows, index),
                limit_min: limits.map(|limits| limits.lower),
                limit_max: limits.map(|limits| limits.upper),
            }
        })
        .collect()
}

/// Parts of a turn by which values on a circle are distinguished.
const PARTS: usize = 3600;
/// Gap on the circle (rad) from which it counts: smaller ones are those of random samples.
const GAP_ON_CIRCLE: f64 = std::f64::consts::FRAC_PI_2;

/// Smallest and largest value of a joint that turns without end, where 350° and 10° are 20° apart. A gap on the circle counts if it exceeds a
/// right angle and the rest of a turn outside the values. The range then begins behind it.
fn on_circle(packed: &PackedValues, rows: &[u32], joint: usize, (least, most): (f64, f64)) -> (f64, f64) {
    use std::f64::consts::TAU;
    let outside = (TAU - (most - least)).max(0.0);
    if outside > TAU / 2.0 {
        return (least, most);
    }
    let part = TAU / PARTS as f64;
    let place = |value: f64| ((value / part).floor().rem_euclid(PARTS as f64) as usize).min(PARTS - 1);
    // The smallest and largest value in each part, within one turn.
    let mut found: Vec<Option<(f64, f64)>> = vec![None; PARTS];
    for &row in rows {
        let value = packed.joint_values(row as usize)[joint];
        let value = value - TAU * (value / TAU).floor();
        let it = &mut found[place(value)];
        *it = Some(it.map_or((value, value), |(low, high)| (low.min(value), high.max(value))));
    }
    let all: Vec<(f64, f64)> = found.into_iter().flatten().collect();
    let (Some(first), Some(last)) = (all.first(), all.last()) else { return (least, most) };
    // From the end of the gap, around the circle, to its beginning.
    let mut widest = (first.0 + TAU - last.1, first.0, last.1);
    for pair in all.windows(2) {
        let gap = pair[1].0 - pair[0].1;
        if gap > widest.0 {
            widest = (gap, pair[1].0, pair[0].1 + TAU);
        }
    }
    let (gap, from, to) = widest;
    if gap < GAP_ON_CIRCLE || gap < outside + part {
        return (least, most);
    }
    // On the turn that is nearest to 0.
    let turns = (0.5 * (from + to) / TAU).round() * TAU;
    (from - turns, to - turns)
}

/// Share of a joint's sampled range that only isolated values reach: at each end at most a fiftieth of the rows, beyond a gap.
fn isolated_share(packed: &PackedValues, rows: &[u32], joint: usize) -> f64 {
    const FEW: usize = 50;
    const GAP: f64 = 0.15;
    let mut values: Vec<f64> = rows.iter().map(|&row| packed.joint_values(row as usize)[joint]).collect();
    let few = values.len() / FEW;
    if few == 0 {
        return 0.0;
    }
    // Only the ends have to be sorted, with one more value at each.
    values.select_nth_unstable_by(few, f64::total_cmp);
    values[..=few].sort_unstable_by(f64::total_cmp);
    let last = values.len() - 1 - few;
    values[few..].select_nth_unstable_by(last - few, f64::total_cmp);
    values[last..].sort_unstable_by(f64::total_cmp);
    let (least, most) = (values[0], values[values.len() - 1]);
    let span = most - least;
    if span <= 0.0 {
        return 0.0;
    }
    let is_gap = |pair: &&[f64]| pair[1] - pair[0] > GAP * span;
    let low = values[..=few].windows(2).rfind(is_gap).map_or(least, |pair| pair[1]);
    let high = values[last..].windows(2).find(is_gap).map_or(most, |pair| pair[0]);
    1.0 - (high - low).max(0.0) / span
}

/// Smallest and largest value of each joint in some rows.
pub fn ranges(session: &Session<'_>, rows: &[u32]) -> Vec<(f64, f64)> {
    let none = vec![(f64::INFINITY, f64::NEG_INFINITY); session.robot.joints.len()];
    let parts = threads::map_chunks(rows, CHUNK, |_, rows| {
        let mut ranges = none.clone();
        for &row in rows {
            for (range, &value) in ranges.iter_mut().zip(session.packed.joint_values(row as usize)) {
                *range = (range.0.min(value), range.1.max(value));
            }
        }
        ranges
    });
    parts
        .into_iter()
        .fold(none, |whole, part| whole.into_iter().zip(part).map(|(a, b)| (a.0.min(b.0), a.1.max(b.1))).collect())
}

/// True if the joint values of some readings are all within the sampled ranges.
pub fn is_within_ranges(robot: &Robot, coverage: &[JointCoverage], readings: &[f64]) -> bool {
    let indices = robot.reading_indices();
    robot
        .joints
        .iter()
        .zip(&indices)
        .zip(coverage)
        .all(|((joint, &index), coverage)| coverage.contains(joint.kind, joint.reading.value(readings[index])))
}

/// A robot whose joints are limited to the range that all of these coverages sampled. If there is no such range, the range of the first coverage
/// holds. A joint that one of them does not have keeps its limits.
pub fn within_sampled(robot: &Robot, coverages: &[&[JointCoverage]]) -> Robot {
    let mut robot = robot.clone();
    for joint in &mut robot.joints {
        let own = coverages.iter().map(|of| of.iter().find(|it| it.joint == joint.name));
        let own: Option<Vec<&JointCoverage>> = own.collect();
        let Some((first, others)) = own.as_deref().and_then(<[_]>::split_first) else { continue };
        let one = (first.sampled_min, first.sampled_max);
        let both = others.iter().fold(one, |(min, max), it| (min.max(it.sampled_min), max.min(it.sampled_max)));
        let (lower, upper) = if both.0 <= both.1 { both } else { one };
        if lower <= upper {
            joint.limits = Some(JointLimits { lower, upper });
        }
    }
    robot
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_that_moved_half_its_range_is_sampled_by_half() {
        let mut half = JointCoverage {
            sampled_max: 1.5,
            limit_min: Some(-1.5),
            limit_max: Some(1.5),
            ..JointCoverage::of_give("elbow")
        };
        assert_eq!(half.share(JointKind::Revolute), Some(0.5));
        // Without limits a joint turns once; a slide has no range.
        (half.limit_min, half.limit_max) = (None, None);
        assert_eq!(half.share(JointKind::Revolute), Some(1.5 / std::f64::consts::TAU));
        assert_eq!(half.share(JointKind::Prismatic), None);
    }
}
