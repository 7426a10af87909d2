//! A new, minimal URDF of any robot: links without shape, the moving joints, and fixed joints to the tip and to instruments and targets.

use std::fmt::Write;

use super::ChainSelection;
use super::patch::{frame_on_axis, origin_values};
use super::splice::{escape_attribute, format_triple};
use poecal_arm::lie::Pose;
use poecal_model::robot::{Body, Joint, JointKind, JointLimits, MEASURED, Robot};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::numbers::{format_shortest, tidy_numbers};

/// A model in another form.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConvertedModel {
    /// The whole text.
    pub text: String,
    /// Losses and additions, a sentence each.
    pub notes: Vec<String>,
}

/// Limits of a prismatic joint without limits, metres: URDF requires some.
pub(crate) const WIDE_LIMITS: JointLimits = JointLimits { lower: -1000.0, upper: 1000.0 };

/// Writes a robot as a new URDF: base link, one link for each joint, and the tip on a fixed joint. Instruments, and targets with a body of their
/// own, are links on fixed joints too.
///
/// # Errors
/// [`ErrorKind::Export`] if URDF cannot express a joint's reading (a factor or offset on its own reading).
pub fn write_new(robot: &Robot) -> Result<ConvertedModel> {
    written_new(robot).map(|(converted, _)| converted)
}

/// Writes it, and returns the selection that yields the robot from the text.
pub fn written_new(robot: &Robot) -> Result<(ConvertedModel, ChainSelection)> {
    let text = UrdfText::of_robot(&robot.name);
    let mut writer = UrdfWriter { text, notes: Vec::new(), links: vec![robot.tip_name.clone()] };
    let base = writer.link(&robot.base_name);
    writer.leaders(robot, &base);
    // Name of each joint's link, and its pose by the numbers of the text.
    let mut links: Vec<(String, Pose)> = Vec::with_capacity(robot.joints.len());
    let of = |links: &[(String, Pose)], body: Body| {
        let link = body.joint().and_then(|joint| links.get(joint)).cloned();
        link.unwrap_or_else(|| (base.clone(), Pose::identity()))
    };
    for (index, joint) in robot.joints.iter().enumerate() {
        let (parent, base_from_link) = of(&links, robot.body_before(index));
        let frame = frame_on_axis(&joint.frame, &joint.screw);
        let child = writer.link(&format!("{}_link", joint.name));
        let origin = base_from_link.inverse() * frame;
        let base_from_link = base_from_link * writer.joint(joint, (&parent, &child), &origin)?;
        links.push((child, base_from_link));
    }
    let mut mounted: Vec<String> = Vec::new();
    let mut mount_name = |link: &str| {
        let mut mount = format!("{link}_mount");
        while robot.joints.iter().any(|joint| joint.name == mount || joint.reading.name == mount)
            || mounted.contains(&mount)
        {
            mount.push('_');
        }
        mounted.push(mount.clone());
        mount
    };
    let mut fix = |text: &mut UrdfText, body: Body, link: &str, base_from_end: Pose| {
        let (parent, base_from_link) = of(&links, body);
        text.open_joint(&mount_name(link), "fixed", (&parent, link));
        text.origin(2, &(base_from_link.inverse() * base_from_end));
        text.close_joint();
    };
    writer.text.link(&robot.tip_name);
    fix(&mut writer.text, robot.tip_body(), &robot.tip_name, robot.home);
    let mut ends = vec![robot.tip_name.clone()];
    for mount in robot.instruments.iter().chain(&robot.mounted) {
        let link = writer.link(&mount.name);
        fix(&mut writer.text, mount.body, &link, robot.base_from(mount));
        ends.push(link);
    }
    if robot.targets.iter().any(|(name, _)| name != MEASURED) {
        writer.notes.push("targets are not part of a URDF and were left out".to_owned());
    }
    if !robot.masses.is_empty() {
        writer.notes.push("masses without inertia are not part of a URDF and were left out".to_owned());
    }
    let ends: Vec<&str> = ends.iter().map(String::as_str).collect();
    let selection = ChainSelection::from_links(robot, &ends);
    Ok((ConvertedModel { text: writer.text.finish(), notes: writer.notes }, selection))
}

/// The text of a URDF, line by line.
pub(crate) struct UrdfText(String);

impl UrdfText {
    /// The first lines of a robot.
    pub(crate) fn of_robot(name: &str) -> Self {
        UrdfText(format!("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n", escape_attribute(name)))
    }

    pub(crate) fn line(&mut self, depth: usize, line: &str) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.0, "{:width$}{line}", "", width = 2 * depth);
    }

    pub(crate) fn link(&mut self, name: &str) {
        self.line(1, &format!("<link name=\"{}\"/>", escape_attribute(name)));
    }

    /// Writes an origin, and returns it by the numbers of the text.
    pub(crate) fn origin(&mut self, depth: usize, pose: &Pose) -> Pose {
        let (xyz, rpy) = origin_values(pose);
        self.line(depth, &format!("<origin xyz=\"{}\" rpy=\"{}\"/>", format_triple(xyz), format_triple(rpy)));
        Pose::from_xyz_rpy(xyz, rpy)
    }

    /// Begins a joint from a parent to a child.
    pub(crate) fn open_joint(&mut self, name: &str, kind: &str, (parent, child): (&str, &str)) {
        self.line(1, &format!("<joint name=\"{}\" type=\"{kind}\">", escape_attribute(name)));
        self.line(2, &format!("<parent link=\"{}\"/>", escape_attribute(parent)));
        self.line(2, &format!("<child link=\"{}\"/>", escape_attribute(child)));
    }

    pub(crate) fn axis(&mut self, axis: [f64; 3]) {
        self.line(2, &format!("<axis xyz=\"{}\"/>", format_triple(axis)));
    }

    pub(crate) fn limits(&mut self, limits: JointLimits) {
        let limits = format!("lower=\"{}\" upper=\"{}\"", format_shortest(limits.lower), format_shortest(limits.upper));
        self.line(2, &format!("<limit {limits} effort=\"0\" velocity=\"0\"/>"));
    }

    pub(crate) fn mimic(&mut self, joint: &str, multiplier: f64, offset: f64) {
        let (joint, multiplier, offset) =
            (escape_attribute(joint), format_shortest(multiplier), format_shortest(offset));
        self.line(2, &format!("<mimic joint=\"{joint}\" multiplier=\"{multiplier}\" offset=\"{offset}\"/>"));
    }

    pub(crate) fn close_joint(&mut self) {
        self.line(1, "</joint>");
    }

    /// The whole text.
    pub(crate) fn finish(mut self) -> String {
        self.line(0, "</robot>");
        self.0
    }
}

struct UrdfWriter {
    text: UrdfText,
    notes: Vec<String>,
    links: Vec<String>,
}

impl UrdfWriter {
    /// Writes a link with a free name, and returns the name.
    fn link(&mut self, wanted: &str) -> String {
        let mut name = wanted.to_owned();
        while self.links.contains(&name) {
            name.push('_');
        }
        self.links.push(name.clone());
        self.text.link(&name);
        name
    }

    fn limits(&mut self, limits: JointLimits) {
        self.text.limits(limits);
        let note = "effort and velocity limits are not known and were written as 0, since URDF demands them";
        if !self.notes.iter().any(|known| known == note) {
            self.notes.push(note.to_owned());
        }
    }

    /// Range of a joint without limits of its own.
    fn wide_limit(&mut self, name: &str) {
        self.limits(WIDE_LIMITS);
        self.notes.push(format!(
            "joint `{name}` has no limits; URDF demands them of a prismatic joint, so ±{} m were written",
            WIDE_LIMITS.upper
        ));
    }

    /// Leaders of mimic joints outside the chain, as joints beside it.
    fn leaders(&mut self, robot: &Robot, base: &str) {
        for name in robot.reading_names() {
            let Some(follower) = robot.joints.iter().find(|joint| joint.reading.name == name) else {
                continue;
            };
            if robot.joints.iter().any(|joint| joint.name == name) {
                continue;
            }
            let child = self.link(&format!("{name}_link"));
            match follower.kind {
                JointKind::Revolute => self.text.open_joint(&name, "continuous", (base, &child)),
                JointKind::Prismatic => {
                    self.text.open_joint(&name, "prismatic", (base, &child));
                    self.wide_limit(&name);
                }
            }
            self.text.close_joint();
            self.notes.push(format!(
                "joint `{name}` leads mimic joints from beside the chain; it was added at `{base}` to carry the reading only"
            ));
        }
    }

    /// Writes a moving joint, and returns its origin by the numbers of the text.
    fn joint(&mut self, joint: &Joint, ends: (&str, &str), origin: &Pose) -> Result<Pose> {
        let kind = match (joint.kind, joint.limits) {
            (JointKind::Prismatic, _) => "prismatic",
            (JointKind::Revolute, Some(_)) => "revolute",
            (JointKind::Revolute, None) => "continuous",
        };
        self.text.open_joint(&joint.name, kind, ends);
        let origin = self.text.origin(2, origin);
        let direction = joint.frame.rotation.transpose() * joint.screw.direction();
        self.text.axis(tidy_numbers(direction.into()));
        match (joint.limits, joint.kind) {
            (Some(limits), _) => self.limits(limits),
            (None, JointKind::Prismatic) => self.wide_limit(&joint.name),
            (None, JointKind::Revolute) => {}
        }
        let reading = &joint.reading;
        if reading.name != joint.name {
            self.text.mimic(&reading.name, reading.multiplier, reading.offset);
        } else if reading.multiplier != 1.0 || reading.offset != 0.0 {
            return ErrorKind::Export.refuse(format!(
                "joint `{}` has a factor or an offset on its own reading, expected factor 1 and offset 0: URDF has them for mimic joints only",
                joint.name
            ));
        }
        self.text.close_joint();
        Ok(origin)
    }
}
