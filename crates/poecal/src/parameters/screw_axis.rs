//! A joint's screw, in the minimal basis of its axis frame (docs/theory.md §5).

use nalgebra::Vector3;

use super::columns::{Column, Columns, Unit};
use crate::estimate::{Chain, Estimate};
use crate::lie::{Pose, Twist};
use crate::measurement::TargetTwist;
use crate::robot::JointKind;

/// The screw of joint `joint`, moved by the adjoint of a local step `ε` in its axis frame: `A ← A exp(ε)`, which is
/// `ξ ← Ad_exp(η) ξ` with `η = Ad_A ε` (lou2009 equations 16 to 18 without the kernel of η).
///
/// Revolute, `ε = (tx, ty, 0; rx, ry, 0)`, 4 unknowns: with `Δx = (1 - cos θ) x - sin θ y`, `Δy = sin θ x + (1 - cos θ) y` and
/// `d` from the axis frame's origin to the target, the columns are `(Δx; 0), (Δy; 0), (Δx × d; Δx), (Δy × d; Δy)`.
/// Prismatic, `ε = (0; rx, ry, 0)`, 2 unknowns: `(-θ y; 0), (θ x; 0)`.
///
/// ```
/// use poecal::parameters::{Columns, ScrewAxis};
/// use poecal::robot::JointKind;
/// assert_eq!(ScrewAxis { joint: 0, kind: JointKind::Revolute }.columns().len(), 4);
/// assert_eq!(ScrewAxis { joint: 0, kind: JointKind::Prismatic }.columns().len(), 2);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScrewAxis {
    /// Index of the joint.
    pub joint: usize,
    /// Its kind.
    pub kind: JointKind,
}

const SHIFT: Column = Column { unit: Unit::Metre, shifts_only: true };
const TILT: Column = Column { unit: Unit::Radian, shifts_only: false };
const SLIDE: Column = Column { unit: Unit::Radian, shifts_only: true };

impl Columns for ScrewAxis {
    fn columns(&self) -> &'static [Column] {
        match self.kind {
            JointKind::Revolute => &[SHIFT, SHIFT, TILT, TILT],
            JointKind::Prismatic => &[SLIDE, SLIDE],
        }
    }

    fn target_twists(&self, chain: &Chain, _: usize, out: &mut [TargetTwist]) {
        let joint = &chain.joints[self.joint];
        match self.kind {
            JointKind::Revolute => {
                let versine = 1.0 - joint.cosine_or_value;
                let dx = joint.x * versine - joint.y * joint.sine;
                let dy = joint.x * joint.sine + joint.y * versine;
                let arm = chain.target.translation - joint.origin;
                out[0] = (dx, Vector3::zeros());
                out[1] = (dy, Vector3::zeros());
                out[2] = (dx.cross(&arm), dx);
                out[3] = (dy.cross(&arm), dy);
            }
            JointKind::Prismatic => {
                out[0] = (joint.y * -joint.cosine_or_value, Vector3::zeros());
                out[1] = (joint.x * joint.cosine_or_value, Vector3::zeros());
            }
        }
    }

    fn retract(&self, estimate: &mut Estimate, step: &[f64]) {
        let local = match self.kind {
            JointKind::Revolute => {
                Twist::new(Vector3::new(step[0], step[1], 0.0), Vector3::new(step[2], step[3], 0.0))
            }
            JointKind::Prismatic => Twist::new(Vector3::zeros(), Vector3::new(step[0], step[1], 0.0)),
        };
        let frame = &mut estimate.base_from_axis[self.joint];
        *frame = (*frame * Pose::exp(&local)).orthonormalized();
    }
}
