//! Position of a target point on the last link.

use nalgebra::Vector3;

use super::columns::{Column, ParameterColumns, ParameterSubject, of_freedom};
use crate::state::{Estimate, RowChain};
use poecal_arm::lie::{Freedom, TargetTwist};

/// The point `P_c0` of lou2009 (19) to (26), stepped in the target's own axes: columns `(R_target e_k; 0)` (theory.md §5 (23)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TargetPlace {
    /// Index of the target.
    pub target: usize,
}

impl ParameterColumns for TargetPlace {
    fn subject(&self) -> ParameterSubject {
        ParameterSubject::Target(self.target)
    }

    fn columns(&self) -> &'static [Column] {
        of_freedom(Freedom::PLACE)
    }

    fn target_twists(&self, chain: &RowChain, target: usize, out: &mut [TargetTwist]) {
        for (k, twist) in out.iter_mut().enumerate() {
            *twist = if target == self.target {
                (chain.target.rotation.column(k).into_owned(), Vector3::zeros())
            } else {
                (Vector3::zeros(), Vector3::zeros())
            };
            if chain.shared == Some(self.target) {
                // The device's origin moves with the target.
                twist.0[k] -= 1.0;
            }
        }
    }

    fn retract(&self, estimate: &mut Estimate, step: &[f64]) {
        let pose = &mut estimate.base_from_target[self.target];
        pose.translation += pose.rotation * Vector3::new(step[0], step[1], step[2]);
    }
}
