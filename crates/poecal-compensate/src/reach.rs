//! An arm with its inverse kinematics.

use std::sync::{Arc, OnceLock};

use poecal_arm::{AllBranches, Arm, HeldBranches};

use poecal_arm::lie::Pose;

/// Remainder (m, rad) that is negligible.
const NOTHING: f64 = 1e-11;

/// An arm, and all its branches on first use: computing them once takes as long as thousands of searches.
#[derive(Clone, Debug)]
pub(crate) struct Reach {
    arm: Arm,
    branches: Arc<OnceLock<Option<AllBranches>>>,
    /// Branches of an arm of seven, with each joint held.
    held: Arc<[OnceLock<Option<HeldBranches>>; 7]>,
    /// Index of the joint that is best held.
    best: Arc<OnceLock<Option<usize>>>,
}

impl Reach {
    pub(crate) fn new(arm: Arm) -> Self {
        Reach { arm, branches: Arc::default(), held: Arc::default(), best: Arc::default() }
    }

    pub(crate) fn arm(&self) -> &Arm {
        &self.arm
    }

    pub(crate) fn branches(&self) -> Option<&AllBranches> {
        self.branches.get_or_init(|| AllBranches::new(&self.arm)).as_ref()
    }

    /// The branches of an arm of seven with one of its joints held.
    pub(crate) fn branches_with_held(&self, joint: usize) -> Option<&HeldBranches> {
        self.held.get(joint)?.get_or_init(|| HeldBranches::new(&self.arm, Some(joint))).as_ref()
    }

    /// The joint of an arm of seven that is best held.
    pub(crate) fn best_held_joint(&self) -> Option<usize> {
        *self.best.get_or_init(|| HeldBranches::new(&self.arm, None).map(|it| it.joint()))
    }

    /// As [`AllBranches::solve_nearest`] and [`HeldBranches::solve_nearest`], or [`Arm::solve_nearest`] for an arm that has neither; returns the remainder.
    pub(crate) fn solve_nearest(&self, target: &Pose, q: &mut [f64]) -> f64 {
        let start: Option<[f64; 6]> = (&*q).try_into().ok();
        let left = self.arm.solve_nearest(target, q);
        if left < NOTHING && left * self.arm.reach_m() < NOTHING {
            return left;
        }
        if let (Ok(six), Some(start)) = (<&mut [f64; 6]>::try_from(&mut *q), start) {
            let Some(branches) = self.branches() else { return left };
            *six = start;
            return branches.solve_nearest(target, six);
        }
        match (<&mut [f64; 7]>::try_from(q), self.best_held_joint().and_then(|it| self.branches_with_held(it))) {
            (Ok(seven), Some(held)) => held.solve_nearest(target, seven),
            (Err(_), _) | (_, None) => left,
        }
    }
}
