//! Joint offset: joint value minus reading.

use nalgebra::Vector3;

use super::columns::{Column, Columns, Subject};
use crate::estimate::{Chain, Estimate};
use crate::lie::TargetTwist;
use crate::robot::JointKind;
use crate::unit::Unit;

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
    fn subject(&self) -> Subject {
        Subject::Joint(self.joint)
    }

    fn columns(&self) -> &'static [Column] {
        match self.kind {
            JointKind::Revolute => &[Column { unit: Unit::Radian, shifts_only: false }],
            JointKind::Prismatic => &[Column { unit: Unit::Metre, shifts_only: true }],
        }
    }

    fn target_twists(&self, chain: &Chain, _: usize, out: &mut [TargetTwist]) {
        out[0] = (Vector3::zeros(), Vector3::zeros());
        for joint in chain.of_joint(self.joint) {
            let z = if joint.backward { -joint.z } else { joint.z };
            let (moved, turned) = match self.kind {
                JointKind::Revolute => (z.cross(&(chain.target.translation - joint.origin)), z),
                JointKind::Prismatic => (z, Vector3::zeros()),
            };
            out[0].0 += moved;
            out[0].1 += turned;
        }
    }

    fn has_curvature(&self) -> bool {
        false
    }

    fn retract(&self, estimate: &mut Estimate, step: &[f64]) {
        estimate.joint_offset[self.joint] += step[0];
    }
}
