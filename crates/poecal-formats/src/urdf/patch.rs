//! Writes a calibrated robot into the text of the nominal one.

use std::collections::BTreeSet;

use nalgebra::Vector3;

use super::splice::{Splice, escape_attribute, format_triple};
use super::urdf_joints::UrdfJoint;
use super::{ChainSelection, UrdfDocument};
use poecal_arm::lie::{Pose, Screw, rotation};
use poecal_model::robot::{Joint, JointKind, Mount, Robot};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::numbers::{format_shortest, tidy_numbers};

/// Smaller differences (metres, or of rotation matrices) are rounding: the text stays.
const UNCHANGED: f64 = 1e-15;
/// An axis farther than this (metres, radians) from that of the joint's frame is rewritten.
const AXIS_TOLERANCE: f64 = 1e-13;

/// A URDF text with calibrated values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PatchedUrdf {
    /// The whole text.
    pub text: String,
    /// The link that is now the tip.
    pub tip_link: String,
    /// The selection that yields the robot from the text.
    pub selection: ChainSelection,
    /// Notes for the user, a sentence each.
    pub notes: Vec<String>,
}

impl UrdfDocument {
    /// The text with the origins (and axes, if needed) of `calibrated`; all other bytes stay.
    ///
    /// `calibrated` is this document's robot with other screws, joint frames, home pose, instruments and targets. Values that differ only by
    /// rounding stay. The tip's pose is written to the last fixed joint before the tip; without one, a link `<tip>_calibrated` is added. Frames of
    /// instruments and targets are written too, but never to a fixed joint above a moving one.
    ///
    /// # Errors
    /// [`ErrorKind::Export`] if `calibrated` has other joints, instruments or targets, or a number of it is not finite.
    pub fn patch(&self, calibrated: &Robot) -> Result<PatchedUrdf> {
        self.check_same_joints(calibrated)?;
        let wanted = self.end_poses(calibrated)?;
        let mut splice = Splice::new(&self.text);
        let mut joints = calibrated.joints.iter();
        let carried = self.carried_poses(&wanted);
        // Poses by the values of the new text, so that rounding does not accumulate along the chain.
        let mut base_from_links: Vec<Pose> = Vec::with_capacity(self.parts.len());
        for (part, carried) in self.parts.iter().zip(carried) {
            let base_from_parent = self.link_pose(&base_from_links, part.parent);
            let moving = part.axis.and_then(|axis| Some((axis, joints.next()?)));
            base_from_links.push(match (moving, carried) {
                (Some((axis, joint)), _) => write_joint(&mut splice, part, &axis, base_from_parent, joint),
                (None, Some(pose)) => write_origin(&mut splice, part, base_from_parent, &pose),
                (None, None) => base_from_parent * part.parent_from_joint,
            });
        }
        let mut added = AddedLinks { names: BTreeSet::new(), links: Vec::new() };
        let (mut links, mut notes) = (Vec::new(), self.changed_kinds(calibrated));
        for (index, (end, wanted)) in self.ends.iter().zip(&wanted).enumerate() {
            // Mounts on the base link itself, and not on a link fixed to it, have the identity as their link's pose.
            let is_base = end.part.is_none() && end.link == self.robot.base_name;
            let base_from_link = if is_base { Pose::identity() } else { self.link_pose(&base_from_links, end.part) };
            if are_close(&base_from_link, wanted) {
                links.push(end.link.clone());
                continue;
            }
            let known = added.links.iter().find(|(of, pose, _)| *of == end.link && are_close(pose, wanted));
            if let Some((_, _, name)) = known {
                links.push(name.clone());
                continue;
            }
            let Some(place) = end.part.map_or(self.parts.first(), |part| self.parts.get(part)) else {
                continue;
            };
            let name = self.free_name(&end.link, &added);
            let (xyz, rpy) = origin_values(&(base_from_link.inverse() * *wanted));
            splice.add_link(
                &place.place,
                &escape_attribute(&end.link),
                &escape_attribute(&name),
                &format_triple(xyz),
                &format_triple(rpy),
            );
            let what = self.end_words(index);
            notes.push(format!(
                "link `{name}` was added below `{}` to hold the calibrated {what}, since no fixed joint {}",
                end.link,
                if index == 0 { "follows the last moving one" } else { "of its own leads there" }
            ));
            links.push(name.clone());
            added.names.insert(name.clone());
            added.links.push((end.link.clone(), *wanted, name));
        }
        let links: Vec<&str> = links.iter().map(String::as_str).collect();
        let selection = ChainSelection::from_links(&self.robot, &links);
        let tip_link = selection.tip_link.clone().unwrap_or_default();
        Ok(PatchedUrdf { text: splice.apply(), tip_link, selection, notes })
    }

    /// Notes on joints that other readers would understand differently, and that are written otherwise.
    fn changed_kinds(&self, calibrated: &Robot) -> Vec<String> {
        let moving = self.parts.iter().filter(|it| it.axis.is_some()).zip(&calibrated.joints);
        let endless = moving.filter(|(part, joint)| is_made_continuous(part, joint)).map(|(part, _)| {
            format!("joint `{}` has no `lower` and `upper`, and was written as continuous", part.name)
        });
        let scaled = self.parts.iter().filter(|it| !it.has_unit_axis());
        let scaled = scaled.map(|it| format!("the axis of joint `{}` was written as a unit vector", it.name));
        endless.chain(scaled).collect()
    }

    /// `base_from_link` of each end at zero joint values.
    fn end_poses(&self, calibrated: &Robot) -> Result<Vec<Pose>> {
        let place = |mount: &Mount, among: &[Mount], what: &str| {
            let found = among.iter().find(|other| other.name == mount.name && other.body == mount.body);
            found.map(|found| calibrated.base_from(found)).ok_or_else(|| {
                self.other_robot_error(&format!("the calibrated robot has no {what} `{}` there", mount.name))
            })
        };
        let robot = &self.robot;
        let mut wanted = vec![calibrated.home];
        for (among, calibrated, what) in [
            (&robot.instruments, &calibrated.instruments, "instrument"),
            (&robot.mounted, &calibrated.mounted, "target"),
        ] {
            for mount in among {
                wanted.push(place(mount, calibrated, what)?);
            }
        }
        match wanted.iter().all(is_finite) {
            true => Ok(wanted),
            false => Err(self.other_robot_error("an instrument or a target is not at a finite place")),
        }
    }

    /// For each joint, the pose of the link below it, if the joint is fixed and holds an end: no moving joint follows it.
    fn carried_poses(&self, wanted: &[Pose]) -> Vec<Option<Pose>> {
        let mut leads = vec![false; self.parts.len()];
        for (index, part) in self.parts.iter().enumerate().rev() {
            let moves = part.axis.is_some() || leads.get(index).copied().unwrap_or(false);
            if let Some(above) = part.parent.and_then(|parent| leads.get_mut(parent)) {
                *above |= moves;
            }
        }
        let mut carried = vec![None; self.parts.len()];
        for (end, wanted) in self.ends.iter().zip(wanted) {
            let Some(part) = end.part.filter(|&part| !leads.get(part).copied().unwrap_or(true)) else {
                continue;
            };
            if let Some(carried) = carried.get_mut(part) {
                carried.get_or_insert(*wanted);
            }
        }
        carried
    }

    /// Name of an end: the tip, or an instrument or a target.
    fn end_words(&self, index: usize) -> String {
        let mounts = self.robot.instruments.iter().chain(&self.robot.mounted);
        match index.checked_sub(1).and_then(|index| mounts.into_iter().nth(index)) {
            Some(mount) => format!("frame of `{}`", mount.name),
            None => "tip".to_owned(),
        }
    }

    fn other_robot_error(&self, found: &str) -> Error {
        ErrorKind::Export.error(format!("{found}, expected the robot that was read from {}", self.path.display()))
    }

    fn check_same_joints(&self, calibrated: &Robot) -> Result<()> {
        let stands = |robot: &Robot| -> Vec<_> {
            let joints = robot.joints.iter().enumerate();
            joints.map(|(at, joint)| (joint.name.clone(), joint.kind, robot.body_before(at))).collect()
        };
        if stands(calibrated) != stands(&self.robot) || calibrated.tip_body() != self.robot.tip_body() {
            return Err(self.other_robot_error("the calibrated robot has other joints"));
        }
        for joint in &calibrated.joints {
            if !is_finite(&joint.frame) || !is_finite(&joint.screw.exp(0.0)) {
                return Err(self.other_robot_error(&format!("joint `{}` is not at a finite place", joint.name)));
            }
        }
        if !is_finite(&calibrated.home) {
            return Err(self.other_robot_error("the home pose is not at a finite place"));
        }
        Ok(())
    }

    /// A name of a link that is not in the text.
    fn free_name(&self, link: &str, added: &AddedLinks) -> String {
        let mut name = format!("{link}_calibrated");
        while self.text.contains(&escape_attribute(&name)) || added.names.contains(&name) {
            name.push('_');
        }
        name
    }
}

/// Links that were added, and their purpose: the parent link of each, and its pose in the base.
struct AddedLinks {
    names: BTreeSet<String>,
    links: Vec<(String, Pose, String)>,
}

fn is_finite(pose: &Pose) -> bool {
    pose.rotation.iter().chain(pose.translation.iter()).all(|number| number.is_finite())
}

/// Writes a moving joint's origin, and its axis if it is not that of the frame. Returns the frame by the numbers of the text.
fn write_joint(
    splice: &mut Splice,
    part: &UrdfJoint,
    axis: &Vector3<f64>,
    base_from_link: Pose,
    joint: &Joint,
) -> Pose {
    let frame = frame_on_axis(&joint.frame, &joint.screw);
    let written = write_origin(splice, part, base_from_link, &frame);
    let direction = written.rotation.transpose() * joint.screw.direction();
    if (direction - axis).norm() > AXIS_TOLERANCE || !part.has_unit_axis() {
        splice.set_axis(&part.place, format_triple(tidy_numbers(direction.into())));
    }
    if is_made_continuous(part, joint) {
        splice.set_kind(&part.place, "continuous");
    }
    written
}

/// True if a joint without a range is written as one that rotates without limits.
fn is_made_continuous(part: &UrdfJoint, joint: &Joint) -> bool {
    part.is_without_range && joint.kind == JointKind::Revolute && joint.limits.is_none()
}

/// The frame with its origin shifted onto the axis, unless it is on it.
pub(crate) fn frame_on_axis(frame: &Pose, screw: &Screw) -> Pose {
    let on_axis = screw.nearest_point(&frame.translation);
    if (on_axis - frame.translation).norm() > AXIS_TOLERANCE { Pose::new(frame.rotation, on_axis) } else { *frame }
}

/// Writes the changed parts of an origin so that the frame is at `target`. Returns the frame by the numbers of the text.
fn write_origin(splice: &mut Splice, part: &UrdfJoint, base_from_link: Pose, target: &Pose) -> Pose {
    let unchanged = base_from_link * part.parent_from_joint;
    if are_close(&unchanged, target) {
        return unchanged;
    }
    let wanted = base_from_link.inverse() * *target;
    let (xyz, rpy) = origin_values(&wanted);
    let mut written = part.parent_from_joint;
    let moved = (wanted.translation - written.translation).amax() > UNCHANGED;
    let turned = (wanted.rotation - written.rotation).amax() > UNCHANGED;
    if moved {
        written.translation = Vector3::from(xyz);
    }
    if turned {
        written.rotation = match part.place.is_quaternion {
            true => wanted.rotation,
            false => rotation::from_rpy(rpy[0], rpy[1], rpy[2]),
        };
    }
    let turn = |()| match part.place.is_quaternion {
        true => wanted.quaternion_xyzw().map(format_shortest).join(" "),
        false => format_triple(rpy),
    };
    splice.set_origin(&part.place, moved.then(|| format_triple(xyz)), turned.then_some(()).map(turn));
    base_from_link * written
}

/// `xyz` and `rpy` of an origin.
pub fn origin_values(pose: &Pose) -> ([f64; 3], [f64; 3]) {
    (tidy_numbers(pose.translation.into()), tidy_numbers(rotation::to_rpy(&pose.rotation)))
}

fn are_close(a: &Pose, b: &Pose) -> bool {
    (a.translation - b.translation).amax() < UNCHANGED && (a.rotation - b.rotation).amax() < UNCHANGED
}
