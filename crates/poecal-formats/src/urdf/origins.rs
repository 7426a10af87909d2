//! Origins of the joints of a URDF, by their names.

use super::UrdfDocument;
use poecal_arm::lie::{Pose, rotation};
use poecal_model::robot::Robot;

/// The `<origin>` of a joint in its text, metres and radians.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfOrigin {
    /// Name of the joint.
    pub joint: String,
    /// Translation, metres.
    pub xyz: [f64; 3],
    /// Roll, pitch and yaw: extrinsic angles about x, y, z, radians.
    pub rpy: [f64; 3],
}

impl UrdfDocument {
    /// Origins of the joints of the chain or tree, from base to tips.
    pub fn origins(&self) -> Vec<UrdfOrigin> {
        let stated = |range: &Option<std::ops::Range<usize>>| -> Option<[f64; 3]> {
            let text = self.text.get(range.clone()?)?;
            let numbers: Vec<f64> = text.split_whitespace().filter_map(|it| it.parse().ok()).collect();
            numbers.try_into().ok()
        };
        let of = |part: &super::urdf_joints::UrdfJoint| UrdfOrigin {
            joint: part.name.clone(),
            xyz: stated(&part.place.xyz).unwrap_or_else(|| part.parent_from_joint.translation.into()),
            rpy: stated(&part.place.rpy).unwrap_or_else(|| rotation::to_rpy(&part.parent_from_joint.rotation)),
        };
        self.parts.iter().map(of).collect()
    }

    /// Pose in the base of the link below a joint, by the poses of all links so far. Without a joint, it is the link from which the chain leads
    /// down.
    pub(crate) fn link_pose(&self, links: &[Pose], part: Option<usize>) -> Pose {
        part.and_then(|part| links.get(part)).copied().unwrap_or(self.base_from_top)
    }

    /// Pose in the base of the parent link of the first moving joint, by the fixed joints before it.
    pub fn base_from_first_parent(&self) -> Pose {
        let mut links: Vec<Pose> = Vec::new();
        for part in &self.parts {
            let parent = self.link_pose(&links, part.parent);
            if part.axis.is_some() {
                return parent;
            }
            links.push(parent * part.parent_from_joint);
        }
        Pose::identity()
    }

    /// The serial robot with other origins, and the axes of this text.
    pub fn with_origins(&self, origins: &[UrdfOrigin]) -> Robot {
        let mut robot = self.robot.clone();
        let mut links: Vec<Pose> = Vec::with_capacity(self.parts.len());
        let mut joints = robot.joints.iter_mut();
        for (part, origin) in self.parts.iter().zip(origins) {
            let frame = self.link_pose(&links, part.parent) * Pose::from_xyz_rpy(origin.xyz, origin.rpy);
            if let Some((axis, joint)) = part.axis.and_then(|axis| Some((axis, joints.next()?))) {
                let direction = frame.rotation * axis;
                joint.frame = frame;
                joint.screw = joint.kind.screw(&direction, &frame.translation);
            }
            links.push(frame);
        }
        robot.home = self.link_pose(&links, self.ends.first().and_then(|tip| tip.part));
        robot
    }
}
