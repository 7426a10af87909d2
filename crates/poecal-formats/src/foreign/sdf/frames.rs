//! Frames of a model of Gazebo, and their poses.

use std::cell::RefCell;
use std::collections::BTreeMap;

use roxmltree::Node;

use super::{MODEL, WORLD, text_of};
use poecal_arm::lie::Pose;
use poecal_numerics::error::Result;
use poecal_storage::numbers::LARGEST_NUMBER;
use poecal_storage::xml::XmlSource;

/// Largest depth of nested models: names of their contents begin with the names of all of them.
const DEEPEST: usize = 64;

/// Something with a pose.
pub(crate) struct SdfFrame<'a> {
    pub(crate) node: Option<Node<'a, 'a>>,
    pose: Pose,
    /// Name of the frame in which the pose is stated; empty for the world.
    base: String,
    /// Name of the frame to whose link it is fixed: its own name for a link, `None` for a joint.
    on: Option<String>,
}

/// The frames of a model and of models within it.
pub(crate) struct SdfFrames<'a> {
    pub(crate) source: XmlSource<'a>,
    pub(crate) found: BTreeMap<String, SdfFrame<'a>>,
    /// Poses in the world that were computed so far.
    placed: RefCell<BTreeMap<String, Pose>>,
    /// Names of links and joints, in the order of the file, with their model's prefix.
    pub(crate) links: Vec<String>,
    pub(crate) joints: Vec<(String, String)>,
}

impl<'a> SdfFrames<'a> {
    /// The frames of a model.
    pub(crate) fn from_model(source: XmlSource<'a>, model: Node<'a, 'a>) -> Result<Self> {
        let (found, placed) = (BTreeMap::new(), RefCell::default());
        let mut frames = SdfFrames { source, found, placed, links: Vec::new(), joints: Vec::new() };
        let (pose, base, on) = (Pose::identity(), String::new(), Some(WORLD.to_owned()));
        frames.found.insert(WORLD.to_owned(), SdfFrame { node: None, pose, base, on });
        let mut steps = vec![(model, String::new(), WORLD.to_owned())];
        while let Some((model, prefix, around)) = steps.pop() {
            frames.read_model(model, &prefix, around, &mut steps)?;
        }
        Ok(frames)
    }

    /// A name within a model.
    pub(crate) fn join_name(prefix: &str, name: &str) -> String {
        if name == WORLD { WORLD.to_owned() } else { format!("{prefix}{name}") }
    }

    /// The frames of a model, whose names begin with `prefix`; models within it are further steps.
    fn read_model(
        &mut self,
        model: Node<'a, 'a>,
        prefix: &str,
        around: String,
        steps: &mut Vec<(Node<'a, 'a>, String, String)>,
    ) -> Result<()> {
        if prefix.matches("::").count() > DEEPEST {
            let message = format!("found more than {DEEPEST} models in each other, expected fewer");
            return self.source.refuse(model, message);
        }
        let of = format!("<model> `{}`", model.attribute("name").unwrap_or_default());
        if let Some(placed) = model.attribute("placement_frame").filter(|it| !it.is_empty()) {
            let message =
                format!("found placement_frame=\"{placed}\" in {of}, expected none: place the model by its <pose>");
            return self.source.refuse(model, message);
        }
        let own = format!("{prefix}{MODEL}");
        let first = |tag| self.source.children(model, tag).find_map(|it| it.attribute("name"));
        let links = first("link").or_else(|| first("model"));
        let (pose, base) = self.pose(model, &of)?;
        let outer = prefix.trim_end_matches("::").rsplit_once("::");
        let outer = outer.filter(|it| !it.0.is_empty()).map_or(String::new(), |it| format!("{}::", it.0));
        let base = base.map_or(around, |base| Self::join_name(&outer, base));
        let on = model.attribute("canonical_link").or(links).map(|link| Self::join_name(prefix, link));
        self.found.insert(own.clone(), SdfFrame { node: Some(model), pose, base, on });
        for node in model.children().filter(Node::is_element) {
            let tag = node.tag_name().name();
            if !["link", "joint", "frame", "model"].contains(&tag) {
                continue;
            }
            let (word, _) = self.source.require_attribute(node, "name", &format!("a <{tag}>"))?;
            let name = Self::join_name(prefix, word);
            if tag == "model" {
                steps.push((node, format!("{name}::"), own.clone()));
                // Its name is a frame too.
                let alias = format!("{name}::{MODEL}");
                let (pose, base, on) = (Pose::identity(), alias.clone(), Some(alias));
                self.found.insert(name, SdfFrame { node: Some(node), pose, base, on });
                continue;
            }
            let of = format!("<{tag}> `{word}`");
            let frame = self.frame(node, (prefix, &name, &own), &of)?;
            match tag {
                "link" => self.links.push(name.clone()),
                "joint" => self.joints.push((prefix.to_owned(), name.clone())),
                _ => {}
            }
            if self.found.insert(name, frame).is_some() {
                let message = format!("found {of} twice, expected names that are there once");
                return self.source.refuse(node, message);
            }
        }
        Ok(())
    }

    /// The frame of a link, a joint or a frame of a model.
    fn frame(&self, node: Node<'a, 'a>, (prefix, name, own): (&str, &str, &str), of: &str) -> Result<SdfFrame<'a>> {
        let (pose, base) = self.pose(node, of)?;
        let base = base.map(|base| Self::join_name(prefix, base));
        let (default, on) = match node.tag_name().name() {
            "link" => (own.to_owned(), Some(name.to_owned())),
            "joint" => (Self::join_name(prefix, &self.child_text(node, "child", of)?), None),
            _ => {
                let on = node.attribute("attached_to").filter(|it| !it.is_empty());
                let on = Self::join_name(prefix, on.unwrap_or(MODEL));
                (on.clone(), Some(on))
            }
        };
        Ok(SdfFrame { node: Some(node), pose, base: base.unwrap_or(default), on })
    }

    pub(crate) fn child_text(&self, node: Node<'a, 'a>, name: &'static str, of: &str) -> Result<String> {
        let text = self.source.child(node, name).map(text_of);
        text.filter(|text| !text.is_empty())
            .ok_or_else(|| self.source.error(node, format!("{of} has no <{name}>, expected the name of a link")))
    }

    /// The pose of an element, and the frame that it names.
    pub(crate) fn pose(&self, node: Node<'a, 'a>, of: &str) -> Result<(Pose, Option<&'a str>)> {
        let Some(element) = self.source.child(node, "pose") else {
            return Ok((Pose::identity(), None));
        };
        let base = element.attribute("relative_to").or(element.attribute("frame")).filter(|it| !it.is_empty());
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
            (Some("quat_xyzw"), &[x, y, z, qx, qy, qz, qw]) if qx.abs() + qy.abs() + qz.abs() + qw.abs() > 0.0 => {
                Pose::from_position_quaternion([x, y, z], [qx, qy, qz, qw])
            }
            (Some("quat_xyzw"), [_, _, _, _, _, _, _]) => {
                return self.source.refuse(element, format!("found a quaternion of no length in <pose> of {of}"));
            }
            (_, numbers) => {
                let message = format!(
                    "found {} numbers in <pose> of {of}, expected x y z roll pitch yaw, or x y z and a quaternion with rotation_format=\"quat_xyzw\"",
                    numbers.len()
                );
                return self.source.refuse(element, message);
            }
        };
        Ok((pose, base))
    }

    /// A truth value, in the forms that readers of SDF accept.
    pub(crate) fn is_true(&self, node: Node<'a, 'a>, word: &str, of: &str) -> Result<bool> {
        match word.trim().to_ascii_lowercase().as_str() {
            "true" | "1" => Ok(true),
            "false" | "0" => Ok(false),
            word => self.source.refuse(node, format!("found `{word}` in `{of}`, expected true, false, 1 or 0")),
        }
    }

    /// The numbers of an element's text.
    pub(crate) fn numbers_of(&self, node: Node<'a, 'a>, of: &str) -> Result<Vec<f64>> {
        let tag = node.tag_name().name();
        let text = text_of(node);
        let words = text.split_whitespace();
        let number = |word: &str| {
            let number = word.parse().ok().filter(|number: &f64| !number.is_nan());
            number
                .ok_or_else(|| self.source.error(node, format!("found `{word}` in <{tag}> of {of}, expected a number")))
        };
        let numbers: Vec<f64> = words.map(number).collect::<Result<_>>()?;
        let is_length = !matches!(tag, "lower" | "upper" | "mass");
        match numbers.iter().find(|it| is_length && it.abs() > LARGEST_NUMBER) {
            Some(number) => {
                let message =
                    format!("found {number} in <{tag}> of {of}, expected a number of metres or radians below 1e6");
                self.source.refuse(node, message)
            }
            None => Ok(numbers),
        }
    }

    /// Number of an element within another one.
    pub(crate) fn number(&self, node: Node<'a, 'a>, name: &'static str, of: &str) -> Result<Option<f64>> {
        let Some(element) = self.source.child(node, name) else { return Ok(None) };
        Ok(self.numbers_of(element, of)?.first().copied())
    }

    fn unknown(&self, at: Option<Node<'a, 'a>>, name: &str) -> poecal_numerics::error::Error {
        let message = format!("found the frame `{name}`, which is not in the model, expected a link, joint or frame");
        self.source.error(at.unwrap_or_else(|| self.source.document.root_element()), message)
    }

    /// Pose of a frame in the world, all joints at zero.
    pub(crate) fn world_from(&self, name: &str) -> Result<Pose> {
        let (mut at, mut asking) = (name, None);
        // The walk goes from the frame to the first one with a known pose, and back.
        let mut passed: Vec<(&str, &SdfFrame)> = Vec::new();
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

    /// The link to which a frame is fixed.
    pub(crate) fn link_of(&self, name: &str, asking: Node<'a, 'a>) -> Result<String> {
        let mut at = name.to_owned();
        for _ in 0..=self.found.len() {
            let frame = self.found.get(&at).ok_or_else(|| self.unknown(Some(asking), &at))?;
            match &frame.on {
                Some(on) if *on == at => return Ok(at),
                Some(on) => at.clone_from(on),
                None => {
                    let node = frame.node.unwrap_or(asking);
                    at = match self.source.child(node, "child").map(text_of) {
                        Some(child) => {
                            let prefix =
                                at.rsplit_once("::").map_or(String::new(), |(prefix, _)| format!("{prefix}::"));
                            Self::join_name(&prefix, &child)
                        }
                        None => break,
                    };
                }
            }
        }
        Err(self.source.error(asking, format!("`{name}` is fixed to no link, expected a link or a frame on one")))
    }
}
