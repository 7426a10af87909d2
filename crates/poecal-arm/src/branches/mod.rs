//! All configurations of an arm of six axes that have its tip at a pose.

mod axis;
mod general;
mod parallel;
mod roots;
mod wrist;

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::cmp::Reverse;
use core::f64::consts::{PI, TAU};

use axis::{Axis, motion_of};
use general::General;
use parallel::Parallel;
use wrist::Wrist;

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

use crate::arm::Arm;
use crate::lie::{Pose, Screw};
use crate::newton::{REACHED, newton};
use crate::trig::wrapped;

/// Least distance of two starts where two branches meet, rad.
const APART: f64 = 0.06;
/// Imaginary part of a pair of solutions up to which a real pair of the arm itself may be near, rad.
const BEYOND: f64 = 0.8;
/// The same once the arm's difference from its relative is known, and distance of starts that are one.
const CLOSE: f64 = 0.2;
/// Distance from a start within which its branches are, and from a branch within which a start leads to it.
const AROUND: f64 = 0.6;
const KNOWN: f64 = 0.15;
/// Difference of all joints (rad) below which two configurations are one.
const SAME: f64 = 1e-7;
/// Most branches of an arm of six axes (primrose1986).
pub const MOST_BRANCHES: usize = 16;
/// Of the six ways to set up the equations, so many in a row have to find nothing new.
const WITHOUT_NEWS: usize = 2;
/// Configurations in which the ways are compared.
const SAMPLES: usize = 24;
/// Steps between them: 2π times the fractions of the roots of 2, 3, 5, 7, 11 and 13.
const SPREAD: [f64; 6] = [2.602581, 4.599611, 1.483259, 4.057375, 1.989413, 3.804791];
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

    fn add(&mut self, q: &[f64; 6]) -> bool {
        let is_same = |other: &[f64; 6]| q.iter().zip(other).all(|(a, b)| wrapped(a - b).abs() < SAME);
        if self.count == MOST_BRANCHES || self.as_slice().iter().any(is_same) {
            return false;
        }
        self.values[self.count] = *q;
        self.count += 1;
        true
    }
}

/// A way to starts of the iteration, by the axes in their order or from the tip.
#[derive(Clone, Debug, PartialEq)]
enum Way {
    /// The nearest arm whose last three axes meet.
    Wrist(Wrist),
    /// The nearest arm whose second to fourth axes are parallel.
    Parallel(Parallel),
    /// The arm itself.
    General(Box<General>),
}

impl Way {
    /// Joint values of the branches in closed form, and whether two of them meet there or almost do.
    fn seeds(&self, motion: &Pose, beyond: f64, push: &mut impl FnMut([f64; 6], bool)) {
        match self {
            Way::Wrist(wrist) => wrist.seeds(motion, beyond, push),
            Way::Parallel(parallel) => parallel.seeds(motion, beyond, push),
            Way::General(_) => {}
        }
    }

    fn is_closed(&self) -> bool {
        match self {
            Way::Wrist(_) | Way::Parallel(_) => true,
            Way::General(_) => false,
        }
    }
}

/// All branches of one arm of six revolute joints: those of the nearest arm that has them in closed form (its last or first three axes meet,
/// or its second to fourth, or third to fifth, are parallel), each followed by Newton's iteration of the arm itself. Where two of them lead to
/// the same branch or one leads nowhere, and for arms that are far from such ones, the starts are the roots of the arm's own equations
/// (raghavan1993), which can be set up in six ways: they are asked until two in a row find nothing new.
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
    /// The ways in the order in which they are asked, and whether they go from the tip.
    ways: Vec<(Way, bool)>,
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
        let mut nearest: Option<(f64, Way, bool)> = None;
        let mut general = Vec::new();
        for (axes, is_reversed) in [(axes, false), (reversed, true)] {
            let wrist = Wrist::new(&axes).map(|(it, apart)| (apart / reach, Way::Wrist(it)));
            let parallel = Parallel::new(&axes)
                .map(|(it, angle, apart)| (f64::max(angle, apart / reach), Way::Parallel(it)));
            for (off, way) in wrist.into_iter().chain(parallel) {
                if off < FAR && nearest.as_ref().is_none_or(|(least, ..)| off < *least) {
                    nearest = Some((off, way, is_reversed));
                }
            }
            for first in General::FIRST {
                general.push((Way::General(Box::new(General::new(&axes, first, reach))), is_reversed));
            }
        }
        let mut counted: Vec<(usize, (Way, bool))> =
            general.into_iter().map(|way| (found_in_samples(arm, &way), way)).collect();
        counted.sort_by_key(|(count, _)| Reverse(*count));
        let closed = nearest.map(|(_, way, is_reversed)| (way, is_reversed));
        let ways = closed.into_iter().chain(counted.into_iter().map(|(_, way)| way)).collect();
        Some(AllBranches { arm: arm.clone(), ways })
    }

    /// The configurations that have the tip at a pose of the base.
    #[must_use]
    pub fn at(&self, target: &Pose) -> Branches {
        let mut found = Branches::EMPTY;
        let mut without_news = 0;
        for way in &self.ways {
            let before = found.count;
            let is_sure = follow(&self.arm, way, target, &mut found);
            // Branches come and go in pairs.
            let is_even = found.count.is_multiple_of(2);
            if way.0.is_closed() {
                if is_sure && is_even && found.count > 0 {
                    break;
                }
                continue;
            }
            let is_first = before == 0 && without_news == 0;
            without_news = if found.count == before && !is_first { without_news + 1 } else { 0 };
            if without_news >= WITHOUT_NEWS && is_even {
                break;
            }
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

/// Adds the branches that a way leads to; whether each of its starts leads to one of its own.
fn follow(arm: &Arm, (way, is_reversed): &(Way, bool), target: &Pose, found: &mut Branches) -> bool {
    let oriented = |motion: Pose| if *is_reversed { motion.inverse() } else { motion };
    let motion = oriented(*target * arm.home().inverse());
    let readings = |mut q: [f64; 6]| {
        if *is_reversed {
            q.reverse();
            q = q.map(|it| -it);
        }
        for (it, sense) in q.iter_mut().zip(arm.senses().unwrap_or_default()) {
            *it = wrapped(*it) / sense;
        }
        q
    };
    let push = |q: [f64; 6], found: &mut Branches| {
        let mut q = readings(q);
        let mut left = newton(arm, target, &mut q, MOST_STEPS);
        if q.iter().any(|it| it.abs() > PI) {
            q = q.map(wrapped);
            if !arm.is_rigid() {
                // With an error of its gear, a joint is not where it was a turn ago.
                left = newton(arm, target, &mut q, MOST_STEPS);
            }
        }
        left < REACHED && found.add(&q)
    };
    let mut is_sure = true;
    let axes = match way {
        Way::General(general) => {
            general.seeds(&motion, &mut |q| is_sure &= push(q, found));
            return is_sure;
        }
        Way::Wrist(wrist) => wrist.axes(),
        Way::Parallel(parallel) => parallel.axes(),
    };
    // Starts at which two branches meet, and which lead to none of their own.
    let mut open = Starts { values: [[0.0; 6]; MOST_BRANCHES], count: 0 };
    way.seeds(&motion, BEYOND, &mut |q, is_touching| {
        if !push(q, found) {
            if is_touching {
                open.add(&q);
            } else {
                is_sure = false;
            }
        }
    });
    for start in &open.values[..open.count] {
        // There, the arm differs from its relative by a motion that hardly depends on where it is: with it, the closed form tells whether the
        // branches meet.
        let is_there = oriented(arm.forward_kinematics(&readings(*start)) * arm.home().inverse());
        let there = motion * (is_there.inverse() * motion_of(axes, start));
        let near = |q: &[f64; 6], other: &[f64; 6], most: f64| {
            q.iter().zip(other).all(|(a, b)| wrapped(a - b).abs() < most)
        };
        let before = found.count;
        way.seeds(&there, CLOSE, &mut |q, _| {
            let is_known = found.as_slice().iter().any(|it| near(it, &readings(q), KNOWN));
            if near(&q, start, AROUND) || !is_known {
                push(q, found);
            }
        });
        is_sure &= found.count > before;
    }
    is_sure
}

/// Starts of the iteration.
struct Starts {
    values: [[f64; 6]; MOST_BRANCHES],
    count: usize,
}

impl Starts {
    fn add(&mut self, q: &[f64; 6]) {
        let is_same = |other: &[f64; 6]| q.iter().zip(other).all(|(a, b)| wrapped(a - b).abs() < CLOSE);
        if self.count < MOST_BRANCHES && !self.values[..self.count].iter().any(is_same) {
            self.values[self.count] = *q;
            self.count += 1;
        }
    }
}

/// Number of branches that a way finds in a few configurations of an arm: no way serves every geometry alike.
fn found_in_samples(arm: &Arm, way: &(Way, bool)) -> usize {
    let mut count = 0;
    for sample in 1..=SAMPLES {
        // Irrational shares of a turn are spread evenly.
        let spread = |k: usize| wrapped(sample as f64 * SPREAD[k]);
        let q = [0, 1, 2, 3, 4, 5].map(spread);
        let mut found = Branches::EMPTY;
        follow(arm, way, &arm.forward_kinematics(&q), &mut found);
        count += found.count;
    }
    count
}
