//! Links and joints, and the equivalent URDF.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Unit, Vector3};

use crate::urdf::{UrdfText, WIDE_LIMITS, escape_attribute};
use poecal_arm::lie::{Pose, rotation};
use poecal_model::robot::JointLimits;
use poecal_storage::numbers::format_shortest;

/// A tree of links.
#[derive(Default)]
pub(crate) struct LinkTree {
    name: String,
    links: Vec<(String, Option<Inertial>)>,
    names: LinkNames,
    joint_names: LinkNames,
    pub(crate) joints: Vec<LinkJoint>,
    /// Contents of the file that are not read, a sentence.
    pub(crate) unread: Option<String>,
}

/// Names in use: those of the file, from the beginning, and those that were added.
#[derive(Default)]
struct LinkNames {
    of_file: BTreeSet<String>,
    used: BTreeSet<String>,
    made: BTreeMap<String, usize>,
}

impl LinkNames {
    /// A name of the file, or another one if it was used.
    fn claim_name(&mut self, name: &str) -> String {
        if self.used.insert(name.to_owned()) { name.to_owned() } else { self.free_name(name) }
    }

    /// A name that is not in use: the wanted one, or with a number at its end.
    fn free_name(&mut self, wanted: &str) -> String {
        let count = self.made.entry(wanted.to_owned()).or_default();
        let mut name = wanted.to_owned();
        while self.of_file.contains(&name) || self.used.contains(&name) {
            *count += 1;
            name = format!("{wanted}_{count}");
        }
        self.used.insert(name.clone());
        name
    }
}

/// A mass with its centre.
#[derive(Clone, Copy)]
pub(crate) struct Inertial {
    /// Its frame in the link.
    pub(crate) pose: Pose,
    pub(crate) kg: f64,
}

/// A joint between two links.
pub(crate) struct LinkJoint {
    pub(crate) name: String,
    pub(crate) kind: LinkJointKind,
    pub(crate) parent: String,
    pub(crate) child: String,
    /// The child's frame in the parent's, at zero.
    pub(crate) parent_from_child: Pose,
    pub(crate) axis: Unit<Vector3<f64>>,
    pub(crate) limits: Option<JointLimits>,
    pub(crate) mimic: Option<Mimic>,
}

/// Kind of motion of a joint in URDF.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum LinkJointKind {
    Fixed,
    Turns,
    Slides,
    /// More than one degree of freedom.
    Free,
}

impl LinkJointKind {
    /// The motion by a value; `None` for a joint that is fixed or has several degrees of freedom.
    pub(crate) fn motion(self, axis: &Unit<Vector3<f64>>, value: f64) -> Option<Pose> {
        let along = axis.into_inner() * value;
        match self {
            LinkJointKind::Turns => Some(Pose::new(rotation::exp(&along), Vector3::zeros())),
            LinkJointKind::Slides => Some(Pose::from_translation(along)),
            LinkJointKind::Fixed | LinkJointKind::Free => None,
        }
    }
}

/// The joint that another one follows: `q = multiplier q' + offset`.
pub(crate) struct Mimic {
    pub(crate) joint: String,
    pub(crate) multiplier: f64,
    pub(crate) offset: f64,
}

impl LinkTree {
    pub(crate) fn new(name: &str) -> Self {
        LinkTree { name: name.to_owned(), ..LinkTree::default() }
    }

    /// Reserves the names of the file's links and joints, so that added ones differ.
    pub(crate) fn keep_names(&mut self, links: BTreeSet<String>, joints: BTreeSet<String>) {
        self.names.of_file = links;
        self.joint_names.of_file = joints;
    }

    /// Adds a link of the file; returns its name, which is another one if there is a link of that name already.
    pub(crate) fn add(&mut self, name: &str, inertial: Option<Inertial>) -> String {
        let name = self.names.claim_name(name);
        self.links.push((name.clone(), inertial));
        name
    }

    /// Adds a link that the file does not name.
    pub(crate) fn add_unnamed(&mut self, wanted: &str, inertial: Option<Inertial>) -> String {
        let name = self.names.free_name(wanted);
        self.links.push((name.clone(), inertial));
        name
    }

    /// True if there is, or will be, a link of this name.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.names.of_file.contains(name) || self.names.used.contains(name)
    }

    /// The name of a joint of the file, or one for a joint without.
    pub(crate) fn joint_name(&mut self, stated: Option<&str>, wanted: &str) -> String {
        match stated {
            Some(name) => self.joint_names.claim_name(name),
            None => self.joint_names.free_name(wanted),
        }
    }

    /// Fixes a link to another one.
    pub(crate) fn fix(&mut self, parent: &str, child: &str, parent_from_child: Pose) {
        let name = self.joint_names.free_name(&format!("{child}_mount"));
        let ends = (parent.to_owned(), child.to_owned());
        self.joints.push(LinkJoint::new(name, LinkJointKind::Fixed, ends, parent_from_child));
    }

    /// The URDF.
    pub(crate) fn urdf(&self) -> String {
        let mut text = UrdfText::of_robot(&self.name);
        for (name, inertial) in &self.links {
            let Some(Inertial { pose, kg }) = inertial else {
                text.link(name);
                continue;
            };
            text.line(1, &format!("<link name=\"{}\">", escape_attribute(name)));
            text.line(2, "<inertial>");
            text.origin(3, pose);
            text.line(3, &format!("<mass value=\"{}\"/>", format_shortest(*kg)));
            text.line(2, "</inertial>");
            text.line(1, "</link>");
        }
        self.joints.iter().for_each(|joint| joint.push(&mut text));
        text.finish()
    }
}

impl LinkJoint {
    /// A joint about or along z, without limits.
    pub(crate) fn new(
        name: String,
        kind: LinkJointKind,
        (parent, child): (String, String),
        parent_from_child: Pose,
    ) -> Self {
        let axis = Vector3::z_axis();
        LinkJoint { name, kind, parent, child, parent_from_child, axis, limits: None, mimic: None }
    }

    fn push(&self, text: &mut UrdfText) {
        let kind = match (self.kind, self.limits) {
            (LinkJointKind::Fixed, _) => "fixed",
            (LinkJointKind::Turns, Some(_)) => "revolute",
            (LinkJointKind::Turns, None) => "continuous",
            (LinkJointKind::Slides, _) => "prismatic",
            (LinkJointKind::Free, _) => "floating",
        };
        text.open_joint(&self.name, kind, (&self.parent, &self.child));
        text.origin(2, &self.parent_from_child);
        if matches!(self.kind, LinkJointKind::Turns | LinkJointKind::Slides) {
            text.axis(self.axis.into_inner().into());
        }
        // URDF demands limits of a prismatic joint.
        if let Some(limits) = self.limits.or((self.kind == LinkJointKind::Slides).then_some(WIDE_LIMITS)) {
            text.limits(limits);
        }
        if let Some(mimic) = &self.mimic {
            text.mimic(&mimic.joint, mimic.multiplier, mimic.offset);
        }
        text.close_joint();
    }
}
