//! All configurations of an arm with its tip at a pose.
//!
//! Starts come from closed forms, or, in doubt, from the roots of the arm's equations (`solution_methods.rs`). They are refined by `newton.rs`; `held.rs` is
//! for seven joints.

mod axis;
mod branch_list;
mod general;
mod held_joint;
mod parallel;
mod roots;
mod solution_methods;
mod tables;
mod wrist;

pub use branch_list::{Branches, MOST_BRANCHES};
use branch_list::{SAME, largest_difference, sort, unwind_turns};
pub use held_joint::HeldBranches;
use solution_methods::{MOST_STEPS, SolutionMethods};

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

use crate::arm::Arm;
use crate::lie::{Pose, Screw};
use crate::newton::{REACHED, SixJoints, newton};
use crate::trig::wrap_angle;

/// All branches of one arm of six revolute joints. They begin with those of the nearest arm that has them in closed form: its last or first
/// three axes meet, or its second to fourth, or third to fifth, are parallel. Newton's iteration of the arm itself follows. The starts are the
/// roots of the arm's own equations (raghavan1993) in three cases: branches meet or almost do, an iteration leads far away or diverges, or the
/// arm is far from such an arm. These equations can be set up in six orders; the first has the roots nearest to the branches in a few
/// configurations. Another one is used if the number of branches is odd, as they come in pairs, and for arms without branches in closed form.
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
/// let branches = AllBranches::new(&arm).unwrap().branches_at(&target);
/// assert_eq!(branches.as_slice().len(), 4);
/// for q in branches.as_slice() {
///     assert!((arm.forward_kinematics(q).translation - target.translation).norm() < 1e-10);
/// }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct AllBranches {
    arm: Arm,
    ways: SolutionMethods,
}

impl AllBranches {
    /// Precomputation for an arm; `None` if it has not six revolute joints, each with a reading of its own.
    #[must_use]
    pub fn new(arm: &Arm) -> Option<Self> {
        let screws: &[_; 6] = arm.screws().try_into().ok()?;
        let senses: [f64; 6] = arm.senses()?.try_into().ok()?;
        if screws.iter().any(Screw::is_prismatic) {
            return None;
        }
        let mut ways = SolutionMethods::new(screws, arm.home(), (arm.reach_m(), senses), None);
        ways.keep(ways.rank_methods(&SixJoints::from_arm(arm)));
        Some(AllBranches { arm: arm.clone(), ways })
    }

    /// Configurations with the tip at a pose of the base.
    #[must_use]
    pub fn branches_at(&self, target: &Pose) -> Branches {
        self.ways.branches(&SixJoints::from_arm(&self.arm), target)
    }

    /// Configurations within the arm's limits ([`Arm::limits`]) with the tip at a pose. For each branch it is the one whose joints are nearest to
    /// `near`, turned by whole turns if that keeps limits; sorted by the joint that has to move most.
    #[must_use]
    pub fn within_limits(&self, target: &Pose, near: &[f64; 6]) -> Branches {
        let mut found = Branches::EMPTY;
        for branch in self.branches_at(target).as_slice() {
            let Some(mut q) = unwind_turns(branch, near, self.arm.limits()) else { continue };
            if !self.arm.is_rigid() {
                newton(&SixJoints::from_arm(&self.arm), target, &mut q, MOST_STEPS);
            }
            found.add(&q, 0.0);
        }
        sort(&mut found, near);
        found
    }

    /// As [`Arm::solve_nearest`]; if its iteration does not reach the pose, the branch with the least motion of the joint that moves most.
    pub fn solve_nearest(&self, target: &Pose, q: &mut [f64; 6]) -> f64 {
        let mut near = *q;
        let left = self.arm.solve_nearest(target, &mut near);
        if left < REACHED {
            *q = near;
            return left;
        }
        let found = self.branches_at(target);
        let far = |branch: &[f64; 6]| {
            branch.iter().zip(&*q).map(|(there, here)| wrap_angle(there - here).abs()).fold(0.0, f64::max)
        };
        let Some(best) = found.as_slice().iter().min_by(|one, other| far(one).total_cmp(&far(other))) else {
            *q = near;
            return left;
        };
        for (here, there) in q.iter_mut().zip(best) {
            *here += wrap_angle(there - *here);
        }
        newton(&SixJoints::from_arm(&self.arm), target, q, MOST_STEPS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    /// An arm with a spherical wrist.
    fn arm() -> Arm {
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        let (axes, heights) = ([z, y, y, x, y, x], [0.0, 0.0, 0.4, 0.4, 0.8, 0.8]);
        let screws: [Screw; 6] = core::array::from_fn(|k| Screw::revolute(&axes[k], &(heights[k] * z)));
        Arm::new(&screws, &Pose::from_translation(Vector3::new(0.1, 0.0, 0.8))).unwrap()
    }

    #[test]
    fn branches_are_turned_by_whole_turns_to_where_they_are_near() {
        let arm = arm();
        let q = [0.3, -0.3, 0.9, 0.1, 0.6, 6.2];
        let found = AllBranches::new(&arm).unwrap().within_limits(&arm.forward_kinematics(&q), &q);
        assert!((found.as_slice()[0][5] - 6.2).abs() < 1e-9);
    }

    #[test]
    fn the_nearest_configuration_is_on_the_same_turn() {
        let arm = arm();
        let target = arm.forward_kinematics(&[3.2, -0.3, 0.9, 0.1, 0.6, 0.0]);
        let mut q = [3.0, -0.4, 1.0, 0.0, 0.5, 0.2];
        assert!(AllBranches::new(&arm).unwrap().solve_nearest(&target, &mut q) < 1e-12);
        assert!((q[0] - 3.2).abs() < 1e-9);
    }
}
