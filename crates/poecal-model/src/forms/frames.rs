//! Frames with z along each joint's axis.

use nalgebra::Vector3;

use crate::robot::{Joint, JointKind, JointLimits, Robot};
use poecal_arm::lie::{Pose, rotation};
use poecal_numerics::error::{ErrorKind, Result};

/// Angle between a frame's z and its axis below which no turn is needed.
const ALONG: f64 = 1e-13;
/// Share of the reach beyond which a frame is far along its axis from the frame before.
const FAR: f64 = 0.5;

/// A serial robot by frames with z along each axis: a joint rotates about it, or slides along it. The motion from the base to the tip
/// is `T = A₁ Z(q₁) A₂ Z(q₂) … Aₙ Z(qₙ) E`, with `Z(q) = Rz(q)` or `Tz(q)`.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisFrames {
    /// Frame of each joint in that of the joint before, of the first in the base, at zero.
    pub joints: Vec<Pose>,
    /// The tip in the frame of the last joint.
    pub last_from_tip: Pose,
}

impl AxisFrames {
    /// Frames of a robot: its own joint frames, shifted onto their axes, and turned least if z is not along the axis. Offsets of readings are
    /// absorbed.
    ///
    /// # Errors
    /// [`ErrorKind::Export`] if the robot is no chain of joints, each with a reading of its own.
    pub fn from_robot(robot: &Robot) -> Result<Self> {
        if let Some(joint) = robot.joints.iter().find(|it| robot.leader(it).is_some()) {
            return refuse(&format!("found joint `{}`, which follows `{}`", joint.name, joint.reading.name));
        }
        Self::with_followers(robot)
    }

    /// The same frames for a robot whose joints may follow others of the chain: the offsets of these stay in their readings.
    ///
    /// # Errors
    /// [`ErrorKind::Export`] if the robot is no chain of joints, each with a reading of its own or that of another joint.
    pub fn with_followers(robot: &Robot) -> Result<Self> {
        refuse_coupled(robot)?;
        let mut before = Pose::identity();
        let mut joints = Vec::with_capacity(robot.joints.len());
        let reach_m = robot.reach_m();
        for joint in &robot.joints {
            let mut frame = along_axis(joint);
            let nearest = joint.screw.nearest_point(&before.translation);
            // A table of nearly parallel axes has frames far away.
            let apart_m = (frame.translation - nearest).norm();
            if joint.kind == JointKind::Revolute && apart_m > FAR * reach_m {
                frame.translation = nearest;
            }
            // At a reading of zero the joint is at the offset.
            let offset = if robot.leader(joint).is_some() { 0.0 } else { joint.reading.offset };
            joints.push(before.inverse() * frame * motion(joint.kind, offset));
            before = frame;
        }
        Ok(AxisFrames { joints, last_from_tip: before.inverse() * robot.home })
    }

    /// Moves the last joint's frame along its axis, and turns it about that, to the pose nearest to the tip's: drivers take it for the
    /// flange.
    pub fn end_at_tip(&mut self) {
        if let Some(last) = self.joints.last_mut() {
            let tip = &self.last_from_tip;
            let turn = (tip.rotation[(1, 0)] - tip.rotation[(0, 1)]).atan2(tip.rotation[(0, 0)] + tip.rotation[(1, 1)]);
            let along = Pose::new(rotation::about(2, turn), Vector3::new(0.0, 0.0, tip.translation.z));
            *last = *last * along;
            self.last_from_tip = along.inverse() * self.last_from_tip;
        }
    }

    /// Names, kinds and limits of a robot with these frames.
    ///
    /// # Errors
    /// As [`Robot::new`].
    pub fn robot(&self, of: &Robot) -> Result<Robot> {
        let mut base_from = Pose::identity();
        let mut joints = Vec::with_capacity(self.joints.len());
        for (joint, frame) in of.joints.iter().zip(&self.joints) {
            base_from = base_from * *frame;
            let z = base_from.rotation.column(2).into_owned();
            let screw = joint.kind.screw(&z, &base_from.translation);
            let mut own = Joint::with_screw(&joint.name, joint.kind, screw);
            own.frame = base_from;
            if of.leader(joint).is_some() {
                (own.limits, own.reading) = (joint.limits, joint.reading.clone());
            } else {
                // The new zero is the old reading's.
                let by = joint.reading.offset;
                own.limits = joint.limits.map(|it| JointLimits { lower: it.lower - by, upper: it.upper - by });
                own.reading.name.clone_from(&joint.reading.name);
            }
            joints.push(own);
        }
        let mut robot = Robot::new(&of.name, joints, base_from * self.last_from_tip)?;
        (robot.base_name, robot.tip_name) = (of.base_name.clone(), of.tip_name.clone());
        Ok(robot)
    }
}

/// `Rz(q)` or `Tz(q)`.
fn motion(kind: JointKind, value: f64) -> Pose {
    match kind {
        JointKind::Revolute => Pose::new(rotation::about(2, value), Vector3::zeros()),
        JointKind::Prismatic => Pose::from_translation(Vector3::z() * value),
    }
}

/// Frame of the joint with its origin on the axis and z along it.
pub(crate) fn along_axis(joint: &Joint) -> Pose {
    let Pose { rotation: turn, translation } = joint.frame;
    let origin = match joint.kind {
        JointKind::Revolute => joint.screw.nearest_point(&translation),
        JointKind::Prismatic => translation,
    };
    let (z, direction) = (turn.column(2).into_owned(), joint.screw.direction());
    let least = if (z - direction).norm() > ALONG { rotation::shortest_arc(&z, &direction) * turn } else { turn };
    Pose::new(least, origin)
}

fn refuse<T>(found: &str) -> Result<T> {
    ErrorKind::Export.refuse(format!(
        "{found}, expected a chain of joints, each with a reading of its own: URDF, MJCF, SDF, TOML and calibration.json hold others"
    ))
}

/// Refuses robots that frames alone cannot represent.
fn refuse_coupled(robot: &Robot) -> Result<()> {
    if !robot.is_serial() {
        return refuse("found a robot with branches");
    }
    let own = || robot.joints.iter().filter(|it| robot.leader(it).is_none());
    if let Some(joint) = own().find(|it| it.reading.multiplier != 1.0) {
        return refuse(&format!("found joint `{}`, which moves by a multiple of its reading", joint.name));
    }
    let mut names: Vec<&str> = own().map(|it| it.reading.name.as_str()).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => refuse(&format!("found two joints that are read by `{}`", pair[0])),
        None => Ok(()),
    }
}
