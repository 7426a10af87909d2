//! Joints whose bearings and links give.

use super::gravity::axes;
use super::{Body, Joint, JointKind, Mount, Reading, Robot, Weight};
use crate::lie::{Screw, rotation};

impl Robot {
    /// The same robot whose joints and links can tilt: behind each of these joints stand gives about the x and y axes of its axis frame, of a
    /// prismatic joint also about z. A give is a revolute joint at zero, which turns by its terms alone (theory.md §3, *Gives*). Beside the
    /// robot, the new index of each of its joints.
    ///
    /// ```
    /// let robot = poecal::simulate::elbow();
    /// let (giving, places) = robot.giving(&[1]);
    /// assert_eq!((giving.joints.len(), &places[..3]), (8, &[0, 1, 4][..]));
    /// assert_eq!(giving.forward_kinematics(&[0.3; 6]), robot.forward_kinematics(&[0.3; 6]));
    /// ```
    #[must_use]
    pub fn giving(&self, joints: &[usize]) -> (Robot, Vec<usize>) {
        let mut robot = self.clone();
        robot.joints.clear();
        let (mut places, mut ends) = (Vec::new(), Vec::new());
        for (index, joint) in self.joints.iter().enumerate() {
            places.push(robot.joints.len());
            robot.joints.push(joint.clone());
            if joints.contains(&index) {
                let own = robot.joints.len() - 1;
                robot.joints.extend(gives(joint, own));
            }
            ends.push(robot.joints.len() - 1);
        }
        let moved = |body: Body| match body {
            Body::Base => Body::Base,
            Body::Link(joint) => Body::Link(ends.get(joint).copied().unwrap_or(joint)),
        };
        for joint in robot.joints.iter_mut().filter(|joint| joint.give_of.is_none()) {
            joint.stands_on = joint.stands_on.map(moved);
        }
        robot.tip = self.tip.map(moved);
        let mounts = robot.mounted.iter_mut().chain(&mut robot.instruments);
        mounts.for_each(|mount: &mut Mount| mount.body = moved(mount.body));
        let weights = robot.gravity.iter_mut().flat_map(|gravity| &mut gravity.weights);
        weights.for_each(|weight: &mut Weight| weight.body = moved(weight.body));
        if let Some(gravity) = &mut robot.gravity {
            gravity.axes = axes(&robot.joints);
        }
        for term in &mut robot.terms {
            term.joint = places.get(term.joint).copied().unwrap_or(term.joint);
        }
        (robot, places)
    }
}

/// The gives of a joint of this index.
fn gives(joint: &Joint, index: usize) -> impl Iterator<Item = Joint> {
    let z = joint.screw.direction();
    let x = rotation::perpendicular(&z);
    let about = [("x", x), ("y", z.cross(&x)), ("z", z)];
    let count = match joint.kind {
        JointKind::Revolute => 2,
        JointKind::Prismatic => 3,
    };
    let origin = joint.frame.translation;
    let (name, frame, reading) = (joint.name.clone(), joint.frame, joint.reading.name.clone());
    about.into_iter().take(count).map(move |(axis, direction)| Joint {
        frame,
        reading: Reading { name: reading.clone(), multiplier: 0.0, offset: 0.0 },
        give_of: Some(index),
        ..Joint::with_screw(
            &format!("{name}~{axis}"),
            JointKind::Revolute,
            Screw::revolute(&direction, &origin),
        )
    })
}
