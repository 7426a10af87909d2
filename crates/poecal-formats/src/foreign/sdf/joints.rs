//! Links and joints of a model of Gazebo, by its frames.

use std::collections::BTreeSet;

use nalgebra::{Unit, Vector3};
use roxmltree::Node;

use super::frames::SdfFrames;
use super::{MODEL, WORLD, text_of};
use crate::foreign::links::{Inertial, LinkJoint, LinkJointKind, LinkTree, Mimic};
use poecal_arm::lie::Pose;
use poecal_model::robot::{JointLimits, Mass};
use poecal_numerics::error::Result;

/// Rounding of poses over the frames in between.
const ROUNDING: f64 = 1e-12;
const KINDS: [(&str, LinkJointKind); 9] = [
    ("fixed", LinkJointKind::Fixed),
    ("revolute", LinkJointKind::Turns),
    ("continuous", LinkJointKind::Turns),
    ("prismatic", LinkJointKind::Slides),
    ("ball", LinkJointKind::Free),
    ("universal", LinkJointKind::Free),
    ("revolute2", LinkJointKind::Free),
    ("screw", LinkJointKind::Free),
    ("gearbox", LinkJointKind::Free),
];

impl<'a> SdfFrames<'a> {
    /// Links and joints with their poses.
    pub(crate) fn links(&self, name: &str, version: u32, named: &[&str]) -> Result<LinkTree> {
        let mut links = LinkTree::new(name);
        let joined: BTreeSet<String> = self
            .joints
            .iter()
            .filter_map(|(_, joint)| self.found.get(joint)?.node)
            .filter_map(|node| self.source.child(node, "parent").map(text_of))
            .collect();
        let names = |of: &[(String, String)]| of.iter().map(|(_, name)| name.clone()).collect();
        links.keep_names(self.links.iter().cloned().collect(), names(&self.joints));
        if joined.contains(WORLD) {
            links.add(WORLD, None);
        }
        for link in &self.links {
            let node = self.found.get(link).and_then(|frame| frame.node);
            let inertial = node.map(|node| self.inertial(node, link)).transpose()?.flatten();
            links.add(link, inertial);
        }
        for (prefix, joint) in &self.joints {
            let Some(node) = self.found.get(joint).and_then(|frame| frame.node) else { continue };
            self.join(&mut links, (prefix, joint), node, version)?;
        }
        for &name in named {
            let Some(frame) = self.found.get(name).filter(|_| !links.has(name)) else { continue };
            let Some(node) = frame.node else { continue };
            let link = self.link_of(name, node)?;
            let pose = self.world_from(&link)?.inverse() * self.world_from(name)?;
            let added = links.add(name, None);
            links.fix(&link, &added, pose);
        }
        Ok(links)
    }

    fn join(
        &self,
        links: &mut LinkTree,
        (prefix, joint): (&str, &str),
        node: Node<'a, 'a>,
        version: u32,
    ) -> Result<()> {
        let of = format!("<joint> `{joint}`");
        let link = |which| -> Result<String> {
            let name = self.child_text(node, which, &of)?;
            self.link_of(&Self::join_name(prefix, &name), node)
        };
        let (parent, child) = (link("parent")?, link("child")?);
        let (world_from_joint, world_from_child) = (self.world_from(joint)?, self.world_from(&child)?);
        let parent_from_joint = self.world_from(&parent)?.inverse() * world_from_joint;
        let joint_from_child = world_from_joint.inverse() * world_from_child;
        let (kind, _) = self.source.require_attribute(node, "type", &of)?;
        let expected = "revolute, continuous, prismatic or fixed";
        let kind = self.source.meaning(node, ("type", kind), &format!("in {of}"), &KINDS, expected)?;
        let name = links.joint_name(Some(joint), joint);
        let mut made = LinkJoint::new(name, kind, (parent, child.clone()), parent_from_joint);
        if !matches!(kind, LinkJointKind::Turns | LinkJointKind::Slides) {
            made.parent_from_child = parent_from_joint * joint_from_child;
            links.joints.push(made);
            return Ok(());
        }
        let Some(axis) = self.source.child(node, "axis") else {
            return self.source.refuse(node, format!("{of} has no <axis>, expected its direction"));
        };
        made.axis = self.axis(axis, (prefix, &of), &world_from_joint, version)?;
        made.limits = self.limits(axis, &of)?;
        made.mimic = self.mimic(axis, (prefix, &of))?;
        // The joint's frame is the child's, unless it has a pose of its own or its child is a frame or a model.
        let (turn, shift) = (&joint_from_child.rotation, &joint_from_child.translation);
        let is_same = shift.norm() + (turn - nalgebra::Matrix3::identity()).norm() < ROUNDING;
        if !is_same {
            made.child = links.add_unnamed(&format!("{joint}_frame"), None);
            links.fix(&made.child, &child, joint_from_child);
        }
        links.joints.push(made);
        Ok(())
    }

    /// The axis in the joint's frame.
    fn axis(
        &self,
        axis: Node<'a, 'a>,
        (prefix, of): (&str, &str),
        world_from_joint: &Pose,
        version: u32,
    ) -> Result<Unit<Vector3<f64>>> {
        let xyz = self.source.child(axis, "xyz");
        let numbers = xyz.map(|xyz| self.numbers_of(xyz, of)).transpose()?.unwrap_or(vec![0.0, 0.0, 1.0]);
        let direction = <[f64; 3]>::try_from(numbers).ok().and_then(|it| Unit::try_new(Vector3::from(it), 1e-12));
        let Some(direction) = direction else {
            let message = format!("found no direction in <xyz> of {of}, expected three numbers, not all zero");
            return self.source.refuse(xyz.unwrap_or(axis), message);
        };
        let in_model = match self.source.child(axis, "use_parent_model_frame") {
            Some(it) => self.is_true(it, &text_of(it), "use_parent_model_frame")?,
            None => version < 5,
        };
        let named = xyz.and_then(|xyz| xyz.attribute("expressed_in")).filter(|it| !it.is_empty());
        let frame = match (named, in_model) {
            (Some(name), _) => Self::join_name(prefix, name),
            (None, true) => format!("{prefix}{MODEL}"),
            (None, false) => return Ok(direction),
        };
        let joint_from_frame = world_from_joint.inverse() * self.world_from(&frame)?;
        Ok(Unit::new_normalize(joint_from_frame.rotation * direction.into_inner()))
    }

    fn limits(&self, axis: Node<'a, 'a>, of: &str) -> Result<Option<JointLimits>> {
        let Some(limit) = self.source.child(axis, "limit") else { return Ok(None) };
        let bounds = (self.number(limit, "lower", of)?, self.number(limit, "upper", of)?);
        let (Some(lower), Some(upper)) = bounds else { return Ok(None) };
        Ok(JointLimits::from_bounds(lower, upper))
    }

    /// The relation `q = multiplier (q' − reference) + offset`.
    fn mimic(&self, axis: Node<'a, 'a>, (prefix, of): (&str, &str)) -> Result<Option<Mimic>> {
        let Some(node) = self.source.child(axis, "mimic") else { return Ok(None) };
        let (joint, _) = self.source.require_attribute(node, "joint", of)?;
        let number = |name| self.number(node, name, of);
        let multiplier = number("multiplier")?.unwrap_or(1.0);
        let offset = number("offset")?.unwrap_or(0.0) - multiplier * number("reference")?.unwrap_or(0.0);
        Ok(Some(Mimic { joint: Self::join_name(prefix, joint), multiplier, offset }))
    }

    fn inertial(&self, link: Node<'a, 'a>, name: &str) -> Result<Option<Inertial>> {
        let of = format!("<inertial> of <link> `{name}`");
        let Some(node) = self.source.child(link, "inertial") else { return Ok(None) };
        let Some(kg) = self.number(node, "mass", &of)? else { return Ok(None) };
        let (pose, _) = self.pose(node, &of)?;
        Ok(Some(Inertial { pose, kg }).filter(|it| Mass::is_mass(it.kg)))
    }
}
