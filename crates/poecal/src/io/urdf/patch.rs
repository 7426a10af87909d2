//! Writes a calibrated robot into the text of the nominal one.

use nalgebra::Vector3;

use super::UrdfDocument;
use super::parts::{Part, Place};
use super::splice::{Splice, escaped, triple};
use crate::error::{Error, ErrorKind, Result};
use crate::io::numbers::tidy;
use crate::lie::{Pose, Screw, rotation};
use crate::robot::{Joint, Robot};

/// Smaller differences (metres, or of rotation matrices) are rounding: the text stays.
const UNCHANGED: f64 = 1e-15;
/// An axis farther than this (metres, radians) from that of the joint's frame is rewritten.
const AXIS_TOLERANCE: f64 = 1e-13;

/// A URDF text with calibrated values.
///
/// ```
/// use poecal::io::urdf::{ChainSelection, UrdfDocument};
/// let text = r#"<robot name="one_axis">
///   <link name="base"/> <link name="arm"/>
///   <joint name="turn" type="continuous"><parent link="base"/><child link="arm"/></joint>
/// </robot>"#;
/// let urdf = UrdfDocument::parse(text, "one_axis.urdf", &ChainSelection::default())?;
/// let mut calibrated = urdf.robot().clone();
/// calibrated.home.translation.z = 0.1;
/// let patched = urdf.patched(&calibrated)?;
/// // There was no fixed joint to hold the tool's offset, so one was added.
/// assert_eq!(patched.tip_link, "arm_calibrated");
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PatchedUrdf {
    /// The whole text.
    pub text: String,
    /// The link that is now the tip.
    pub tip_link: String,
    /// Notes for the user, a sentence each.
    pub notes: Vec<String>,
}

impl UrdfDocument {
    /// The text with the origins (and axes, where needed) of `calibrated`; all other bytes stay.
    ///
    /// `calibrated` is this document's robot with other screws, joint frames and home pose. Values that differ only by rounding stay. The
    /// tip's pose is written to the last fixed joint before the tip; without one, a link `<tip>_calibrated` is added.
    ///
    /// # Errors
    /// [`ErrorKind::Export`] if `calibrated` has other joints, or a number of it is not finite.
    pub fn patched(&self, calibrated: &Robot) -> Result<PatchedUrdf> {
        self.check_same_joints(calibrated)?;
        let mut splice = Splice::new(&self.text);
        let mut joints = calibrated.joints.iter();
        // Values as the new text has them, so that rounding does not add up along the chain.
        let mut base_from_link = Pose::identity();
        let last = self.parts.len().saturating_sub(1);
        for (index, part) in self.parts.iter().enumerate() {
            let moving = part.axis.and_then(|axis| Some((axis, joints.next()?)));
            base_from_link = match moving {
                Some((axis, joint)) => write_joint(&mut splice, part, &axis, base_from_link, joint),
                None if index == last => write_origin(&mut splice, part, base_from_link, &calibrated.home),
                None => base_from_link * part.parent_from_joint,
            };
        }
        let mut tip_link = self.robot.tip_name.clone();
        let mut notes = Vec::new();
        if let Some(part) = self.parts.last()
            && !close(&base_from_link, &calibrated.home)
        {
            let link_from_tip = base_from_link.inverse() * calibrated.home;
            tip_link = self.add_tip(&mut splice, &part.place, &link_from_tip);
            notes.push(format!(
                "link `{tip_link}` was added below `{}` to hold the calibrated tip, since no fixed joint follows the last moving one",
                self.robot.tip_name
            ));
        }
        Ok(PatchedUrdf { text: splice.apply(), tip_link, notes })
    }

    fn check_same_joints(&self, calibrated: &Robot) -> Result<()> {
        let error = |found: String| {
            let message = format!("{found}, expected the robot that was read from {}", self.path.display());
            Err(Error::new(ErrorKind::Export, message))
        };
        let names = |robot: &Robot| robot.joints.iter().map(|j| (j.name.clone(), j.kind)).collect::<Vec<_>>();
        if names(calibrated) != names(&self.robot) {
            return error("the calibrated robot has other joints".to_owned());
        }
        let finite = |pose: &Pose| {
            pose.rotation.iter().chain(pose.translation.iter()).all(|number| number.is_finite())
        };
        for joint in &calibrated.joints {
            if !finite(&joint.frame) || !finite(&joint.screw.exp(0.0)) {
                return error(format!("joint `{}` is not at a finite place", joint.name));
            }
        }
        if !finite(&calibrated.home) {
            return error("the home pose is not at a finite place".to_owned());
        }
        Ok(())
    }

    fn add_tip(&self, splice: &mut Splice, after: &Place, link_from_tip: &Pose) -> String {
        let mut name = format!("{}_calibrated", self.robot.tip_name);
        while self.text.contains(&escaped(&name)) {
            name.push('_');
        }
        let (xyz, rpy) = origin_values(link_from_tip);
        splice.add_link(after, &escaped(&self.robot.tip_name), &escaped(&name), &triple(xyz), &triple(rpy));
        name
    }
}

/// Writes a moving joint's origin, and its axis if it is not that of the frame. Returns its frame as in the text.
fn write_joint(
    splice: &mut Splice,
    part: &Part,
    axis: &Vector3<f64>,
    base_from_link: Pose,
    joint: &Joint,
) -> Pose {
    let frame = frame_on_axis(&joint.frame, &joint.screw);
    let written = write_origin(splice, part, base_from_link, &frame);
    let direction = written.rotation.transpose() * joint.screw.direction();
    if (direction - axis).norm() > AXIS_TOLERANCE {
        splice.set_axis(&part.place, triple(tidy(direction.into())));
    }
    written
}

/// The frame with its origin shifted onto the axis, if it is off it.
pub(super) fn frame_on_axis(frame: &Pose, screw: &Screw) -> Pose {
    let on_axis = screw.nearest_point(&frame.translation);
    if (on_axis - frame.translation).norm() > AXIS_TOLERANCE {
        Pose::new(frame.rotation, on_axis)
    } else {
        *frame
    }
}

/// Writes the changed parts of an origin so that the frame is at `target`. Returns the frame as in the text.
fn write_origin(splice: &mut Splice, part: &Part, base_from_link: Pose, target: &Pose) -> Pose {
    let unchanged = base_from_link * part.parent_from_joint;
    if close(&unchanged, target) {
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
        written.rotation = rotation::from_rpy(rpy[0], rpy[1], rpy[2]);
    }
    splice.set_origin(&part.place, moved.then(|| triple(xyz)), turned.then(|| triple(rpy)));
    base_from_link * written
}

/// `xyz` and `rpy` of an origin.
pub(super) fn origin_values(pose: &Pose) -> ([f64; 3], [f64; 3]) {
    (tidy(pose.translation.into()), tidy(rotation::to_rpy(&pose.rotation)))
}

fn close(a: &Pose, b: &Pose) -> bool {
    (a.translation - b.translation).amax() < UNCHANGED && (a.rotation - b.rotation).amax() < UNCHANGED
}
