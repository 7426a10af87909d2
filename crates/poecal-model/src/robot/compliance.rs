//! Joints with compliant bearings and links.

use nalgebra::Vector3;

use super::gravity::axes;
use super::{Body, Joint, JointKind, Mount, Reading, Robot, Weight};
use poecal_arm::lie::{Screw, rotation};

/// Compliant directions of links and bearings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CompliantDirections {
    /// Tilts.
    #[default]
    Tilting,
    /// Tilts, and shifts along three axes.
    All,
}

impl Robot {
    /// The same robot with compliant joints and links. Behind each of these joints there are compliant joints about two axes across its own
    /// through its pivot ([`Robot::pivots`]). A prismatic joint also has one about its own; with [`CompliantDirections::All`] there are three more along
    /// three axes. A compliant joint is at zero, and moves by its terms alone (theory.md §3, *Gives*). The second result has the new index of
    /// each of the robot's joints.
    #[must_use]
    pub fn with_compliance(&self, joints: &[usize], directions: CompliantDirections) -> (Robot, Vec<usize>) {
        let mut robot = self.clone();
        robot.joints.clear();
        let (mut places, mut ends) = (Vec::new(), Vec::new());
        let pivots = self.pivots();
        for (index, joint) in self.joints.iter().enumerate() {
            places.push(robot.joints.len());
            robot.joints.push(joint.clone());
            if joints.contains(&index) {
                let own = robot.joints.len() - 1;
                robot.joints.extend(gives(joint, own, pivots[index], directions));
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
        robot.masses.iter_mut().for_each(|mass| mass.body = moved(mass.body));
        let of_all = axes(&robot);
        if let Some(gravity) = &mut robot.gravity {
            gravity.axes = of_all;
        }
        for term in &mut robot.terms {
            let place = |joint: usize| places.get(joint).copied().unwrap_or(joint);
            (term.joint, term.term) = (place(term.joint), term.term.reindex(place));
        }
        (robot, places)
    }
}

impl Robot {
    /// The same robot without compliant joints and their terms, and without weights and the terms that need them.
    #[must_use]
    pub fn rigid(&self) -> Robot {
        let mut robot = self.clone();
        let is_own = |joint: usize| self.joints.get(joint).is_some_and(|it| it.give_of.is_none());
        // The joint that remains for a link, and its index among the remaining ones.
        let left = |joint: usize| (0..joint).filter(|&it| is_own(it)).count();
        let own = |joint: usize| self.joints.get(joint).and_then(|it| it.give_of).unwrap_or(joint);
        let moved = |body: Body| match body {
            Body::Base => Body::Base,
            Body::Link(joint) => Body::Link(left(own(joint))),
        };
        robot.joints.retain(|joint| joint.give_of.is_none());
        robot.joints.iter_mut().for_each(|joint| joint.stands_on = joint.stands_on.map(moved));
        robot.tip = self.tip.map(moved);
        let mounts = robot.mounted.iter_mut().chain(&mut robot.instruments);
        mounts.for_each(|mount: &mut Mount| mount.body = moved(mount.body));
        robot.masses.iter_mut().for_each(|mass| mass.body = moved(mass.body));
        robot.gravity = None;
        robot.terms.retain(|it| is_own(it.joint) && !it.term.needs_gravity());
        robot.terms.iter_mut().for_each(|it| (it.joint, it.term) = (left(it.joint), it.term.reindex(left)));
        robot
    }
}

/// Compliant joints of a joint of this index, through a pivot.
fn gives(
    joint: &Joint,
    index: usize,
    pivot: Vector3<f64>,
    directions: CompliantDirections,
) -> impl Iterator<Item = Joint> {
    let z = joint.screw.direction();
    let x = rotation::perpendicular_to(&z);
    let axes = [("x", x), ("y", z.cross(&x)), ("z", z)];
    let turning = match joint.kind {
        JointKind::Revolute => 2,
        JointKind::Prismatic => 3,
    };
    let sliding = match directions {
        CompliantDirections::Tilting => 0,
        CompliantDirections::All => 3,
    };
    let about = axes
        .into_iter()
        .take(turning)
        .map(move |(axis, direction)| (axis.to_owned(), JointKind::Revolute, Screw::revolute(&direction, &pivot)));
    let along = axes
        .into_iter()
        .take(sliding)
        .map(|(axis, direction)| (format!("along_{axis}"), JointKind::Prismatic, Screw::prismatic(&direction)));
    let (name, frame, reading) = (joint.name.clone(), joint.frame, joint.reading.name.clone());
    about.chain(along).map(move |(direction, kind, screw)| Joint {
        frame,
        reading: Reading { name: reading.clone(), multiplier: 0.0, offset: 0.0 },
        give_of: Some(index),
        ..Joint::with_screw(&format!("{name}~{direction}"), kind, screw)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::tests::elbow;

    #[test]
    fn gives_without_terms_leave_the_robot_as_it_is() {
        let robot = elbow();
        let (giving, places) = robot.with_compliance(&[1], CompliantDirections::Tilting);
        assert_eq!((giving.joints.len(), &places[..3]), (8, &[0, 1, 4][..]));
        assert_eq!(robot.with_compliance(&[1], CompliantDirections::All).0.joints.len(), 11);
        assert_eq!(giving.forward_kinematics(&[0.3; 6]), robot.forward_kinematics(&[0.3; 6]));
        assert_eq!(robot.with_compliance(&[0, 3], CompliantDirections::All).0.rigid(), robot);
    }
}
