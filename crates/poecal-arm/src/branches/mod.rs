//! All configurations of an arm of six axes that have its tip at a pose.

mod axis;
mod general;
mod parallel;
mod roots;
mod wrist;

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};

use axis::Axis;
use general::General;
use parallel::Parallel;
use wrist::Wrist;

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

use crate::arm::Arm;
use crate::lie::{Pose, Screw};
use crate::newton::{REACHED, newton, newton_judged};
use crate::trig::wrapped;

/// Least distance of two starts where two branches meet, rad.
const APART: f64 = 0.06;
/// Imaginary part of a pair of solutions up to which a real pair of the arm itself may be near, rad.
const BEYOND: f64 = 0.8;
/// Ratio of the first two steps from a start beyond which there may be other branches around, and way (rad) to a branch that is another's.
const DOUBTFUL: f64 = 0.25;
const ASTRAY: f64 = 0.6;
/// Difference of all joints (rad) below which two configurations are one.
const SAME: f64 = 1e-7;
/// Most branches of an arm of six axes (primrose1986).
pub const MOST_BRANCHES: usize = 16;
/// So many of the six ways to set up the equations are asked where the number of branches is odd.
const MOST_WAYS: usize = 3;
/// Configurations in which the ways are compared.
const SAMPLES: usize = 48;
/// Steps between them: 2π times the fractions of the roots of 2, 3, 5, 7, 11 and 13.
const SPREAD: [f64; 6] = [2.602581, 4.599611, 1.483259, 4.057375, 1.989413, 3.804791];
/// Distance (rad) of a root from a branch that was found from which it is taken for another one.
const NEAR: f64 = 1e-4;
/// Most starts of a way.
const MOST_STARTS: usize = 24;
/// Most steps from a start.
const MOST_STEPS: u32 = 12;
/// How far (rad, lengths over reach) an arm may be from one with closed branches.
const FAR: f64 = 0.03;

/// Configurations that have the tip at a pose, joint values (rad) in (-π, π]: those of [`AllBranches::at`].
///
/// ```
/// use nalgebra::Vector3;
/// use poecal_arm::{AllBranches, Arm, lie::{Pose, Screw}};
/// let axes = [Vector3::z(), Vector3::y(), Vector3::y(), Vector3::x(), Vector3::y(), Vector3::x()];
/// let points = [0.0, 0.0, 0.4, 0.4, 0.8, 0.8].map(|z| Vector3::new(0.0, 0.0, z));
/// let screws: Vec<Screw> = axes.iter().zip(&points).map(|(axis, point)| Screw::revolute(axis, point)).collect();
/// let arm = Arm::new(&screws, &Pose::from_translation(Vector3::new(0.1, 0.0, 0.8))).unwrap();
/// let far = Pose::from_translation(Vector3::new(9.0, 0.0, 0.0));
/// assert!(AllBranches::new(&arm).unwrap().at(&far).as_slice().is_empty());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branches {
    values: [[f64; 6]; MOST_BRANCHES],
    count: usize,
}

impl Branches {
    const EMPTY: Self = Branches { values: [[0.0; 6]; MOST_BRANCHES], count: 0 };

    /// The configurations.
    #[must_use]
    pub fn as_slice(&self) -> &[[f64; 6]] {
        &self.values[..self.count]
    }

    /// Adds a configuration; whether it is new.
    fn add(&mut self, q: &[f64; 6]) -> bool {
        if self.count == MOST_BRANCHES || self.as_slice().iter().any(|other| apart(q, other) < SAME) {
            return false;
        }
        self.values[self.count] = *q;
        self.count += 1;
        true
    }
}

/// Whether a start is farther than this (rad) from all branches that were found.
fn is_far_by(distance: f64) -> impl Fn(&[f64; 6], &Branches) -> bool {
    move |start, found| !found.as_slice().iter().any(|it| apart(it, start) < distance)
}

/// The largest difference of a joint, rad.
fn apart(one: &[f64; 6], other: &[f64; 6]) -> f64 {
    one.iter().zip(other).map(|(a, b)| wrapped(a - b).abs()).fold(0.0, f64::max)
}

/// A way to starts of the iteration.
#[derive(Clone, Debug, PartialEq)]
enum Way {
    /// The nearest arm whose last three axes meet.
    Wrist(Wrist),
    /// The nearest arm whose second to fourth axes are parallel.
    Parallel(Parallel),
    /// The arm itself.
    General(Box<General>),
}

/// A way that sees the arm's axes in their order, or from the tip.
#[derive(Clone, Debug, PartialEq)]
struct Seen {
    way: Way,
    is_reversed: bool,
}

/// All branches of one arm of six revolute joints: those of the nearest arm that has them in closed form (its last or first three axes meet,
/// or its second to fourth, or third to fifth, are parallel), each followed by Newton's iteration of the arm itself. Where two of them meet or
/// almost do, where one leads far or nowhere, and for arms that are far from such ones, the starts are the roots of the arm's own equations
/// (raghavan1993). These can be set up in six ways; the first is the one whose roots are nearest to the branches in a few configurations, and
/// another one is asked where the number of branches is odd, as they come in pairs.
///
/// ```
/// use nalgebra::Vector3;
/// use poecal_arm::{AllBranches, Arm, lie::{Pose, Screw}};
/// let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
/// let at = |x: f64, z: f64| Vector3::new(x, 0.0, z);
/// let axes = [(z, at(0.0, 0.0)), (y, at(0.1, 0.4)), (y, at(0.1, 0.9)), (x, at(0.0, 1.0)), (y, at(0.6, 1.0)), (x, at(0.0, 1.001))];
/// let screws = axes.map(|(direction, point)| Screw::revolute(&direction, &point));
/// let arm = Arm::new(&screws, &Pose::from_translation(at(0.7, 1.0))).unwrap();
/// let target = arm.forward_kinematics(&[0.3, 0.2, -0.4, 0.5, 0.6, 0.7]);
/// let branches = AllBranches::new(&arm).unwrap().at(&target);
/// assert_eq!(branches.as_slice().len(), 4);
/// for q in branches.as_slice() {
///     assert!((arm.forward_kinematics(q).translation - target.translation).norm() < 1e-10);
/// }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct AllBranches {
    arm: Arm,
    /// The nearest arm with closed branches, if one is near.
    closed: Option<Seen>,
    /// The ways to set up the arm's own equations, the best first.
    general: Vec<Seen>,
    /// Whether the best of these found what the closed form found: not of an arm that is its own relative, whose equations have no roots.
    is_general_whole: bool,
}

impl AllBranches {
    /// What is computed once for an arm; `None` of an arm that has not six revolute joints, each with a reading of its own.
    #[must_use]
    pub fn new(arm: &Arm) -> Option<Self> {
        let screws: &[_; 6] = arm.screws().try_into().ok()?;
        if screws.iter().any(Screw::is_prismatic) || arm.senses().is_none() {
            return None;
        }
        let axes: [Axis; 6] = screws.map(|screw| Axis::of(&screw));
        let mut reversed = axes;
        reversed.reverse();
        let reach = arm.reach_m();
        let mut nearest: Option<(f64, Seen)> = None;
        let mut general = Vec::new();
        for (axes, is_reversed) in [(axes, false), (reversed, true)] {
            let wrist = Wrist::new(&axes).map(|(it, apart)| (apart / reach, Way::Wrist(it)));
            let parallel = Parallel::new(&axes)
                .map(|(it, angle, apart)| (f64::max(angle, apart / reach), Way::Parallel(it)));
            for (off, way) in wrist.into_iter().chain(parallel) {
                if off < FAR && nearest.as_ref().is_none_or(|(least, _)| off < *least) {
                    nearest = Some((off, Seen { way, is_reversed }));
                }
            }
            for first in General::FIRST {
                let way = Way::General(Box::new(General::new(&axes, first, reach)));
                general.push(Seen { way, is_reversed });
            }
        }
        let closed = nearest.map(|(_, way)| way);
        let mut judged: Vec<(Judged, Seen)> =
            general.into_iter().map(|way| (judged(arm, &way), way)).collect();
        judged.sort_by(|(one, _), (other, _)| other.worth().total_cmp(&one.worth()));
        let count = |judged: Option<Judged>| judged.map_or(0, |it| it.count);
        let is_general_whole =
            count(judged.first().map(|it| it.0)) >= count(closed.as_ref().map(|it| self::judged(arm, it)));
        let general = judged.into_iter().map(|(_, way)| way).collect();
        Some(AllBranches { arm: arm.clone(), closed, general, is_general_whole })
    }

    /// The configurations that have the tip at a pose of the base.
    #[must_use]
    pub fn at(&self, target: &Pose) -> Branches {
        let mut found = Branches::EMPTY;
        let closed = self.closed.as_ref().map_or(Starts::EMPTY, |way| way.starts(&self.arm, target));
        if closed.count > 0 && !closed.is_touching {
            let doubt = closed.follow(&self.arm, target, &mut found, |_, _| true);
            let is_sure = found.count == closed.count && doubt < DOUBTFUL;
            if is_sure && found.count.is_multiple_of(2) {
                return found;
            }
        }
        for way in self.general.iter().take(MOST_WAYS) {
            way.starts(&self.arm, target).follow(&self.arm, target, &mut found, is_far_by(NEAR));
            if found.count.is_multiple_of(2) {
                break;
            }
        }
        if !self.is_general_whole {
            closed.follow(&self.arm, target, &mut found, is_far_by(ASTRAY));
        }
        found
    }

    /// The configurations within the arm's limits ([`Arm::limits`]) that have the tip at a pose: of each branch that one whose joints are nearest
    /// to `near`, turned by whole turns where that keeps limits; sorted by the joint that has to move most.
    ///
    /// ```
    /// use nalgebra::Vector3;
    /// use poecal_arm::{AllBranches, Arm, lie::{Pose, Screw}};
    /// let axes = [Vector3::z(), Vector3::y(), Vector3::y(), Vector3::x(), Vector3::y(), Vector3::x()];
    /// let points = [0.0, 0.0, 0.4, 0.4, 0.8, 0.8].map(|z| Vector3::new(0.0, 0.0, z));
    /// let screws: Vec<Screw> = axes.iter().zip(&points).map(|(axis, point)| Screw::revolute(axis, point)).collect();
    /// let arm = Arm::new(&screws, &Pose::from_translation(Vector3::new(0.1, 0.0, 0.8))).unwrap();
    /// let q = [0.3, -0.3, 0.9, 0.1, 0.6, 6.2];
    /// let found = AllBranches::new(&arm).unwrap().within_limits(&arm.forward_kinematics(&q), &q);
    /// assert!((found.as_slice()[0][5] - 6.2).abs() < 1e-9);
    /// ```
    #[must_use]
    pub fn within_limits(&self, target: &Pose, near: &[f64; 6]) -> Branches {
        let mut found = Branches::EMPTY;
        'branch: for branch in self.at(target).as_slice() {
            let mut q = *branch;
            for ((q, near), &(low, high)) in q.iter_mut().zip(near).zip(self.arm.limits()) {
                let turns = ((near - *q) / TAU).round();
                let turned = *q + turns * TAU;
                // Limits that are met but for rounding are met.
                let least = ((low - SAME - turned) / TAU).ceil();
                let most = ((high + SAME - turned) / TAU).floor();
                if least > most {
                    continue 'branch;
                }
                *q = turned + TAU * 0.0_f64.clamp(least, most);
            }
            if !self.arm.is_rigid() {
                newton(&self.arm, target, &mut q, MOST_STEPS);
            }
            found.values[found.count] = q;
            found.count += 1;
        }
        let far = |q: &[f64; 6]| q.iter().zip(near).map(|(q, near)| (q - near).abs()).fold(0.0, f64::max);
        found.values[..found.count].sort_unstable_by(|one, other| far(one).total_cmp(&far(other)));
        found
    }

    /// As [`Arm::nearest`]; where its iteration does not reach the pose, the branch of which the joint that has to move most moves least.
    ///
    /// ```
    /// use nalgebra::Vector3;
    /// use poecal_arm::{AllBranches, Arm, lie::{Pose, Screw}};
    /// let axes = [Vector3::z(), Vector3::y(), Vector3::y(), Vector3::x(), Vector3::y(), Vector3::x()];
    /// let points = [0.0, 0.0, 0.4, 0.4, 0.8, 0.8].map(|z| Vector3::new(0.0, 0.0, z));
    /// let screws: Vec<Screw> = axes.iter().zip(&points).map(|(axis, point)| Screw::revolute(axis, point)).collect();
    /// let arm = Arm::new(&screws, &Pose::from_translation(Vector3::new(0.1, 0.0, 0.8))).unwrap();
    /// let target = arm.forward_kinematics(&[3.2, -0.3, 0.9, 0.1, 0.6, 0.0]);
    /// let mut q = [3.0, -0.4, 1.0, 0.0, 0.5, 0.2];
    /// assert!(AllBranches::new(&arm).unwrap().nearest(&target, &mut q) < 1e-12);
    /// assert!((q[0] - 3.2).abs() < 1e-9);
    /// ```
    pub fn nearest(&self, target: &Pose, q: &mut [f64; 6]) -> f64 {
        let mut near = *q;
        let left = self.arm.nearest(target, &mut near);
        if left < REACHED {
            *q = near;
            return left;
        }
        let found = self.at(target);
        let far = |branch: &[f64; 6]| {
            branch.iter().zip(&*q).map(|(there, here)| wrapped(there - here).abs()).fold(0.0, f64::max)
        };
        let Some(best) = found.as_slice().iter().min_by(|one, other| far(one).total_cmp(&far(other))) else {
            *q = near;
            return left;
        };
        for (here, there) in q.iter_mut().zip(best) {
            *here += wrapped(there - *here);
        }
        newton(&self.arm, target, q, MOST_STEPS)
    }
}

impl Seen {
    /// Starts of the iteration, as readings.
    fn starts(&self, arm: &Arm, target: &Pose) -> Starts {
        let motion = *target * arm.home().inverse();
        let motion = if self.is_reversed { motion.inverse() } else { motion };
        let mut starts = Starts::EMPTY;
        let mut push = |mut q: [f64; 6], is_touching: bool| {
            if self.is_reversed {
                q.reverse();
                q = q.map(|it| -it);
            }
            for (it, sense) in q.iter_mut().zip(arm.senses().unwrap_or_default()) {
                *it = wrapped(*it) / sense;
            }
            starts.is_touching |= is_touching;
            if let Some(next) = starts.values.get_mut(starts.count) {
                *next = q;
                starts.count += 1;
            }
        };
        match &self.way {
            Way::Wrist(wrist) => wrist.seeds(&motion, &mut push),
            Way::Parallel(parallel) => parallel.seeds(&motion, &mut push),
            Way::General(general) => general.seeds(&motion, &mut |q| push(q, false)),
        }
        starts
    }
}

/// Starts of the iteration.
struct Starts {
    values: [[f64; 6]; MOST_STARTS],
    count: usize,
    /// Whether two of them meet or almost do.
    is_touching: bool,
}

impl Starts {
    const EMPTY: Self = Starts { values: [[0.0; 6]; MOST_STARTS], count: 0, is_touching: false };

    /// Adds the branches that starts lead to, of those that are asked for; the most that one of them is to be doubted ([`newton_judged`]).
    fn follow(
        &self,
        arm: &Arm,
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
                q = q.map(wrapped);
                if !arm.is_rigid() {
                    // With an error of its gear, a joint is not where it was a turn ago.
                    left = newton(arm, target, &mut q, MOST_STEPS);
                }
            }
            if left < REACHED {
                found.add(&q);
                doubt = doubt.max(if apart(start, &q) > ASTRAY { 1.0 } else { ratio });
            }
        }
        doubt
    }
}

/// What a way finds in a few configurations of an arm.
#[derive(Clone, Copy)]
struct Judged {
    count: usize,
    /// Sum of the doubts.
    doubt: f64,
}

impl Judged {
    /// Roots are the nearer to branches, the better the equations serve the arm's geometry.
    fn worth(&self) -> f64 {
        self.count as f64 - self.doubt
    }
}

fn judged(arm: &Arm, way: &Seen) -> Judged {
    let mut judged = Judged { count: 0, doubt: 0.0 };
    for sample in 1..=SAMPLES {
        // Irrational shares of a turn are spread evenly.
        let spread = |k: usize| wrapped(sample as f64 * SPREAD[k]);
        let target = arm.forward_kinematics(&[0, 1, 2, 3, 4, 5].map(spread));
        let mut found = Branches::EMPTY;
        let doubt = way.starts(arm, &target).follow(arm, &target, &mut found, |_, _| true);
        judged.count += found.count;
        judged.doubt += doubt.min(1.0);
    }
    judged
}
