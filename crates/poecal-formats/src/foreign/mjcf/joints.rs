//! Joints of MuJoCo's models, and those that follow others.

use nalgebra::{Unit, Vector3};
use roxmltree::Node;

use super::defaults::ElementClass;
use super::{BodyElement, MjcfReader, describe_element};
use crate::foreign::links::{LinkJoint, LinkJointKind, Mimic};
use poecal_arm::lie::Pose;
use poecal_model::robot::JointLimits;
use poecal_numerics::error::Result;

const KINDS: [(&str, LinkJointKind); 4] = [
    ("hinge", LinkJointKind::Turns),
    ("slide", LinkJointKind::Slides),
    ("free", LinkJointKind::Free),
    ("ball", LinkJointKind::Free),
];
const LIMITED: [(&str, Option<bool>); 3] = [("true", Some(true)), ("false", Some(false)), ("auto", None)];

impl<'a> MjcfReader<'a, '_> {
    /// The link of the last joint, which is added if the joint does not end at its body.
    pub(crate) fn link_of_last(&mut self, parent: &str, body: Node<'a, 'a>) -> String {
        let Some(last) = self.links.joints.last().filter(|it| it.child.is_empty()) else {
            return parent.to_owned();
        };
        let wanted = match body.attribute("name") {
            Some(name) => format!("{name}_{}", last.name),
            None => format!("{}_frame", last.name),
        };
        let link = self.links.add_unnamed(&wanted, None);
        if let Some(last) = self.links.joints.last_mut() {
            last.child.clone_from(&link);
        }
        link
    }

    /// Adds a joint of a body. Returns its link, still without a name, which the next element determines, and the body in the joint's frame on its
    /// axis.
    pub(crate) fn read_joint(
        &mut self,
        BodyElement { stated, body_from_frame }: BodyElement<'a>,
        (parent, parent_from_body): (&str, &Pose),
        body: Node<'a, 'a>,
    ) -> Result<(String, Pose)> {
        let parent = self.link_of_last(parent, body);
        let (node, known) = (stated.node, &self.defaults);
        let of = describe_element(node);
        let word = known.word(stated, "type")?.unwrap_or("hinge");
        let kind = if node.has_tag_name("freejoint") {
            LinkJointKind::Free
        } else {
            let place = format!("in {of}");
            known.source.meaning(node, ("type", word), &place, &KINDS, "hinge, slide, ball or free")?
        };
        let turns = kind == LinkJointKind::Turns;
        let angle = |value: f64| if turns { known.settings.radians(value) } else { value };
        let axis = known.numbers::<3>(stated, "axis")?.unwrap_or([0.0, 0.0, 1.0]);
        let axis = known.direction(node, axis)?;
        let axis = Unit::new_normalize(body_from_frame.rotation * axis.into_inner());
        let place: Vector3<f64> = if turns {
            body_from_frame.act(&known.numbers::<3>(stated, "pos")?.unwrap_or_default().into())
        } else {
            Vector3::zeros()
        };
        let reference = angle(known.numbers::<1>(stated, "ref")?.map_or(0.0, |[it]| it));
        let limited = known.word(stated, "limited")?.unwrap_or("auto");
        let place_words = format!("of {of}");
        let limited =
            known.source.meaning(node, ("limited", limited), &place_words, &LIMITED, "true, false or auto")?;
        let range = match known.find_stating(stated, "range")? {
            Some(stating) => known.source.bounds::<2>(stating, "range", &of)?,
            None => None,
        };
        let counts = limited.unwrap_or(known.settings.limits_alone);
        let range = range.filter(|_| counts).map(|range| range.map(angle));
        let limits = range.and_then(|[lower, upper]| JointLimits::from_bounds(lower, upper));
        let body_from_joint = Pose::from_translation(place);
        // The poses of bodies are stated for the joint at its reference.
        let back = kind.motion(&axis, -reference).unwrap_or_else(Pose::identity);
        let wanted = format!("{}_joint", body.attribute("name").unwrap_or("body"));
        let name = self.links.joint_name(node.attribute("name"), &wanted);
        self.references.insert(name.clone(), reference);
        let parent_from_child = *parent_from_body * body_from_joint * back;
        let joint = LinkJoint::new(name, kind, (parent, String::new()), parent_from_child);
        self.links.joints.push(LinkJoint { axis, limits, ..joint });
        Ok((String::new(), body_from_joint.inverse()))
    }

    /// Joints that follow another one: `q₁ − r₁ = a₀ + a₁ (q₂ − r₂)`, with references r.
    pub(crate) fn read_followers(&mut self, equality: Node<'a, 'a>) -> Result<()> {
        let source = self.defaults.source;
        for node in source.children(equality, "joint") {
            let active = self.defaults.stating_one(ElementClass { node, class: None }, "equality", &["active"])?;
            if active.is_some_and(|it| it.attribute("active") == Some("false")) {
                continue;
            }
            let joint = |name: &str| {
                let Some(joint) = node.attribute(name) else { return Ok(None) };
                match self.references.get(joint) {
                    Some(reference) => Ok(Some((joint, *reference))),
                    None => {
                        let message = format!("found {name}=\"{joint}\", expected the name of a joint");
                        source.refuse(node, message)
                    }
                }
            };
            let Some((follower, own)) = joint("joint1")? else {
                let message = "<joint> of <equality> has no attribute `joint1`, expected the joint that follows";
                return source.refuse(node, message);
            };
            let leader = joint("joint2")?;
            let at = self.coefficients(node)?;
            let Some(joint) = self.links.joints.iter_mut().find(|joint| joint.name == follower) else {
                continue;
            };
            match leader {
                // URDF has no other relation: a chain over such a joint is refused.
                Some(_) if at[2..].iter().any(|it| *it != 0.0) => joint.kind = LinkJointKind::Free,
                Some((leader, other)) if at[1] != 0.0 => {
                    let offset = own + at[0] - at[1] * other;
                    joint.mimic = Some(Mimic { joint: leader.to_owned(), multiplier: at[1], offset });
                }
                _ => {
                    let Some(motion) = joint.kind.motion(&joint.axis, own + at[0]) else { continue };
                    joint.parent_from_child = joint.parent_from_child * motion;
                    joint.kind = LinkJointKind::Fixed;
                    joint.limits = None;
                }
            }
        }
        Ok(())
    }

    /// Coefficients of the relation of two joints; missing ones have their defaults.
    fn coefficients(&self, node: Node<'a, 'a>) -> Result<[f64; 5]> {
        let mut at = [0.0, 1.0, 0.0, 0.0, 0.0];
        let words: Vec<&str> = node.attribute("polycoef").unwrap_or_default().split_whitespace().collect();
        for (k, word) in words.iter().enumerate() {
            match (at.get_mut(k), word.parse::<f64>()) {
                (Some(number), Ok(value)) if value.is_finite() => *number = value,
                _ => {
                    let message = format!("found polycoef=\"{}\", expected up to 5 numbers", words.join(" "));
                    return self.defaults.source.refuse(node, message);
                }
            }
        }
        Ok(at)
    }
}
