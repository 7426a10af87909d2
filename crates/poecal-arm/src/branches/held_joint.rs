//! All configurations of an arm of seven axes, one of which is held.

use core::f64::consts::PI;

use super::solution_methods::{MOST_STEPS, MethodRanking, SolutionMethods};
use super::{Branches, largest_difference, sort, unwind_turns};
use crate::arm::Arm;
use crate::lie::{Pose, Screw};
use crate::newton::{REACHED, SixJoints, newton};
use crate::trig::wrap_angle;

/// Values of the held joint (rad) at which its choice is judged.
const VALUES: [f64; 3] = [0.5, -1.3, 2.1];
/// Share of the motion of the most moving joint below which a joint cannot be held: the elbow of a spherical shoulder and wrist.
const IDLE: f64 = 0.1;
/// Steps (rad) by which a held joint is moved in search of a configuration: a whole turn to each side.
const STEP: f64 = 0.1;
const MOST_MOVES: u32 = 63;

/// All branches of an arm of seven revolute joints with one of them held at a value, the redundancy angle: those of the other six
/// ([`AllBranches`](super::AllBranches)). By default the held joint is the one without which the arm is nearest to an arm with branches in
/// closed form. It is the third for arms with a spherical shoulder and wrist, the last if only the shoulder is spherical.
///
/// ```
/// use nalgebra::Vector3;
/// use poecal_arm::{Arm, HeldBranches, lie::{Pose, Screw}};
/// let axes = [Vector3::z(), Vector3::y(), Vector3::z(), -Vector3::y(), Vector3::z(), Vector3::y(), Vector3::z()];
/// let points = [0.0, 0.36, 0.36, 0.78, 0.78, 1.18, 1.18].map(|z| Vector3::new(0.0, 0.0, z));
/// let screws: Vec<Screw> = axes.iter().zip(&points).map(|(axis, point)| Screw::revolute(axis, point)).collect();
/// let arm = Arm::new(&screws, &Pose::from_translation(Vector3::new(0.0, 0.0, 1.3))).unwrap();
/// let target = arm.forward_kinematics(&[0.3, -0.5, 0.2, 1.1, -0.4, 0.8, 0.1]);
/// let branches = HeldBranches::new(&arm, None).unwrap();
/// let found = branches.branches_at(&target, 0.4);
/// assert_eq!((branches.joint(), found.as_slice().len()), (2, 8));
/// for q in found.as_slice() {
///     assert!((arm.forward_kinematics(q).translation - target.translation).norm() < 1e-10);
///     assert_eq!(q[2], 0.4);
/// }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HeldBranches {
    arm: Arm,
    joint: usize,
    ranking: MethodRanking,
}

/// Solver of the other six joints with one held.
fn ways(arm: &Arm, joint: usize, value: f64, ranking: Option<MethodRanking>) -> Option<SolutionMethods> {
    let all: &[Screw; 7] = arm.screws().try_into().ok()?;
    let senses: &[f64; 7] = arm.senses()?.try_into().ok()?;
    let moved = all[joint].exp(value * senses[joint]);
    let other = |k: usize| if k < joint { k } else { k + 1 };
    let screws: [Screw; 6] = core::array::from_fn(|k| if k < joint { all[k] } else { all[k + 1].transform(&moved) });
    let senses = core::array::from_fn(|k| senses[other(k)]);
    Some(SolutionMethods::new(&screws, &(moved * *arm.home()), (arm.reach_m(), senses), ranking))
}

/// Self-motion of each joint, in a few configurations: minors of the Jacobian.
fn moves(arm: &Arm) -> [f64; 7] {
    let mut sum = [0.0; 7];
    for value in VALUES {
        let placed = arm.placed_at::<7>(&core::array::from_fn(|k| value + 0.7 * k as f64));
        for (joint, sum) in sum.iter_mut().enumerate() {
            let others = core::array::from_fn(|k| if k < joint { k } else { k + 1 });
            *sum += arm.minor(&placed, others).abs();
        }
    }
    sum
}

impl HeldBranches {
    /// Precomputation for an arm and the held joint (its index). `None` if the arm has not seven revolute joints, each with a reading of
    /// its own, or not this joint.
    #[must_use]
    pub fn new(arm: &Arm, joint: Option<usize>) -> Option<Self> {
        if arm.joints() != 7 || arm.senses().is_none() || arm.screws().iter().any(Screw::is_prismatic) {
            return None;
        }
        // Largest distance from an arm with branches in closed form.
        let off = |joint: usize| {
            let at =
                |value: &f64| ways(arm, joint, *value, None).map_or(f64::INFINITY, |it| it.distance_from_closed_form());
            VALUES.iter().map(at).fold(0.0, f64::max)
        };
        let joint = match joint {
            Some(joint) if joint < 7 => joint,
            Some(_) => return None,
            None => {
                let moves = moves(arm);
                let most = moves.iter().fold(0.0_f64, |most, it| most.max(*it));
                // If all are far, the third is taken.
                let all = [2, 6, 0, 4, 1, 3, 5].into_iter().filter(|joint| moves[*joint] > IDLE * most);
                all.min_by(|one, other| off(*one).total_cmp(&off(*other))).unwrap_or(2)
            }
        };
        let ways = ways(arm, joint, VALUES[0], None)?;
        let ranking = ways.rank_methods(&SixJoints::with_held_joint(arm, joint, VALUES[0]));
        Some(HeldBranches { arm: arm.clone(), joint, ranking })
    }

    /// Index of the held joint.
    #[must_use]
    pub fn joint(&self) -> usize {
        self.joint
    }

    /// Configurations with the tip at a pose of the base and the held joint at a value (rad); the others are in (-π, π].
    #[must_use]
    pub fn branches_at(&self, target: &Pose, value: f64) -> Branches<7> {
        let mut found = Branches::EMPTY;
        let Some(ways) = ways(&self.arm, self.joint, value, Some(self.ranking)) else { return found };
        let six = SixJoints::with_held_joint(&self.arm, self.joint, value);
        for q in ways.branches(&six, target).as_slice() {
            found.add(&SixJoints::all(q, (self.joint, value)), 0.0);
        }
        found
    }

    /// Configurations within the arm's limits, turned by whole turns nearest to `near`; sorted by the joint that has to move most.
    #[must_use]
    pub fn within_limits(&self, target: &Pose, value: f64, near: &[f64; 7]) -> Branches<7> {
        let mut found = Branches::EMPTY;
        let mut near = *near;
        near[self.joint] = value;
        for branch in self.branches_at(target, value).as_slice() {
            let Some(q) = unwind_turns(branch, &near, self.arm.limits()) else { continue };
            if (q[self.joint] - value).abs() > PI {
                continue;
            }
            found.add(&self.refine_branch(target, &q), 0.0);
        }
        sort(&mut found, &near);
        found
    }

    /// With gear errors, a joint changes its value after a whole turn.
    fn refine_branch(&self, target: &Pose, q: &[f64; 7]) -> [f64; 7] {
        if self.arm.is_rigid() {
            return *q;
        }
        let held = (self.joint, q[self.joint]);
        let mut six = core::array::from_fn(|k| if k < self.joint { q[k] } else { q[k + 1] });
        newton(&SixJoints::with_held_joint(&self.arm, held.0, held.1), target, &mut six, MOST_STEPS);
        SixJoints::all(&six, held)
    }

    /// As [`Arm::solve_nearest`], the least motion. If its iteration does not reach the pose, it is the nearest branch at a value of the redundancy
    /// angle. That value is the nearest to the current one, in steps of 0.1 rad.
    pub fn solve_nearest(&self, target: &Pose, q: &mut [f64; 7]) -> f64 {
        let mut near = *q;
        let left = self.arm.solve_nearest(target, &mut near);
        if left < REACHED {
            *q = near;
            return left;
        }
        let start = *q;
        let nearest = self.search(start[self.joint], |value| {
            let found = self.branches_at(target, value);
            let far = |it: &&[f64; 7]| largest_difference(it, &start);
            found.as_slice().iter().min_by(|one, other| far(one).total_cmp(&far(other))).copied()
        });
        let Some(best) = nearest else {
            *q = near;
            return left;
        };
        let there = core::array::from_fn(|k| start[k] + wrap_angle(best[k] - start[k]));
        *q = self.refine_branch(target, &there);
        self.arm.solve_nearest(target, q)
    }

    /// Configuration within the arm's limits with the tip at a pose, at the redundancy angle nearest to that of `near`, in steps of 0.1
    /// rad. Of several it is the one whose joints are nearest.
    #[must_use]
    pub fn nearest_within_limits(&self, target: &Pose, near: &[f64; 7]) -> Option<[f64; 7]> {
        let &(low, high) = self.arm.limits().get(self.joint)?;
        self.search(near[self.joint].clamp(low, high), |value| {
            let is_within = (low..=high).contains(&value);
            is_within.then(|| self.within_limits(target, value, near).as_slice().first().copied())?
        })
    }

    /// First result at values of the held joint with increasing distance from a start.
    fn search(&self, start: f64, find: impl Fn(f64) -> Option<[f64; 7]>) -> Option<[f64; 7]> {
        (0..=MOST_MOVES).map(|it| STEP * f64::from(it)).find_map(|by| find(start + by).or_else(|| find(start - by)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn branches_are_turned_by_whole_turns_to_where_they_are_near() {
        let (y, z) = (Vector3::y(), Vector3::z());
        let axes = [z, y, z, -y, z, y, z];
        let heights = [0.0, 0.36, 0.36, 0.78, 0.78, 1.18, 1.18];
        let screws: [Screw; 7] = core::array::from_fn(|k| Screw::revolute(&axes[k], &(heights[k] * z)));
        let arm = Arm::new(&screws, &Pose::from_translation(1.3 * z)).unwrap();
        let q = [3.5, 0.5, 0.2, 1.1, -0.4, 0.8, 0.1];
        let held = HeldBranches::new(&arm, None).unwrap();
        let found = held.within_limits(&arm.forward_kinematics(&q), q[2], &q);
        assert!((found.as_slice()[0][0] - 3.5).abs() < 1e-9);
    }
}
