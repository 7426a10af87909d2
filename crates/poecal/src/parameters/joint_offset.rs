//! Joint offset: joint value minus reading.

use nalgebra::Vector3;

use super::columns::{Column, Columns, Unit};
use crate::estimate::{Chain, Estimate};
use crate::lie::TargetTwist;
use crate::robot::JointKind;

/// The offset of joint `joint`, `θ ← θ + dθ`: the column `r = Ad_T ξ` of lou2009 (8d). At the target it is `(z × d; z)`, or `(z; 0)` of a
/// prismatic joint (theory.md §5 (26)). Beside free screws it adds no rank (lou2009 Proposition 1, theory.md §3 (9)).
///
/// ```
/// use poecal::parameters::{Columns, JointOffset};
/// use poecal::robot::JointKind;
/// assert_eq!(JointOffset { joint: 2, kind: JointKind::Revolute }.columns().len(), 1);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointOffset {
    /// Index of the joint.
    pub joint: usize,
    /// Its kind.
    pub kind: JointKind,
}

impl Columns for JointOffset {
    fn columns(&self) -> &'static [Column] {
        match self.kind {
            JointKind::Revolute => &[Column { unit: Unit::Radian, shifts_only: false }],
            JointKind::Prismatic => &[Column { unit: Unit::Metre, shifts_only: true }],
        }
    }

    fn target_twists(&self, chain: &Chain, _: usize, out: &mut [TargetTwist]) {
        let joint = &chain.joints[self.joint];
        out[0] = match self.kind {
            JointKind::Revolute => (joint.z.cross(&(chain.target.translation - joint.origin)), joint.z),
            JointKind::Prismatic => (joint.z, Vector3::zeros()),
        };
    }

    fn has_curvature(&self) -> bool {
        false
    }

    fn retract(&self, estimate: &mut Estimate, step: &[f64]) {
        estimate.joint_offset[self.joint] += step[0];
    }
}
