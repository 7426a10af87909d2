//! MuJoCo's model. A body is a link; between it and the body around it stand its joints, in their order.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::Path;

use nalgebra::{Matrix3, Unit, Vector3};
use roxmltree::Node;

use super::links::{Inertial, LinkJoint, LinkJointKind, Links, Mimic};
use crate::error::Result;
use crate::io::xml::{XmlSource, parsed};
use crate::lie::{Pose, rotation};
use crate::robot::{Limits, Mass};

/// The body around all bodies.
const WORLD: &str = "world";
/// What is read.
const EXPECTED: &str = "a model of MuJoCo";
/// Elements that stand for others, which MuJoCo makes when it compiles the model.
const MADE_BY_MUJOCO: [&str; 4] = ["include", "replicate", "attach", "composite"];

/// The links; sites of these names are links too.
pub(super) fn read(text: &str, path: &Path, named: &[&str]) -> Result<Links> {
    let document = parsed(text, path, EXPECTED)?;
    let source = XmlSource { document: &document, path };
    let root = document.root_element();
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
        defaults: BTreeMap::new(),
        main: String::new(),
        named,
        links: Links::new(root.attribute("model").unwrap_or("robot")),
        references: BTreeMap::new(),
    };
    for node in source.children(root, "default") {
        reader.read_defaults(node, &[])?;
    }
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
                settings.limits_alone = word == "true";
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
    /// Elements of each class of defaults, the nearest first.
    defaults: BTreeMap<String, Vec<Node<'a, 'a>>>,
    /// The outermost class.
    main: String,
    named: &'b [&'b str],
    links: Links,
    /// Value of each joint in the pose in which bodies are stated.
    references: BTreeMap<String, f64>,
}

/// Something in a body: where it stands in the link, and the class of its defaults.
struct Inside<'a> {
    link: String,
    link_from_here: Pose,
    class: Option<&'a str>,
}

impl<'a> Reader<'a, '_> {
    fn read_defaults(&mut self, root: Node<'a, 'a>, outer: &[Node<'a, 'a>]) -> Result<()> {
        let mut steps = vec![(root, outer.to_vec())];
        while let Some((node, outer)) = steps.pop() {
            let own: Vec<Node<'a, 'a>> = node
                .children()
                .filter(|child| child.is_element() && !child.has_tag_name("default"))
                .collect();
            let all: Vec<Node<'a, 'a>> = own.into_iter().chain(outer).collect();
            if node == root && self.main.is_empty() {
                self.main = node.attribute("class").unwrap_or("main").to_owned();
            }
            let name = node.attribute("class").unwrap_or(&self.main).to_owned();
            self.defaults.entry(name).or_default().extend(all.iter().copied());
            steps.extend(self.source.children(node, "default").map(|child| (child, all.clone())));
        }
        Ok(())
    }

    /// The element that states an attribute: the element itself, or the nearest default of its class.
    fn stating(&self, node: Node<'a, 'a>, class: Option<&str>, name: &str) -> Option<Node<'a, 'a>> {
        if node.has_attribute(name) {
            return Some(node);
        }
        let class = node.attribute("class").or(class).unwrap_or(&self.main);
        let tag = node.tag_name().name();
        let defaults = self.defaults.get(class).map_or(&[][..], Vec::as_slice);
        defaults.iter().copied().find(|it| it.has_tag_name(tag) && it.has_attribute(name))
    }

    fn word(&self, node: Node<'a, 'a>, class: Option<&str>, name: &str) -> Option<&'a str> {
        self.stating(node, class, name)?.attribute(name)
    }

    fn numbers<const N: usize>(
        &self,
        node: Node<'a, 'a>,
        class: Option<&str>,
        name: &str,
    ) -> Result<Option<[f64; N]>> {
        let Some(stating) = self.stating(node, class, name) else { return Ok(None) };
        self.source.numbers(stating, name, &described(node))
    }

    /// The pose of an element: `pos`, and one of five ways to say a rotation.
    fn pose(&self, node: Node<'a, 'a>, class: Option<&str>) -> Result<Pose> {
        let position = self.numbers::<3>(node, class, "pos")?.unwrap_or_default();
        let zero = |what: &str| {
            Err(self.source.error(node, format!("found {what} of no length in {}", described(node))))
        };
        let turn = if let Some([w, x, y, z]) = self.numbers::<4>(node, class, "quat")? {
            if w.abs() + x.abs() + y.abs() + z.abs() == 0.0 {
                return zero("a quaternion");
            }
            return Ok(Pose::from_position_quaternion(position, [x, y, z, w]));
        } else if let Some([x, y, z, angle]) = self.numbers::<4>(node, class, "axisangle")? {
            let Some(axis) = unit([x, y, z]) else { return zero("an axis") };
            rotation::exp(&(axis.into_inner() * self.settings.radians(angle)))
        } else if let Some(angles) = self.numbers::<3>(node, class, "euler")? {
            self.euler(angles)
        } else if let Some([a, b, c, d, e, f]) = self.numbers::<6>(node, class, "xyaxes")? {
            let (x, y) = (unit([a, b, c]), Vector3::new(d, e, f));
            let Some(x) = x else { return zero("an axis") };
            let Some(y) = Unit::try_new(y - *x * x.dot(&y), 1e-12) else { return zero("an axis") };
            Matrix3::from_columns(&[*x, *y, x.cross(&y)])
        } else if let Some(z) = self.numbers::<3>(node, class, "zaxis")? {
            let Some(z) = unit(z) else { return zero("an axis") };
            rotation::shortest_arc(&Vector3::z(), &z)
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
        };
        // Not recursive: a chain may be longer than the stack.
        let mut steps = vec![(world, here)];
        while let Some((node, here)) = steps.pop() {
            let mut next = Vec::new();
            let sites = node.children().filter(|it| it.has_tag_name("site")).count();
            let is_leaf =
                node.has_tag_name("body") && !node.descendants().skip(1).any(|it| it.has_tag_name("body"));
            for child in node.children().filter(Node::is_element) {
                match child.tag_name().name() {
                    "frame" => {
                        let pose = here.link_from_here * self.pose(child, here.class)?;
                        let class = child.attribute("childclass").or(here.class);
                        next.push((child, Inside { link: here.link.clone(), link_from_here: pose, class }));
                    }
                    "body" => next.push((child, self.read_body(child, &here)?)),
                    "site" => {
                        let name = child.attribute("name").unwrap_or_default();
                        let is_tip = is_leaf && sites == 1 && !name.is_empty();
                        if (is_tip || self.named.contains(&name)) && !self.links.has(name) {
                            let pose = here.link_from_here * self.pose(child, here.class)?;
                            let site = self.links.add(name, None);
                            self.links.fix(&here.link, &site, pose);
                        }
                    }
                    _ => {}
                }
            }
            steps.extend(next.into_iter().rev());
        }
        Ok(())
    }

    /// A body with its joints; what is inside stands in its frame.
    fn read_body(&mut self, node: Node<'a, 'a>, outer: &Inside<'a>) -> Result<Inside<'a>> {
        let class = node.attribute("childclass").or(outer.class);
        let name = node.attribute("name").unwrap_or("body");
        let mut parent = outer.link.clone();
        let mut parent_from_body = outer.link_from_here * self.pose(node, outer.class)?;
        let joints: Vec<Node<'a, 'a>> = node
            .children()
            .filter(|child| child.has_tag_name("joint") || child.has_tag_name("freejoint"))
            .collect();
        let inertial = self.inertial(node)?;
        let (last, before) = match joints.split_last() {
            Some((last, before)) => (Some(last), before),
            None => (None, &[][..]),
        };
        for (at, &joint) in before.iter().enumerate() {
            let link = format!("{name}_{}", at + 1);
            let (link, pose) = self.read_joint(joint, class, (&parent, &parent_from_body), &link, None)?;
            (parent, parent_from_body) = (link, pose);
        }
        let Some(&last) = last else {
            let link = self.links.add(name, inertial);
            self.links.fix(&parent, &link, parent_from_body);
            return Ok(Inside { link, link_from_here: Pose::identity(), class });
        };
        let (link, link_from_here) =
            self.read_joint(last, class, (&parent, &parent_from_body), name, inertial)?;
        Ok(Inside { link, link_from_here, class })
    }

    /// A joint: its link, which stands on the axis, and the body in it.
    fn read_joint(
        &mut self,
        node: Node<'a, 'a>,
        class: Option<&str>,
        (parent, parent_from_body): (&str, &Pose),
        link: &str,
        inertial: Option<Inertial>,
    ) -> Result<(String, Pose)> {
        let kind = match self.word(node, class, "type").unwrap_or("hinge") {
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
        let place: Vector3<f64> = match kind {
            LinkJointKind::Turns => self.numbers::<3>(node, class, "pos")?.unwrap_or_default().into(),
            LinkJointKind::Fixed | LinkJointKind::Slides | LinkJointKind::Free => Vector3::zeros(),
        };
        let reference = angle(self.numbers::<1>(node, class, "ref")?.map_or(0.0, |[it]| it));
        let limits = match (self.word(node, class, "limited"), self.numbers::<2>(node, class, "range")?) {
            (Some("false"), _) | (_, None) => None,
            (None | Some("auto"), Some(_)) if !self.settings.limits_alone => None,
            (_, Some(range)) => {
                let [lower, upper] = range.map(angle);
                (lower < upper).then_some(Limits { lower, upper })
            }
        };
        let body_from_joint = Pose::from_translation(place);
        // The bodies are stated in the pose in which the joint has its reference.
        let back = match kind {
            LinkJointKind::Turns => {
                Pose::new(rotation::exp(&(-reference * axis.into_inner())), Vector3::zeros())
            }
            LinkJointKind::Slides => Pose::from_translation(-reference * axis.into_inner()),
            LinkJointKind::Fixed | LinkJointKind::Free => Pose::identity(),
        };
        let joint_from_body = body_from_joint.inverse();
        let inertial = inertial.map(|Inertial { pose, kg }| Inertial { pose: joint_from_body * pose, kg });
        let child = self.links.add(link, inertial);
        let mut name = node.attribute("name").map_or_else(|| format!("{child}_joint"), str::to_owned);
        while self.references.contains_key(&name) {
            name.push('_');
        }
        self.references.insert(name.clone(), reference);
        self.links.joints.push(LinkJoint {
            name,
            kind,
            parent: parent.to_owned(),
            child: child.clone(),
            parent_from_child: *parent_from_body * body_from_joint * back,
            axis,
            limits,
            mimic: None,
        });
        Ok((child, joint_from_body))
    }

    fn inertial(&self, body: Node<'a, 'a>) -> Result<Option<Inertial>> {
        let Some(node) = self.source.children(body, "inertial").next() else { return Ok(None) };
        let Some([kg]) = self.source.numbers::<1>(node, "mass", &described(body))? else { return Ok(None) };
        let pose = self.pose(node, None)?;
        Ok(Some(Inertial { pose, kg }).filter(|it| Mass::is_mass(it.kg)))
    }

    /// Joints that follow another one: `q₁ − r₁ = a₀ + a₁ (q₂ − r₂)`, with references r.
    fn read_followers(&mut self, equality: Node<'a, 'a>) -> Result<()> {
        for node in self.source.children(equality, "joint") {
            let (Some(follower), Some(leader)) = (node.attribute("joint1"), node.attribute("joint2")) else {
                continue;
            };
            let words = node.attribute("polycoef").unwrap_or("0 1 0 0 0");
            let numbers: Vec<f64> = words.split_whitespace().filter_map(|word| word.parse().ok()).collect();
            let at = |k: usize| numbers.get(k).copied().unwrap_or(0.0);
            let is_line = (2..5).all(|k| at(k) == 0.0) && numbers.iter().all(|number| number.is_finite());
            let active = node.attribute("active") != Some("false");
            let references = (self.references.get(follower), self.references.get(leader));
            let (Some(own), Some(other)) = references else { continue };
            if !is_line || !active || at(1) == 0.0 {
                continue;
            }
            let multiplier = numbers.get(1).copied().unwrap_or(1.0);
            let mimic =
                Mimic { joint: leader.to_owned(), multiplier, offset: own + at(0) - multiplier * other };
            if let Some(joint) = self.links.joints.iter_mut().find(|joint| joint.name == follower) {
                joint.mimic = Some(mimic);
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
