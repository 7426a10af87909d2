//! A joint's screw in another parameterisation than [`ScrewAxis`](super::ScrewAxis), which is given from outside.

use std::fmt::Debug;

use super::columns::{Column, Columns};
use crate::estimate::{Chain, Estimate, JointView};
use crate::lie::{Pose, TargetTwist};
use crate::robot::JointKind;

/// Parameterisation of the errors of a screw. Such a problem takes the row-by-row path, without the full Hessian.
pub trait ScrewModel: Debug + Sync {
    /// Its name; models of one name are equal.
    fn name(&self) -> &'static str;

    /// The unknowns of a joint of this kind, at most six.
    fn columns(&self, kind: JointKind) -> &'static [Column];

    /// Target twist per unit of each unknown, as in [`Columns::target_twists`].
    fn target_twists(&self, joint: &JointView, chain: &Chain, out: &mut [TargetTwist]);

    /// Projection of a step, as in [`Columns::project_constraints`].
    fn project_constraints(&self, kind: JointKind, step: &mut [f64]);

    /// `base_from_axis` after a step (metres, radians).
    fn retract(&self, kind: JointKind, base_from_axis: &Pose, step: &[f64]) -> Pose;
}

/// The screw of a joint by a [`ScrewModel`].
#[derive(Clone, Copy, Debug)]
pub struct OtherScrew {
    /// Index of the joint.
    pub joint: usize,
    /// Its kind.
    pub kind: JointKind,
    /// Its parameterisation.
    pub model: &'static dyn ScrewModel,
}

impl PartialEq for OtherScrew {
    fn eq(&self, other: &Self) -> bool {
        let key = |it: &OtherScrew| (it.joint, it.kind, it.model.name());
        key(self) == key(other)
    }
}

impl Columns for OtherScrew {
    fn columns(&self) -> &'static [Column] {
        self.model.columns(self.kind)
    }

    fn target_twists(&self, chain: &Chain, _: usize, out: &mut [TargetTwist]) {
        self.model.target_twists(&chain.joints[self.joint], chain, out);
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
