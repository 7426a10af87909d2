//! Starts of the iteration to all branches of six axes.

use alloc::vec::Vec;
use core::f64::consts::PI;

use super::axis::RevoluteAxis;
use super::general::GeneralArm;
use super::parallel::ParallelAxesArm;
use super::wrist::SphericalWristArm;
use super::{Branches, SAME, largest_difference};
use crate::lie::{Pose, Screw};
use crate::newton::{REACHED, SixJoints, newton, newton_judged};
use crate::trig::wrap_angle;

/// Ratio of the first two steps from a start beyond which there may be other branches around; and distance (rad) to a branch that belongs
/// to another start.
const DOUBTFUL: f64 = 0.25;
const ASTRAY: f64 = 0.6;
/// Number of the six orders of the equations that are used if the number of branches is odd.
const MOST_WAYS: usize = 3;
/// Number of configurations in which the orders are compared.
const SAMPLES: usize = 8;
/// Steps between them: 2π times the fractions of the roots of 2, 3, 5, 7, 11 and 13.
const SPREAD: [f64; 6] = [2.602581, 4.599611, 1.483259, 4.057375, 1.989413, 3.804791];
/// Distance (rad) of a root from a known branch from which on it is taken for another one.
const NEAR: f64 = 1e-4;
/// Largest number of starts.
const MOST_STARTS: usize = 24;
/// Largest number of steps from a start.
pub(super) const MOST_STEPS: u32 = 12;
/// Largest distance (rad, lengths over reach) of an arm from one with branches in closed form.
const FAR: f64 = 0.03;

/// Nearest arm with branches in closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ClosedForm {
    /// Its last three axes meet.
    Wrist(SphericalWristArm),
    /// Its second to fourth axes are parallel.
    Parallel(ParallelAxesArm),
}

/// An order of the arm's own equations: the axis that comes first ([`GeneralArm::FIRST`]), and true if the arm is taken from its tip.
#[derive(Clone, Copy, Debug, PartialEq)]
struct AxisOrder {
    first: usize,
    is_reversed: bool,
}

/// Ranking of the orders, which is expensive to compute: that of an arm serves similar arms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MethodRanking {
    orders: [AxisOrder; MOST_WAYS],
    /// True if the first of them found all branches of the closed form. This fails for an arm that is its own relative, whose equations
    /// have no roots.
    is_whole: bool,
}

/// Precomputation for six revolute axes, independent of poses.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SolutionMethods {
    axes: [RevoluteAxis; 6],
    home: Pose,
    reach_m: f64,
    /// Joint values per reading.
    senses: [f64; 6],
    /// Distance of the nearest relative, the relative, and true if it is taken from the tip.
    closed: Option<(f64, ClosedForm, bool)>,
    ranking: MethodRanking,
    /// Equations that are kept, in the order of the ranking.
    kept: Vec<GeneralArm>,
}

/// Axes from the tip.
fn reversed(axes: &[RevoluteAxis; 6], is_reversed: bool) -> [RevoluteAxis; 6] {
    let mut axes = *axes;
    if is_reversed {
        axes.reverse();
    }
    axes
}

impl SolutionMethods {
    /// Precomputation from screws and the tip with all readings at 0, and joint values per reading.
    pub(super) fn new(
        screws: &[Screw; 6],
        home: &Pose,
        (reach_m, senses): (f64, [f64; 6]),
        ranking: Option<MethodRanking>,
    ) -> Self {
        let axes = screws.map(|screw| RevoluteAxis::from_screw(&screw));
        let mut closed: Option<(f64, ClosedForm, bool)> = None;
        for is_reversed in [false, true] {
            let axes = reversed(&axes, is_reversed);
            let wrist =
                SphericalWristArm::new(&axes, reach_m).map(|(it, apart)| (apart / reach_m, ClosedForm::Wrist(it)));
            let parallel = ParallelAxesArm::new(&axes, reach_m)
                .map(|(it, angle, apart)| (f64::max(angle, apart / reach_m), ClosedForm::Parallel(it)));
            for (off, it) in wrist.into_iter().chain(parallel) {
                if off < FAR && closed.as_ref().is_none_or(|(least, ..)| off < *least) {
                    closed = Some((off, it, is_reversed));
                }
            }
        }
        let first = AxisOrder { first: 0, is_reversed: false };
        let unknown = MethodRanking { orders: [first; MOST_WAYS], is_whole: true };
        let ranking = ranking.unwrap_or(unknown);
        SolutionMethods { axes, home: *home, reach_m, senses, closed, ranking, kept: Vec::new() }
    }

    /// Distance of the arm from one with branches in closed form; infinite if it is far.
    pub(super) fn distance_from_closed_form(&self) -> f64 {
        self.closed.as_ref().map_or(f64::INFINITY, |(off, ..)| *off)
    }

    /// Compares the orders of the equations, for an arm with these axes.
    pub(super) fn rank_methods(&self, arm: &SixJoints<'_>) -> MethodRanking {
        let mut judged: Vec<(MethodScore, AxisOrder)> = Vec::new();
        for is_reversed in [false, true] {
            for first in GeneralArm::FIRST {
                let order = AxisOrder { first, is_reversed };
                let general = self.equations(order);
                let starts = |target: &Pose| self.starts_of_equations(&general, order, target);
                judged.push((MethodScore::from_samples(arm, starts), order));
            }
        }
        judged.sort_by(|(one, _), (other, _)| other.score().total_cmp(&one.score()));
        let closed = MethodScore::from_samples(arm, |target| self.closed_starts(target));
        let order = |at: usize| judged[at].1;
        MethodRanking { orders: [order(0), order(1), order(2)], is_whole: judged[0].0.count >= closed.count }
    }

    /// Keeps the equations of a ranking, so that they are not set up for each pose.
    pub(super) fn keep(&mut self, ranking: MethodRanking) {
        self.ranking = ranking;
        self.kept = ranking.orders.iter().map(|order| self.equations(*order)).collect();
    }

    fn equations(&self, order: AxisOrder) -> GeneralArm {
        GeneralArm::new(&reversed(&self.axes, order.is_reversed), order.first, self.reach_m)
    }

    /// Configurations with the tip of an arm with (nearly) these axes at a pose.
    pub(super) fn branches(&self, arm: &SixJoints<'_>, target: &Pose) -> Branches {
        let mut found = Branches::EMPTY;
        let closed = self.closed_starts(target);
        if closed.count > 0 && !closed.is_touching {
            let doubt = closed.follow(arm, target, &mut found, |_, _| true);
            let is_sure = found.count == closed.count && doubt < DOUBTFUL;
            if is_sure && found.count.is_multiple_of(2) {
                return found;
            }
        }
        for (at, &order) in self.ranking.orders.iter().enumerate() {
            let starts = match self.kept.get(at) {
                Some(general) => self.starts_of_equations(general, order, target),
                None => self.starts_of_equations(&self.equations(order), order, target),
            };
            starts.follow(arm, target, &mut found, is_far_by(NEAR));
            // Without a relative, nothing else would have found a branch that one order misses.
            if found.count.is_multiple_of(2) && (at > 0 || self.closed.is_some()) {
                break;
            }
        }
        if !self.ranking.is_whole {
            closed.follow(arm, target, &mut found, is_far_by(NEAR));
        }
        found
    }

    fn closed_starts(&self, target: &Pose) -> IterationStarts {
        let mut starts = IterationStarts::EMPTY;
        if let Some((_, closed, is_reversed)) = &self.closed {
            let motion = self.motion(target, *is_reversed);
            let push = &mut |q: [f64; 6], is_touching: bool| starts.add(self.readings(q, *is_reversed), is_touching);
            match closed {
                ClosedForm::Wrist(wrist) => wrist.seeds(&motion, push),
                ClosedForm::Parallel(parallel) => parallel.seeds(&motion, push),
            }
        }
        starts
    }

    fn starts_of_equations(&self, general: &GeneralArm, order: AxisOrder, target: &Pose) -> IterationStarts {
        let mut starts = IterationStarts::EMPTY;
        general.seeds(&self.motion(target, order.is_reversed), &mut |q| {
            starts.add(self.readings(q, order.is_reversed), false);
        });
        starts
    }

    /// Motion from the arm at zero to a pose of its tip, for all axes in their order from base or tip.
    fn motion(&self, target: &Pose, is_reversed: bool) -> Pose {
        let motion = *target * self.home.inverse();
        if is_reversed { motion.inverse() } else { motion }
    }

    fn readings(&self, mut q: [f64; 6], is_reversed: bool) -> [f64; 6] {
        if is_reversed {
            q.reverse();
            q = q.map(|it| -it);
        }
        for (it, sense) in q.iter_mut().zip(self.senses) {
            *it = wrap_angle(*it) / sense;
        }
        q
    }
}

/// True if a start is farther than this (rad) from all branches that were found.
fn is_far_by(distance: f64) -> impl Fn(&[f64; 6], &Branches) -> bool {
    move |start, found| !found.as_slice().iter().any(|it| largest_difference(it, start) < distance)
}

/// Starts of the iteration, as readings.
struct IterationStarts {
    values: [[f64; 6]; MOST_STARTS],
    count: usize,
    /// True if two of them meet or almost do.
    is_touching: bool,
}

impl IterationStarts {
    const EMPTY: Self = IterationStarts { values: [[0.0; 6]; MOST_STARTS], count: 0, is_touching: false };

    fn add(&mut self, q: [f64; 6], is_touching: bool) {
        self.is_touching |= is_touching;
        if let Some(next) = self.values.get_mut(self.count) {
            *next = q;
            self.count += 1;
        }
    }

    /// Adds the branches of the starts that `is_asked` selects; returns the largest doubt of one of them ([`newton_judged`]).
    fn follow(
        &self,
        arm: &SixJoints<'_>,
        target: &Pose,
        found: &mut Branches,
        is_asked: impl Fn(&[f64; 6], &Branches) -> bool,
    ) -> f64 {
        let mut doubt = 0.0_f64;
        for start in &self.values[..self.count] {
            if !is_asked(start, found) {
                continue;
            }
            let mut q = *start;
            let (mut left, ratio) = newton_judged(arm, target, &mut q, MOST_STEPS);
            if q.iter().any(|it| it.abs() > PI) {
                q = q.map(wrap_angle);
                if !arm.is_rigid() {
                    // With an error of its gear, a joint changes its value after a whole turn.
                    left = newton(arm, target, &mut q, MOST_STEPS);
                }
            }
            if left < REACHED {
                found.add(&q, SAME);
                doubt = doubt.max(if largest_difference(start, &q) > ASTRAY { 1.0 } else { ratio });
            }
        }
        doubt
    }
}

/// Result of an order in a few configurations of an arm.
#[derive(Clone, Copy)]
struct MethodScore {
    count: usize,
    /// Sum of the doubts.
    doubt: f64,
}

impl MethodScore {
    fn from_samples(arm: &SixJoints<'_>, starts: impl Fn(&Pose) -> IterationStarts) -> Self {
        let mut judged = MethodScore { count: 0, doubt: 0.0 };
        for sample in 1..=SAMPLES {
            // Irrational shares of a turn are spread evenly.
            let spread = |k: usize| wrap_angle(sample as f64 * SPREAD[k]);
            let target = arm.tip(&[0, 1, 2, 3, 4, 5].map(spread));
            let mut found = Branches::EMPTY;
            let doubt = starts(&target).follow(arm, &target, &mut found, |_, _| true);
            judged.count += found.count;
            judged.doubt += doubt.min(1.0);
        }
        judged
    }

    /// Value of an order: roots are nearer to branches if the equations suit the arm's geometry.
    fn score(&self) -> f64 {
        self.count as f64 - self.doubt
    }
}
