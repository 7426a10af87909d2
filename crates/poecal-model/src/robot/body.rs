//! Bodies of a robot: the base, and the links that joints move. Together with the joints they are a tree.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Robot;
use poecal_arm::lie::Pose;
use poecal_numerics::error::{ErrorKind, Result};

/// Name of the only target where no row names it.
pub const MEASURED: &str = "measured";

/// Frames that differ by less (metres, or of rotation matrices) are one.
const SAME: f64 = 1e-12;

/// A body: the base, or the link that a joint moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Body {
    /// The base.
    Base,
    /// The link that the joint of this index moves.
    Link(usize),
}

impl Body {
    /// Joint that moves it; `None` for the base.
    #[must_use]
    pub fn joint(self) -> Option<usize> {
        match self {
            Body::Base => None,
            Body::Link(joint) => Some(joint),
        }
    }
}

/// A frame on a body: that of an instrument or a target.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mount {
    /// Name of the instrument or target.
    pub name: String,
    /// Body.
    pub body: Body,
    /// Pose in the frame of the joint that moves the body, or in the base.
    pub pose: Pose,
}

impl Robot {
    /// Body that carries a joint.
    #[must_use]
    pub fn body_before(&self, joint: usize) -> Body {
        let before = joint.checked_sub(1).map_or(Body::Base, Body::Link);
        self.joints.get(joint).and_then(|joint| joint.stands_on).unwrap_or(before)
    }

    /// Body of the tip.
    #[must_use]
    pub fn tip_body(&self) -> Body {
        let last = self.joints.len().checked_sub(1).map_or(Body::Base, Body::Link);
        self.tip.unwrap_or(last)
    }

    /// Joints between the base and a body, from the base on.
    #[must_use]
    pub fn joints_to(&self, body: Body) -> Vec<usize> {
        let mut joints: Vec<usize> =
            std::iter::successors(body.joint(), |&joint| self.body_before(joint).joint()).collect();
        joints.reverse();
        joints
    }

    /// True if each joint is on the link of the one before, and the tip on the last: a robot without branches.
    #[must_use]
    pub fn is_serial(&self) -> bool {
        self.joints_to(self.tip_body()).len() == self.joints.len()
    }

    /// `base_from_mount` at zero joint values.
    #[must_use]
    pub fn base_from(&self, mount: &Mount) -> Pose {
        match mount.body.joint().and_then(|joint| self.joints.get(joint)) {
            Some(joint) => joint.frame * mount.pose,
            None => mount.pose,
        }
    }

    /// A frame on a body, from its pose in the base at zero joint values.
    #[must_use]
    pub fn mount(&self, name: &str, body: Body, base_from_mount: &Pose) -> Mount {
        let pose = match body.joint().and_then(|joint| self.joints.get(joint)) {
            Some(joint) => joint.frame.inverse() * *base_from_mount,
            None => *base_from_mount,
        };
        Mount { name: name.to_owned(), body, pose }
    }

    /// The same robot with its tip at an instrument or a target.
    #[must_use]
    pub fn with_tip_at(&self, mount: &Mount) -> Self {
        Robot { tip: Some(mount.body), home: self.base_from(mount), ..self.clone() }
    }

    /// True if a target is at the tip.
    pub fn is_at_tip(&self, mount: &Mount) -> bool {
        let place = self.base_from(mount);
        let apart = (place.translation - self.home.translation).amax();
        let turned = (place.rotation - self.home.rotation).amax();
        mount.body == self.tip_body() && apart < SAME && turned < SAME
    }

    /// Pose of a target by its name, or of [`MEASURED`] without one: its body, and `base_from_target` at zero joint values. A target that the
    /// model does not name is at the tip.
    pub fn places_of_targets(&self) -> impl Fn(Option<&str>) -> (Body, Pose) {
        let tip = self.tip_body();
        let at_tip = self.targets.iter().map(|(name, pose)| (name.as_str(), (tip, self.home * *pose)));
        let mounted = self.mounted.iter().map(|mount| (mount.name.as_str(), (mount.body, self.base_from(mount))));
        let mut known: BTreeMap<&str, (Body, Pose)> = BTreeMap::new();
        for (name, place) in mounted.chain(at_tip) {
            known.entry(name).or_insert(place);
        }
        move |name| known.get(name.unwrap_or(MEASURED)).copied().unwrap_or((tip, self.home))
    }

    /// Checks that every joint is on a body before it, and that tip and mounts are on bodies of this robot.
    ///
    /// # Errors
    /// [`ErrorKind::Model`].
    pub fn check_tree(&self) -> Result<()> {
        let count = self.joints.len();
        let is_known = |body: Body, below: usize| body.joint().is_none_or(|joint| joint < below);
        let joints = (0..count).all(|joint| is_known(self.body_before(joint), joint));
        let mounts = self.instruments.iter().chain(&self.mounted).all(|mount| is_known(mount.body, count));
        let masses = self.masses.iter().all(|mass| is_known(mass.body, count));
        if joints && mounts && masses && is_known(self.tip_body(), count) {
            return Ok(());
        }
        ErrorKind::Model.refuse(format!(
            "robot `{}` has a joint or a frame on a link that does not come before it, expected a tree from the base on",
            self.name
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::tests::elbow;

    #[test]
    fn each_joint_of_a_serial_robot_stands_on_the_link_before() {
        let robot = elbow();
        assert_eq!((robot.body_before(0), robot.body_before(3)), (Body::Base, Body::Link(2)));
        assert_eq!(robot.tip_body(), Body::Link(5));
        let on_the_forearm = robot.with_tip_at(&robot.mount("marker", Body::Link(2), &Pose::identity()));
        assert_eq!(on_the_forearm.joints_to(on_the_forearm.tip_body()), [0, 1, 2]);
    }

    #[test]
    fn a_mount_is_where_it_was_put() {
        let robot = elbow();
        let on_the_wrist = Mount { name: "camera".to_owned(), body: Body::Link(4), pose: Pose::identity() };
        assert_eq!(robot.base_from(&on_the_wrist), robot.joints[4].frame);
        let tool = robot.mount("tool", robot.tip_body(), &robot.home);
        assert!((robot.base_from(&tool).translation - robot.home.translation).norm() < 1e-15);
    }
}
