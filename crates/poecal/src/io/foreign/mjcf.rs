//! MuJoCo's model. A body is a link; between it and the body around it stand its joints, in their order.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::Path;

use nalgebra::{Matrix3, Unit, Vector3};
use roxmltree::Node;

use super::links::{Inertial, LinkJoint, LinkJointKind, Links, Mimic};
use crate::error::Result;
use crate::io::xml::{XmlSource, parsed, readable};
use crate::lie::{Pose, rotation};
use crate::robot::{Limits, Mass};

/// The body around all bodies.
const WORLD: &str = "world";
/// What is read.
const EXPECTED: &str = "a model of MuJoCo";
/// Ways to say a rotation.
const ROTATIONS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];
/// Elements that stand for others, which MuJoCo makes when it compiles the model.
const MADE_BY_MUJOCO: [&str; 4] = ["include", "replicate", "attach", "composite"];

/// The links; sites of these names are links too.
pub(super) fn read(text: &str, path: &Path, named: &[&str]) -> Result<Links> {
    let text = readable(text);
    let document = parsed(&text, path, EXPECTED)?;
    let source = XmlSource { document: &document, path };
    let root = document.root_element();
    if root.has_tag_name("mujocoinclude") {
        let message = "found a part of a model (<mujocoinclude>), expected the model that includes it, saved whole by MuJoCo: \
             mujoco.mj_saveLastXML(\"whole.xml\", model)";
        return Err(source.syntax_error(root, message.to_owned()));
    }
    if let Some(node) = root.descendants().find(|node| MADE_BY_MUJOCO.contains(&node.tag_name().name())) {
        let message = format!(
            "found <{}>, expected bodies alone: save the whole model with MuJoCo, mujoco.mj_saveLastXML(\"whole.xml\", model)",
            node.tag_name().name()
        );
        return Err(source.syntax_error(node, message));
    }
    let mut reader = Reader {
        source,
        settings: Settings::read(&source, root)?,
        classes: Vec::new(),
        defaults: BTreeMap::new(),
        main: String::new(),
        named,
        links: Links::new(root.attribute("model").unwrap_or("robot")),
        references: BTreeMap::new(),
    };
    for node in source.children(root, "default") {
        reader.read_defaults(node)?;
    }
    let names = |tags: &[&str]| {
        let worlds = source.children(root, "worldbody").flat_map(|world| world.descendants());
        let named = worlds.filter(|node| tags.contains(&node.tag_name().name()));
        named.filter_map(|node| node.attribute("name").map(str::to_owned)).collect()
    };
    reader.links.keep_names(names(&["body"]), names(&["joint", "freejoint"]));
    reader.links.add(WORLD, None);
    for world in source.children(root, "worldbody") {
        reader.read_bodies(world)?;
    }
    for equality in source.children(root, "equality") {
        reader.read_followers(equality)?;
    }
    Ok(reader.links)
}

/// How numbers are to be understood.
struct Settings<'a> {
    in_degrees: bool,
    limits_alone: bool,
    euler: &'a str,
}

impl<'a> Settings<'a> {
    fn read(source: &XmlSource<'a>, root: Node<'a, 'a>) -> Result<Self> {
        let mut settings = Settings { in_degrees: true, limits_alone: true, euler: "xyz" };
        for node in source.children(root, "compiler") {
            match node.attribute("angle") {
                Some("radian") => settings.in_degrees = false,
                Some("degree") => settings.in_degrees = true,
                Some(word) => {
                    let message = format!("found angle=\"{word}\" in <compiler>, expected degree or radian");
                    return Err(source.error(node, message));
                }
                None => {}
            }
            if let Some(word) = node.attribute("autolimits") {
                settings.limits_alone = match word {
                    "true" => true,
                    "false" => false,
                    _ => {
                        let message =
                            format!("found autolimits=\"{word}\" in <compiler>, expected true or false");
                        return Err(source.error(node, message));
                    }
                };
            }
            if let Some(order) = node.attribute("eulerseq") {
                let is_order = order.len() == 3 && order.chars().all(|c| "xyzXYZ".contains(c));
                if !is_order {
                    let message = format!(
                        "found eulerseq=\"{order}\" in <compiler>, expected three of x, y, z, X, Y, Z"
                    );
                    return Err(source.error(node, message));
                }
                settings.euler = order;
            }
            if node.attribute("coordinate") == Some("global") {
                let message =
                    "found coordinate=\"global\" in <compiler>, expected local, as MuJoCo itself since 2.3.4";
                return Err(source.error(node, message.to_owned()));
            }
        }
        Ok(settings)
    }

    fn radians(&self, angle: f64) -> f64 {
        if self.in_degrees { angle / 180.0 * PI } else { angle }
    }
}

struct Reader<'a, 'b> {
    source: XmlSource<'a>,
    settings: Settings<'a>,
    /// Blocks of defaults: the element, and the block whose defaults it begins with.
    classes: Vec<(Node<'a, 'a>, Option<usize>)>,
    /// The block of each class.
    defaults: BTreeMap<String, usize>,
    /// The outermost class.
    main: String,
    named: &'b [&'b str],
    links: Links,
    /// Value of each joint in the pose in which bodies are stated.
    references: BTreeMap<String, f64>,
}

/// Something in a body: where it stands in the link, the class of its defaults, and whether the only site is the tip.
struct Inside<'a> {
    link: String,
    link_from_here: Pose,
    class: Option<&'a str>,
    ends_in_site: bool,
}

/// An element of a body, in a frame within the body or not: its pose in the body, and the class of its defaults.
#[derive(Clone, Copy)]
struct Part<'a> {
    node: Node<'a, 'a>,
    body_from_frame: Pose,
    class: Option<&'a str>,
}

impl<'a> Reader<'a, '_> {
    fn read_defaults(&mut self, root: Node<'a, 'a>) -> Result<()> {
        let is_first = self.main.is_empty();
        if is_first {
            self.main = root.attribute("class").unwrap_or("main").to_owned();
        }
        let outer = self.defaults.get(&self.main).copied();
        let mut steps = vec![(root, outer)];
        while let Some((node, outer)) = steps.pop() {
            let class = node.attribute("class").unwrap_or(&self.main).to_owned();
            let index = self.classes.len();
            self.classes.push((node, outer));
            // Only the outermost may be stated in parts.
            if self.defaults.insert(class.clone(), index).is_some() && (node != root || class != self.main) {
                let message = format!("found the class `{class}` a second time, expected each class once");
                return Err(self.source.error(node, message));
            }
            steps.extend(self.source.children(node, "default").map(|child| (child, Some(index))));
        }
        Ok(())
    }

    /// The first element with one of these attributes: the element itself, or the nearest default of its class for elements of this name.
    fn stating_one(
        &self,
        node: Node<'a, 'a>,
        class: Option<&str>,
        tag: &str,
        names: &[&str],
    ) -> Result<Option<Node<'a, 'a>>> {
        let states = |it: &Node<'a, 'a>| names.iter().any(|name| it.has_attribute(*name));
        let stated = node.attribute("class").or(class);
        let first = self.defaults.get(stated.unwrap_or(&self.main)).copied();
        if let (None, Some(class)) = (first, stated) {
            let message = format!("found the class `{class}`, expected one that a <default> has");
            return Err(self.source.error(node, message));
        }
        if states(&node) {
            return Ok(Some(node));
        }
        let mut at = first;
        while let Some((block, outer)) = at.and_then(|at| self.classes.get(at)) {
            let mut own = block.children().filter(|it| it.has_tag_name(tag));
            if let Some(found) = own.find(states) {
                return Ok(Some(found));
            }
            at = *outer;
        }
        Ok(None)
    }

    /// The element that states an attribute.
    fn stating(&self, node: Node<'a, 'a>, class: Option<&str>, name: &str) -> Result<Option<Node<'a, 'a>>> {
        self.stating_one(node, class, node.tag_name().name(), &[name])
    }

    fn word(&self, node: Node<'a, 'a>, class: Option<&str>, name: &str) -> Result<Option<&'a str>> {
        Ok(self.stating(node, class, name)?.and_then(|it| it.attribute(name)))
    }

    fn numbers<const N: usize>(
        &self,
        node: Node<'a, 'a>,
        class: Option<&str>,
        name: &str,
    ) -> Result<Option<[f64; N]>> {
        let Some(stating) = self.stating(node, class, name)? else { return Ok(None) };
        self.source.numbers(stating, name, &described(node))
    }

    /// The pose of an element: `pos`, and one of five ways to say a rotation.
    fn pose(&self, node: Node<'a, 'a>, class: Option<&str>) -> Result<Pose> {
        let position = self.numbers::<3>(node, class, "pos")?.unwrap_or_default();
        let zero = |what: &str| {
            Err(self.source.error(node, format!("found {what} of no length in {}", described(node))))
        };
        // What says the rotation says it alone, whatever farther defaults say.
        let Some(stating) = self.stating_one(node, class, node.tag_name().name(), &ROTATIONS)? else {
            return Ok(Pose::from_translation(position.into()));
        };
        let mut words = ROTATIONS.into_iter().filter(|name| stating.has_attribute(*name));
        let (word, second) = (words.next().unwrap_or_default(), words.next());
        if let Some(second) = second {
            let message =
                format!("found `{word}` and `{second}` in {}, expected one of them", described(node));
            return Err(self.source.error(stating, message));
        }
        let of = described(node);
        let turn = if let Some([w, x, y, z]) = self.source.numbers::<4>(stating, "quat", &of)? {
            if w.abs() + x.abs() + y.abs() + z.abs() == 0.0 {
                return zero("a quaternion");
            }
            return Ok(Pose::from_position_quaternion(position, [x, y, z, w]));
        } else if let Some([x, y, z, angle]) = self.source.numbers::<4>(stating, "axisangle", &of)? {
            let Some(axis) = unit([x, y, z]) else { return zero("an axis") };
            rotation::exp(&(axis.into_inner() * self.settings.radians(angle)))
        } else if let Some(angles) = self.source.numbers::<3>(stating, "euler", &of)? {
            self.euler(angles)
        } else if let Some([a, b, c, d, e, f]) = self.source.numbers::<6>(stating, "xyaxes", &of)? {
            let (x, y) = (unit([a, b, c]), Vector3::new(d, e, f));
            let Some(x) = x else { return zero("an axis") };
            let Some(y) = Unit::try_new(y - *x * x.dot(&y), 1e-12) else { return zero("an axis") };
            Matrix3::from_columns(&[*x, *y, x.cross(&y)])
        } else if let Some(z) = self.source.numbers::<3>(stating, "zaxis", &of)? {
            let Some(z) = unit(z) else { return zero("an axis") };
            // Of a direction against z, MuJoCo turns about x.
            match Unit::try_new(Vector3::z().cross(&z), 1e-7) {
                Some(axis) => rotation::exp(&(axis.into_inner() * Vector3::z().cross(&z).norm().atan2(z.z))),
                None if z.z < 0.0 => rotation::about(0, PI),
                None => Matrix3::identity(),
            }
        } else {
            Matrix3::identity()
        };
        Ok(Pose::new(turn, position.into()))
    }

    /// Lower case turns about the axes as they move, upper case about those that stay.
    fn euler(&self, angles: [f64; 3]) -> Matrix3<f64> {
        let mut turn = Matrix3::identity();
        for (axis, angle) in self.settings.euler.chars().zip(angles) {
            let index = match axis.to_ascii_lowercase() {
                'x' => 0,
                'y' => 1,
                _ => 2,
            };
            let step = rotation::about(index, self.settings.radians(angle));
            turn = if axis.is_ascii_lowercase() { turn * step } else { step * turn };
        }
        turn
    }

    /// Bodies in the world's body.
    fn read_bodies(&mut self, world: Node<'a, 'a>) -> Result<()> {
        let here = Inside {
            link: WORLD.to_owned(),
            link_from_here: Pose::identity(),
            class: world.attribute("childclass"),
            ends_in_site: false,
        };
        // Not recursive: a chain may be longer than the stack.
        let mut steps = vec![(world, here)];
        while let Some((node, here)) = steps.pop() {
            let mut next = Vec::new();
            for child in node.children().filter(Node::is_element) {
                match child.tag_name().name() {
                    "frame" => {
                        let pose = here.link_from_here * self.pose(child, here.class)?;
                        let class = child.attribute("childclass").or(here.class);
                        let ends_in_site = here.ends_in_site;
                        next.push((
                            child,
                            Inside { link: here.link.clone(), link_from_here: pose, class, ends_in_site },
                        ));
                    }
                    "body" => next.push((child, self.read_body(child, &here)?)),
                    "site" => {
                        let name = child.attribute("name").unwrap_or_default();
                        let is_wanted = self.named.contains(&name) && !self.links.has(name);
                        if name.is_empty() || !(here.ends_in_site || is_wanted) {
                            continue;
                        }
                        if self.stating(child, here.class, "fromto")?.is_some() {
                            let message = format!(
                                "found `fromto` of {}, expected a site with a pose of its own",
                                described(child)
                            );
                            return Err(self.source.error(child, message));
                        }
                        let pose = here.link_from_here * self.pose(child, here.class)?;
                        // Bodies and sites may have the same names.
                        let site = if self.links.has(name) {
                            self.links.add_unnamed(&format!("{name}_site"), None)
                        } else {
                            self.links.add(name, None)
                        };
                        self.links.fix(&here.link, &site, pose);
                    }
                    _ => {}
                }
            }
            steps.extend(next.into_iter().rev());
        }
        Ok(())
    }

    /// Elements of a body that count for it, those in frames within it too, in the order of the file.
    fn parts(&self, body: Node<'a, 'a>, class: Option<&'a str>, tags: &[&str]) -> Result<Vec<Part<'a>>> {
        let mut found = Vec::new();
        let own = |node: Node<'a, 'a>, body_from_frame, class| {
            let children: Vec<_> = node.children().filter(Node::is_element).collect();
            children.into_iter().rev().map(move |node| Part { node, body_from_frame, class })
        };
        let mut steps: Vec<Part<'a>> = own(body, Pose::identity(), class).collect();
        while let Some(part) = steps.pop() {
            if part.node.has_tag_name("frame") {
                let body_from_frame = part.body_from_frame * self.pose(part.node, part.class)?;
                steps.extend(own(
                    part.node,
                    body_from_frame,
                    part.node.attribute("childclass").or(part.class),
                ));
            } else if tags.contains(&part.node.tag_name().name()) {
                found.push(part);
            }
        }
        Ok(found)
    }

    /// A body with its joints; what is inside stands in its frame.
    fn read_body(&mut self, node: Node<'a, 'a>, outer: &Inside<'a>) -> Result<Inside<'a>> {
        let class = node.attribute("childclass").or(outer.class);
        let mut parent = outer.link.clone();
        let mut parent_from_body = outer.link_from_here * self.pose(node, outer.class)?;
        for joint in self.parts(node, class, &["joint", "freejoint"])? {
            (parent, parent_from_body) = self.read_joint(joint, (&parent, &parent_from_body), node)?;
        }
        let inertial = self.inertial(node, class)?;
        let link = match node.attribute("name") {
            Some(name) => self.links.add(name, inertial),
            None => self.links.add_unnamed("body", inertial),
        };
        // A joint that goes through the body's frame ends there.
        let is_there = parent_from_body == Pose::identity();
        match self.links.joints.last_mut() {
            Some(last) if is_there && last.child.is_empty() => last.child.clone_from(&link),
            _ => {
                let from = self.link_of_last(&parent, node);
                self.links.fix(&from, &link, parent_from_body);
            }
        }
        let is_leaf = self.parts(node, class, &["body"])?.is_empty();
        let ends_in_site = is_leaf && self.parts(node, class, &["site"])?.len() == 1;
        Ok(Inside { link, link_from_here: Pose::identity(), class, ends_in_site })
    }

    /// The link of the last joint, made where the joint does not end at its body.
    fn link_of_last(&mut self, parent: &str, body: Node<'a, 'a>) -> String {
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

    /// A joint of a body: the frame on its axis, whose link is named by what follows (none yet), and the body in it.
    fn read_joint(
        &mut self,
        Part { node, body_from_frame, class }: Part<'a>,
        (parent, parent_from_body): (&str, &Pose),
        body: Node<'a, 'a>,
    ) -> Result<(String, Pose)> {
        let parent = self.link_of_last(parent, body);
        let kind = match self.word(node, class, "type")?.unwrap_or("hinge") {
            _ if node.has_tag_name("freejoint") => LinkJointKind::Free,
            "hinge" => LinkJointKind::Turns,
            "slide" => LinkJointKind::Slides,
            "free" | "ball" => LinkJointKind::Free,
            word => {
                let message = format!(
                    "found type=\"{word}\" in {}, expected hinge, slide, ball or free",
                    described(node)
                );
                return Err(self.source.error(node, message));
            }
        };
        let turns = kind == LinkJointKind::Turns;
        let angle = |value: f64| if turns { self.settings.radians(value) } else { value };
        let axis = self.numbers::<3>(node, class, "axis")?.unwrap_or([0.0, 0.0, 1.0]);
        let Some(axis) = unit(axis) else {
            return Err(self
                .source
                .error(node, format!("found an axis of no length in {}", described(node))));
        };
        let axis = Unit::new_normalize(body_from_frame.rotation * axis.into_inner());
        let place: Vector3<f64> = match kind {
            LinkJointKind::Turns => {
                let place = self.numbers::<3>(node, class, "pos")?.unwrap_or_default();
                body_from_frame.act(&place.into())
            }
            LinkJointKind::Fixed | LinkJointKind::Slides | LinkJointKind::Free => Vector3::zeros(),
        };
        let reference = angle(self.numbers::<1>(node, class, "ref")?.map_or(0.0, |[it]| it));
        let limited = match self.word(node, class, "limited")? {
            Some("true") => Some(true),
            Some("false") => Some(false),
            Some("auto") | None => None,
            Some(word) => {
                let message =
                    format!("found limited=\"{word}\" of {}, expected true, false or auto", described(node));
                return Err(self.source.error(node, message));
            }
        };
        let range = match self.stating(node, class, "range")? {
            Some(stating) => self.source.bounds::<2>(stating, "range", &described(node))?,
            None => None,
        };
        let counts = limited.unwrap_or(self.settings.limits_alone);
        let range = range.filter(|_| counts).map(|range| range.map(angle));
        let limits = range.and_then(|[lower, upper]| Limits::between(lower, upper));
        let body_from_joint = Pose::from_translation(place);
        // The bodies are stated in the pose in which the joint has its reference.
        let back = match kind {
            LinkJointKind::Turns => {
                Pose::new(rotation::exp(&(-reference * axis.into_inner())), Vector3::zeros())
            }
            LinkJointKind::Slides => Pose::from_translation(-reference * axis.into_inner()),
            LinkJointKind::Fixed | LinkJointKind::Free => Pose::identity(),
        };
        let wanted = format!("{}_joint", body.attribute("name").unwrap_or("body"));
        let name = self.links.joint_name(node.attribute("name"), &wanted);
        self.references.insert(name.clone(), reference);
        self.links.joints.push(LinkJoint {
            name,
            kind,
            parent,
            child: String::new(),
            parent_from_child: *parent_from_body * body_from_joint * back,
            axis,
            limits,
            mimic: None,
        });
        Ok((String::new(), body_from_joint.inverse()))
    }

    fn inertial(&self, body: Node<'a, 'a>, class: Option<&'a str>) -> Result<Option<Inertial>> {
        let parts = self.parts(body, class, &["inertial"])?;
        let Some(&Part { node, body_from_frame, .. }) = parts.first() else { return Ok(None) };
        let Some([kg]) = self.source.numbers::<1>(node, "mass", &described(body))? else { return Ok(None) };
        let pose = body_from_frame * self.pose(node, None)?;
        Ok(Some(Inertial { pose, kg }).filter(|it| Mass::is_mass(it.kg)))
    }

    /// Joints that follow another one: `q₁ − r₁ = a₀ + a₁ (q₂ − r₂)`, with references r.
    fn read_followers(&mut self, equality: Node<'a, 'a>) -> Result<()> {
        for node in self.source.children(equality, "joint") {
            let active = self.stating_one(node, None, "equality", &["active"])?;
            if active.is_some_and(|it| it.attribute("active") == Some("false")) {
                continue;
            }
            let joint = |name: &str| {
                let Some(joint) = node.attribute(name) else { return Ok(None) };
                match self.references.get(joint) {
                    Some(reference) => Ok(Some((joint, *reference))),
                    None => {
                        let message = format!("found {name}=\"{joint}\", expected the name of a joint");
                        Err(self.source.error(node, message))
                    }
                }
            };
            let Some((follower, own)) = joint("joint1")? else {
                let message =
                    "<joint> of <equality> has no attribute `joint1`, expected the joint that follows";
                return Err(self.source.error(node, message.to_owned()));
            };
            let leader = joint("joint2")?;
            // What is not stated stays as it is.
            let mut at = [0.0, 1.0, 0.0, 0.0, 0.0];
            let words: Vec<&str> =
                node.attribute("polycoef").unwrap_or_default().split_whitespace().collect();
            for (k, word) in words.iter().enumerate() {
                match (at.get_mut(k), word.parse::<f64>()) {
                    (Some(number), Ok(value)) if value.is_finite() => *number = value,
                    _ => {
                        let message =
                            format!("found polycoef=\"{}\", expected up to 5 numbers", words.join(" "));
                        return Err(self.source.error(node, message));
                    }
                }
            }
            let is_line = at[2..].iter().all(|it| *it == 0.0);
            let Some(joint) = self.links.joints.iter_mut().find(|joint| joint.name == follower) else {
                continue;
            };
            match leader {
                // No other relation is one of a URDF: a chain over such a joint is refused.
                Some(_) if !is_line => joint.kind = LinkJointKind::Free,
                Some((leader, other)) if at[1] != 0.0 => {
                    let offset = own + at[0] - at[1] * other;
                    joint.mimic = Some(Mimic { joint: leader.to_owned(), multiplier: at[1], offset });
                }
                _ => {
                    let motion = match joint.kind {
                        LinkJointKind::Turns => {
                            let turn = rotation::exp(&(joint.axis.into_inner() * (own + at[0])));
                            Pose::new(turn, Vector3::zeros())
                        }
                        LinkJointKind::Slides => {
                            Pose::from_translation(joint.axis.into_inner() * (own + at[0]))
                        }
                        LinkJointKind::Fixed | LinkJointKind::Free => continue,
                    };
                    joint.parent_from_child = joint.parent_from_child * motion;
                    joint.kind = LinkJointKind::Fixed;
                    joint.limits = None;
                }
            }
        }
        Ok(())
    }
}

/// An element in messages.
fn described(node: Node<'_, '_>) -> String {
    let tag = node.tag_name().name();
    match node.attribute("name") {
        Some(name) => format!("<{tag}> `{name}`"),
        None => format!("a <{tag}> without name"),
    }
}

fn unit(direction: [f64; 3]) -> Option<Unit<Vector3<f64>>> {
    Unit::try_new(Vector3::from(direction), 1e-12)
}
