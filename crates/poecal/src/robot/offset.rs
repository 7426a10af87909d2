//! Joint offset.

use super::{JointKind, JointTerm, Robot, Term, TermModel};
use crate::lie::Pose;
use crate::unit::Unit;

/// Where the reading of a joint is zero, `θ ← θ + c` (lou2009: Δθ).
pub(super) struct Offset;

impl TermModel for Offset {
    fn name(&self) -> &'static str {
        "offset"
    }

    fn unit(&self, kind: JointKind) -> Unit {
        match kind {
            JointKind::Revolute => Unit::Radian,
            JointKind::Prismatic => Unit::Metre,
        }
    }

    fn basis(&self, _: usize, _: &[f64]) -> f64 {
        1.0
    }

    /// An encoder that was mounted anew: 5° or 20 mm.
    fn deviation(&self, kind: JointKind) -> f64 {
        match kind {
            JointKind::Revolute => 5f64.to_radians(),
            JointKind::Prismatic => 0.02,
        }
    }
}

impl Robot {
    /// The same robot without joint offsets: that of joint i moves all screws beyond it, and what stands there, by `exp(ξ_i c)` (lou2009
    /// equations 11 to 15, theory.md §3 (9a)). Exact: no pose at any readings changes, unless another term is a function of the values.
    #[must_use]
    pub fn without_offsets(&self) -> Robot {
        let mut robot = self.clone();
        robot.terms.retain(|it| it.term != Term::Offset);
        if robot.terms.len() == self.terms.len() {
            return robot;
        }
        // How the link of each joint moves.
        let mut motions: Vec<Pose> = Vec::with_capacity(self.joints.len());
        let of = |motions: &[Pose], body: Option<usize>| {
            body.and_then(|joint| motions.get(joint)).copied().unwrap_or_else(Pose::identity)
        };
        for (index, joint) in robot.joints.iter_mut().enumerate() {
            let own = self.terms.iter().filter(|it| it.joint == index && it.term == Term::Offset);
            let offset: f64 = own.map(|it: &JointTerm| it.coefficient).sum();
            let before = of(&motions, self.body_before(index).joint());
            let motion = before * joint.screw.exp(offset);
            joint.screw = joint.screw.transformed(&before);
            joint.frame = (motion * joint.frame).orthonormalized();
            motions.push(motion);
        }
        robot.home = (of(&motions, self.tip_body().joint()) * robot.home).orthonormalized();
        robot
    }
}
