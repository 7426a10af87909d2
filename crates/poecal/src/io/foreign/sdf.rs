//! Gazebo's model. Links, joints, frames and models within the model each have a pose in another one; where joints stand in links follows.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use nalgebra::{Unit, Vector3};
use roxmltree::Node;

use super::links::{Inertial, LinkJoint, LinkJointKind, Links, Mimic};
use crate::error::Result;
use crate::io::numbers::LARGEST_NUMBER;
use crate::io::xml::{XmlSource, parsed, readable};
use crate::lie::Pose;
use crate::robot::{Limits, Mass};

/// What is read.
const EXPECTED: &str = "a model of Gazebo (SDF)";
/// The frame around the model.
const WORLD: &str = "world";
/// A model's own frame.
const MODEL: &str = "__model__";
/// Most models in each other: names of what is in them begin with all of theirs.
const DEEPEST: usize = 64;
/// Rounding of poses over the frames in between.
const ROUNDING: f64 = 1e-12;

/// The links; frames of these names are links too.
pub(super) fn read(text: &str, path: &Path, named: &[&str]) -> Result<Links> {
    let text = readable(text);
    let document = parsed(&text, path, EXPECTED)?;
    let source = XmlSource { document: &document, path };
    let root = document.root_element();
    let model = the_model(source, root)?;
    if let Some(node) = model.descendants().find(|node| node.has_tag_name("include") && !is_of_plugin(*node))
    {
        let message =
            "found <include>, expected a model in one file: `gz sdf --print FILE` writes it whole".to_owned();
        return Err(source.syntax_error(node, message));
    }
    let version =
        root.attribute("version").and_then(|it| it.split_once('.')?.1.parse::<u32>().ok()).unwrap_or(12);
    let mut frames = Frames {
        source,
        found: BTreeMap::new(),
        placed: RefCell::default(),
        links: Vec::new(),
        joints: Vec::new(),
    };
    frames.insert(
        WORLD.to_owned(),
        Frame { node: None, pose: Pose::identity(), base: String::new(), on: Some(WORLD.to_owned()) },
    );
    frames.read_model(model, "", WORLD)?;
    frames.links(model.attribute("name").unwrap_or("robot"), version, named)
}

/// The model that has joints.
fn the_model<'a>(source: XmlSource<'a>, root: Node<'a, 'a>) -> Result<Node<'a, 'a>> {
    let worlds = source.children(root, "world").flat_map(|world| source.children(world, "model"));
    let models: Vec<Node<'a, 'a>> = source.children(root, "model").chain(worlds).collect();
    let moves = |model: &&Node<'a, 'a>| model.descendants().any(|it| it.has_tag_name("joint"));
    let moving: Vec<&Node<'a, 'a>> = models.iter().filter(moves).collect();
    match moving.as_slice() {
        [model] => Ok(**model),
        [] => Err(source.syntax_error(root, "found no <model> with a <joint>, expected one".to_owned())),
        [_, second, ..] => {
            let message = format!(
                "found {} models with joints, expected one: keep the arm's alone in a file",
                moving.len()
            );
            Err(source.error(**second, message))
        }
    }
}

/// Whether an element is one of a plugin, which says what it likes.
fn is_of_plugin(node: Node<'_, '_>) -> bool {
    node.ancestors().any(|it| it.has_tag_name("plugin"))
}

/// An element's text, without comments within.
fn text_of(node: Node<'_, '_>) -> String {
    let texts: String = node.children().filter(Node::is_text).filter_map(|it| it.text()).collect();
    texts.trim().to_owned()
}

/// Something with a pose.
struct Frame<'a> {
    node: Option<Node<'a, 'a>>,
    pose: Pose,
    /// Name of the frame that the pose is in; empty of the world's.
    base: String,
    /// Name of the frame whose link it is fixed to; itself of a link, none of a joint.
    on: Option<String>,
}

struct Frames<'a> {
    source: XmlSource<'a>,
    found: BTreeMap<String, Frame<'a>>,
    /// Poses in the world that were asked for.
    placed: RefCell<BTreeMap<String, Pose>>,
    /// Names of links and joints, in the order of the file, with their model's prefix.
    links: Vec<String>,
    joints: Vec<(String, String)>,
}

impl<'a> Frames<'a> {
    fn insert(&mut self, name: String, frame: Frame<'a>) -> bool {
        self.found.insert(name, frame).is_none()
    }

    /// A name within a model.
    fn within(prefix: &str, name: &str) -> String {
        if name == WORLD { WORLD.to_owned() } else { format!("{prefix}{name}") }
    }

    /// All frames of a model, whose names begin with `prefix`, and of models within it.
    fn read_model(&mut self, model: Node<'a, 'a>, prefix: &str, around: &str) -> Result<()> {
        let mut steps = vec![(model, prefix.to_owned(), around.to_owned())];
        while let Some((model, prefix, around)) = steps.pop() {
            if prefix.matches("::").count() > DEEPEST {
                let message = format!("found more than {DEEPEST} models in each other, expected fewer");
                return Err(self.source.error(model, message));
            }
            let of = format!("<model> `{}`", model.attribute("name").unwrap_or_default());
            if let Some(placed) = model.attribute("placement_frame").filter(|it| !it.is_empty()) {
                let message = format!(
                    "found placement_frame=\"{placed}\" in {of}, expected none: place the model by its <pose>"
                );
                return Err(self.source.error(model, message));
            }
            let own = format!("{prefix}{MODEL}");
            let first = |tag| self.source.children(model, tag).find_map(|it| it.attribute("name"));
            let links = first("link").or_else(|| first("model"));
            let (pose, base) = self.pose(model, &of)?;
            let outer = prefix.trim_end_matches("::").rsplit_once("::").map_or("", |(outer, _)| outer);
            let outer = if outer.is_empty() { String::new() } else { format!("{outer}::") };
            let base = base.map_or(around, |base| Self::within(&outer, base));
            let first = model.attribute("canonical_link").or(links).map(|link| Self::within(&prefix, link));
            self.insert(
                own.clone(),
                Frame { node: Some(model), pose, base: base.clone(), on: first.clone() },
            );
            for node in model.children().filter(Node::is_element) {
                let tag = node.tag_name().name();
                if !["link", "joint", "frame", "model"].contains(&tag) {
                    continue;
                }
                let of = format!("<{tag}> `{}`", node.attribute("name").unwrap_or_default());
                let (word, _) = self.source.required(node, "name", &format!("a <{tag}>"))?;
                let name = Self::within(&prefix, word);
                if tag == "model" {
                    steps.push((node, format!("{name}::"), own.clone()));
                    // Its name is a frame too.
                    let alias = format!("{name}::{MODEL}");
                    let frame = Frame {
                        node: Some(node),
                        pose: Pose::identity(),
                        base: alias.clone(),
                        on: Some(alias),
                    };
                    self.insert(name, frame);
                    continue;
                }
                let (pose, base) = self.pose(node, &of)?;
                let base = base.map(|base| Self::within(&prefix, base));
                let (default, on) = match tag {
                    "link" => (own.clone(), Some(name.clone())),
                    "joint" => {
                        let child = self.child_text(node, "child", &of)?;
                        (Self::within(&prefix, &child), None)
                    }
                    _ => {
                        let on = node.attribute("attached_to").filter(|it| !it.is_empty());
                        let on = Self::within(&prefix, on.unwrap_or(MODEL));
                        (on.clone(), Some(on))
                    }
                };
                match tag {
                    "link" => self.links.push(name.clone()),
                    "joint" => self.joints.push((prefix.clone(), name.clone())),
                    _ => {}
                }
                let frame = Frame { node: Some(node), pose, base: base.unwrap_or(default), on };
                if !self.insert(name, frame) {
                    return Err(self
                        .source
                        .error(node, format!("found {of} twice, expected names that are there once")));
                }
            }
        }
        Ok(())
    }

    fn child_text(&self, node: Node<'a, 'a>, name: &'static str, of: &str) -> Result<String> {
        let text = self.source.children(node, name).next().map(text_of);
        text.filter(|text| !text.is_empty()).ok_or_else(|| {
            self.source.error(node, format!("{of} has no <{name}>, expected the name of a link"))
        })
    }

    /// The pose of an element, and the frame that it names.
    fn pose(&self, node: Node<'a, 'a>, of: &str) -> Result<(Pose, Option<&'a str>)> {
        let Some(element) = self.source.children(node, "pose").next() else {
            return Ok((Pose::identity(), None));
        };
        let base =
            element.attribute("relative_to").or(element.attribute("frame")).filter(|it| !it.is_empty());
        let numbers = self.numbers_of(element, of)?;
        let in_degrees = match element.attribute("degrees") {
            Some(word) => self.is_true(element, word, "degrees")?,
            None => false,
        };
        let angle = |number: f64| if in_degrees { number.to_radians() } else { number };
        let pose = match (element.attribute("rotation_format"), numbers.as_slice()) {
            (_, []) => Pose::identity(),
            (None | Some("euler_rpy"), &[x, y, z, roll, pitch, yaw]) => {
                Pose::from_xyz_rpy([x, y, z], [roll, pitch, yaw].map(angle))
            }
            (Some("quat_xyzw"), &[x, y, z, qx, qy, qz, qw])
                if qx.abs() + qy.abs() + qz.abs() + qw.abs() > 0.0 =>
            {
                Pose::from_position_quaternion([x, y, z], [qx, qy, qz, qw])
            }
            (Some("quat_xyzw"), [_, _, _, _, _, _, _]) => {
                let message = format!("found a quaternion of no length in <pose> of {of}");
                return Err(self.source.error(element, message));
            }
            (_, numbers) => {
                let message = format!(
                    "found {} numbers in <pose> of {of}, expected x y z roll pitch yaw, or x y z and a quaternion with rotation_format=\"quat_xyzw\"",
                    numbers.len()
                );
                return Err(self.source.error(element, message));
            }
        };
        Ok((pose, base))
    }

    /// A truth value, as readers of SDF take it.
    fn is_true(&self, node: Node<'a, 'a>, word: &str, of: &str) -> Result<bool> {
        match word.trim().to_ascii_lowercase().as_str() {
            "true" | "1" => Ok(true),
            "false" | "0" => Ok(false),
            word => {
                let message = format!("found `{word}` in `{of}`, expected true, false, 1 or 0");
                Err(self.source.error(node, message))
            }
        }
    }

    /// The numbers of an element's text.
    fn numbers_of(&self, node: Node<'a, 'a>, of: &str) -> Result<Vec<f64>> {
        let tag = node.tag_name().name();
        let text = text_of(node);
        let words = text.split_whitespace();
        let number = |word: &str| {
            let number = word.parse().ok().filter(|number: &f64| !number.is_nan());
            number.ok_or_else(|| {
                self.source.error(node, format!("found `{word}` in <{tag}> of {of}, expected a number"))
            })
        };
        let numbers: Vec<f64> = words.map(number).collect::<Result<_>>()?;
        let is_length = !matches!(tag, "lower" | "upper" | "mass");
        match numbers.iter().find(|it| is_length && it.abs() > LARGEST_NUMBER) {
            Some(number) => {
                let message = format!(
                    "found {number} in <{tag}> of {of}, expected a number of metres or radians below 1e6"
                );
                Err(self.source.error(node, message))
            }
            None => Ok(numbers),
        }
    }

    /// Number of an element within another one.
    fn number(&self, node: Node<'a, 'a>, name: &'static str, of: &str) -> Result<Option<f64>> {
        let Some(element) = self.source.children(node, name).next() else { return Ok(None) };
        Ok(self.numbers_of(element, of)?.first().copied())
    }

    fn unknown(&self, at: Option<Node<'a, 'a>>, name: &str) -> crate::error::Error {
        let message =
            format!("found the frame `{name}`, which is not in the model, expected a link, joint or frame");
        self.source.error(at.unwrap_or_else(|| self.source.document.root_element()), message)
    }

    /// Where a frame stands in the world, all joints at zero.
    fn world_from(&self, name: &str) -> Result<Pose> {
        let (mut at, mut asking) = (name, None);
        // From the frame to the first whose place is known, and back.
        let mut passed: Vec<(&str, &Frame)> = Vec::new();
        while passed.len() <= self.found.len() {
            let known = self.placed.borrow().get(at).copied();
            let mut pose = match known {
                Some(pose) => pose,
                None => {
                    let frame = self.found.get(at).ok_or_else(|| self.unknown(asking, at))?;
                    passed.push((at, frame));
                    if !frame.base.is_empty() {
                        (asking, at) = (frame.node, &frame.base);
                        continue;
                    }
                    Pose::identity()
                }
            };
            let mut placed = self.placed.borrow_mut();
            for (name, frame) in passed.iter().rev() {
                pose = pose * frame.pose;
                placed.insert((*name).to_owned(), pose);
            }
            return Ok(pose);
        }
        Err(self.source.error(
            asking.unwrap_or_else(|| self.source.document.root_element()),
            format!("the pose of `{name}` leads back to itself, expected frames that end at the model"),
        ))
    }

    /// The link that a frame is fixed to.
    fn link_of(&self, name: &str, asking: Node<'a, 'a>) -> Result<String> {
        let mut at = name.to_owned();
        for _ in 0..=self.found.len() {
            let frame = self.found.get(&at).ok_or_else(|| self.unknown(Some(asking), &at))?;
            match &frame.on {
                Some(on) if *on == at => return Ok(at),
                Some(on) => at.clone_from(on),
                None => {
                    let node = frame.node.unwrap_or(asking);
                    at = match self.source.children(node, "child").next().map(text_of) {
                        Some(child) => {
                            let prefix = at
                                .rsplit_once("::")
                                .map_or(String::new(), |(prefix, _)| format!("{prefix}::"));
                            Self::within(&prefix, &child)
                        }
                        None => break,
                    };
                }
            }
        }
        Err(self
            .source
            .error(asking, format!("`{name}` is fixed to no link, expected a link or a frame on one")))
    }

    /// Links and joints with their poses.
    fn links(&self, name: &str, version: u32, named: &[&str]) -> Result<Links> {
        let mut links = Links::new(name);
        let joined: BTreeSet<String> = self
            .joints
            .iter()
            .filter_map(|(_, joint)| self.found.get(joint)?.node)
            .filter_map(|node| self.source.children(node, "parent").next().map(text_of))
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
        links: &mut Links,
        (prefix, joint): (&str, &str),
        node: Node<'a, 'a>,
        version: u32,
    ) -> Result<()> {
        let of = format!("<joint> `{joint}`");
        let link = |which| -> Result<String> {
            let name = self.child_text(node, which, &of)?;
            self.link_of(&Self::within(prefix, &name), node)
        };
        let (parent, child) = (link("parent")?, link("child")?);
        let (world_from_joint, world_from_child) = (self.world_from(joint)?, self.world_from(&child)?);
        let parent_from_joint = self.world_from(&parent)?.inverse() * world_from_joint;
        let joint_from_child = world_from_joint.inverse() * world_from_child;
        let (kind, _) = self.source.required(node, "type", &of)?;
        let kind = match kind {
            "fixed" => LinkJointKind::Fixed,
            "revolute" | "continuous" => LinkJointKind::Turns,
            "prismatic" => LinkJointKind::Slides,
            "ball" | "universal" | "revolute2" | "screw" | "gearbox" => LinkJointKind::Free,
            word => {
                let message = format!(
                    "found type=\"{word}\" in {of}, expected revolute, continuous, prismatic or fixed"
                );
                return Err(self.source.error(node, message));
            }
        };
        let mut made = LinkJoint {
            name: links.joint_name(Some(joint), joint),
            kind,
            parent,
            child: child.clone(),
            parent_from_child: parent_from_joint,
            axis: Vector3::z_axis(),
            limits: None,
            mimic: None,
        };
        if !matches!(kind, LinkJointKind::Turns | LinkJointKind::Slides) {
            made.parent_from_child = parent_from_joint * joint_from_child;
            links.joints.push(made);
            return Ok(());
        }
        let Some(axis) = self.source.children(node, "axis").next() else {
            return Err(self.source.error(node, format!("{of} has no <axis>, expected its direction")));
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
        let xyz = self.source.children(axis, "xyz").next();
        let numbers = xyz.map(|xyz| self.numbers_of(xyz, of)).transpose()?.unwrap_or(vec![0.0, 0.0, 1.0]);
        let direction =
            <[f64; 3]>::try_from(numbers).ok().and_then(|it| Unit::try_new(Vector3::from(it), 1e-12));
        let Some(direction) = direction else {
            let message =
                format!("found no direction in <xyz> of {of}, expected three numbers, not all zero");
            return Err(self.source.error(xyz.unwrap_or(axis), message));
        };
        let in_model = match self.source.children(axis, "use_parent_model_frame").next() {
            Some(it) => self.is_true(it, &text_of(it), "use_parent_model_frame")?,
            None => version < 5,
        };
        let named = xyz.and_then(|xyz| xyz.attribute("expressed_in")).filter(|it| !it.is_empty());
        let frame = match (named, in_model) {
            (Some(name), _) => Self::within(prefix, name),
            (None, true) => format!("{prefix}{MODEL}"),
            (None, false) => return Ok(direction),
        };
        let joint_from_frame = world_from_joint.inverse() * self.world_from(&frame)?;
        Ok(Unit::new_normalize(joint_from_frame.rotation * direction.into_inner()))
    }

    fn limits(&self, axis: Node<'a, 'a>, of: &str) -> Result<Option<Limits>> {
        let Some(limit) = self.source.children(axis, "limit").next() else { return Ok(None) };
        let bounds = (self.number(limit, "lower", of)?, self.number(limit, "upper", of)?);
        let (Some(lower), Some(upper)) = bounds else { return Ok(None) };
        Ok(Limits::between(lower, upper))
    }

    /// `q = multiplier (q' − reference) + offset`.
    fn mimic(&self, axis: Node<'a, 'a>, (prefix, of): (&str, &str)) -> Result<Option<Mimic>> {
        let Some(node) = self.source.children(axis, "mimic").next() else { return Ok(None) };
        let (joint, _) = self.source.required(node, "joint", of)?;
        let number = |name, default: f64| {
            Ok::<_, crate::error::Error>(self.number(node, name, of)?.unwrap_or(default))
        };
        let multiplier = number("multiplier", 1.0)?;
        let offset = number("offset", 0.0)? - multiplier * number("reference", 0.0)?;
        Ok(Some(Mimic { joint: Self::within(prefix, joint), multiplier, offset }))
    }

    fn inertial(&self, link: Node<'a, 'a>, name: &str) -> Result<Option<Inertial>> {
        let of = format!("<inertial> of <link> `{name}`");
        let Some(node) = self.source.children(link, "inertial").next() else { return Ok(None) };
        let Some(kg) = self.number(node, "mass", &of)? else { return Ok(None) };
        let (pose, _) = self.pose(node, &of)?;
        Ok(Some(Inertial { pose, kg }).filter(|it| Mass::is_mass(it.kg)))
    }
}
