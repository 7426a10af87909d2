//! An arm that moves to poses.

use std::sync::{Arc, OnceLock};

use poecal_arm::{AllBranches, Arm};

use super::NOTHING;
use crate::lie::Pose;

/// An arm, and all its branches once they are asked for: what is computed once for them takes as long as thousands of searches.
#[derive(Clone, Debug)]
pub(super) struct Reach {
    arm: Arm,
    branches: Arc<OnceLock<Option<AllBranches>>>,
}

impl Reach {
    pub(super) fn new(arm: Arm) -> Self {
        Reach { arm, branches: Arc::default() }
    }

    pub(super) fn arm(&self) -> &Arm {
        &self.arm
    }

    pub(super) fn branches(&self) -> Option<&AllBranches> {
        self.branches.get_or_init(|| AllBranches::new(&self.arm)).as_ref()
    }

    /// As [`AllBranches::nearest`], and as [`Arm::nearest`] of an arm that has none; what is left.
    pub(super) fn nearest(&self, target: &Pose, q: &mut [f64]) -> f64 {
        let start: Option<[f64; 6]> = (&*q).try_into().ok();
        let left = self.arm.nearest(target, q);
        if left < NOTHING && left * self.arm.reach_m() < NOTHING {
            return left;
        }
        match (<&mut [f64; 6]>::try_from(q), start, self.branches()) {
            (Ok(six), Some(start), Some(branches)) => {
                *six = start;
                branches.nearest(target, six)
            }
            (Err(_), _, _) | (_, None, _) | (_, _, None) => left,
        }
    }
}
