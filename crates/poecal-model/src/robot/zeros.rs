//! Joint offsets as a part of the screws.

use super::{JointTerm, Robot, Term};
use poecal_arm::lie::Pose;

impl Robot {
    /// The same robot without joint offsets: that of joint i moves all screws beyond it, with their bodies, by `exp(ξ_i c)` (lou2009
    /// equations 11 to 15, theory.md §3 (9a)). The result is exact: no pose at any readings changes, unless another term is a function
    /// of the values.
    #[must_use]
    pub fn without_offsets(&self) -> Robot {
        let mut robot = self.clone();
        robot.terms.retain(|it| it.term != Term::OFFSET);
        if robot.terms.len() == self.terms.len() {
            return robot;
        }
        // Motion of each joint's link.
        let mut motions: Vec<Pose> = Vec::with_capacity(self.joints.len());
        let of = |motions: &[Pose], body: Option<usize>| {
            body.and_then(|joint| motions.get(joint)).copied().unwrap_or_else(Pose::identity)
        };
        for (index, joint) in robot.joints.iter_mut().enumerate() {
            let own = self.terms.iter().filter(|it| it.joint == index && it.term == Term::OFFSET);
            let offset: f64 = own.map(|it: &JointTerm| it.coefficient).sum();
            let before = of(&motions, self.body_before(index).joint());
            let motion = before * joint.screw.exp(offset);
            joint.screw = joint.screw.transform(&before);
            joint.frame = (motion * joint.frame).orthonormalized();
            motions.push(motion);
        }
        for mass in &mut robot.masses {
            mass.place = of(&motions, mass.body.joint()).act(&mass.place);
        }
        robot.home = (of(&motions, self.tip_body().joint()) * robot.home).orthonormalized();
        robot
    }
}
