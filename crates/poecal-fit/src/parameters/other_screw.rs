//! A joint's screw in another parameterisation than [`ScrewAxis`](super::ScrewAxis), which the caller supplies.

use std::fmt::Debug;

use nalgebra::Vector3;

use super::columns::{Column, ParameterColumns, ParameterSubject};
use crate::state::{Estimate, JointView, RowChain};
use poecal_arm::lie::{Pose, TargetTwist};
use poecal_model::robot::JointKind;

/// Parameterisation of the errors of a screw. Such a problem takes the row-by-row path, without the full Hessian.
pub trait ScrewModel: Debug + Sync {
    /// Name; models of one name are equal.
    fn name(&self) -> &'static str;

    /// Unknowns of a joint of this kind, at most six.
    fn columns(&self, kind: JointKind) -> &'static [Column];

    /// Target twist per unit of each unknown, as in [`ParameterColumns::target_twists`].
    fn target_twists(&self, joint: &JointView, chain: &RowChain, out: &mut [TargetTwist]);

    /// Projection of a step, as in [`ParameterColumns::project_constraints`].
    fn project_constraints(&self, kind: JointKind, step: &mut [f64]);

    /// `base_from_axis` after a step (metres, radians).
    fn retract(&self, kind: JointKind, base_from_axis: &Pose, step: &[f64]) -> Pose;
}

/// The screw of a joint by a [`ScrewModel`].
#[derive(Clone, Copy, Debug)]
pub struct OtherScrew {
    /// Index of the joint.
    pub joint: usize,
    /// Kind.
    pub kind: JointKind,
    /// Parameterisation.
    pub model: &'static dyn ScrewModel,
}

impl PartialEq for OtherScrew {
    fn eq(&self, other: &Self) -> bool {
        let key = |it: &OtherScrew| (it.joint, it.kind, it.model.name());
        key(self) == key(other)
    }
}

impl ParameterColumns for OtherScrew {
    fn subject(&self) -> ParameterSubject {
        ParameterSubject::Joint(self.joint)
    }

    fn columns(&self) -> &'static [Column] {
        self.model.columns(self.kind)
    }

    fn target_twists(&self, chain: &RowChain, _: usize, out: &mut [TargetTwist]) {
        let mut own = [(Vector3::zeros(), Vector3::zeros()); 6];
        out.fill((Vector3::zeros(), Vector3::zeros()));
        for joint in chain.of_joint(self.joint) {
            self.model.target_twists(joint, chain, &mut own[..out.len()]);
            for ((v, w), (moved, turned)) in out.iter_mut().zip(&own) {
                *v += moved;
                *w += turned;
            }
        }
    }

    fn has_curvature(&self) -> bool {
        false
    }

    fn project_constraints(&self, step: &mut [f64]) {
        self.model.project_constraints(self.kind, step);
    }

    fn retract(&self, estimate: &mut Estimate, step: &[f64]) {
        let frame = &mut estimate.base_from_axis[self.joint];
        *frame = self.model.retract(self.kind, frame, step);
    }
}
