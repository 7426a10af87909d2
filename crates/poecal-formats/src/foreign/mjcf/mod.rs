//! MuJoCo's model. A body is a link; its joints, in their order, connect it to the outer body.

mod defaults;
mod elements;
mod joints;

use std::collections::BTreeMap;
use std::path::Path;

use roxmltree::Node;

use super::links::{Inertial, LinkTree};
use crate::unread_elements;
use defaults::{CompilerSettings, ElementClass, MjcfDefaults};
use elements::{describe_element, unit};
use poecal_arm::lie::Pose;
use poecal_model::robot::Mass;
use poecal_numerics::error::Result;
use poecal_storage::xml::{XmlSource, declare_prefixes, parsed};

/// The body around all bodies.
const WORLD: &str = "world";
/// Expected model, in errors.
const EXPECTED: &str = "a model of MuJoCo";
/// Elements that MuJoCo replaces by others when it compiles the model.
const MADE_BY_MUJOCO: [&str; 4] = ["include", "replicate", "attach", "composite"];

/// The links; sites of these names are links too.
pub(crate) fn read(text: &str, path: &Path, named: &[&str]) -> Result<LinkTree> {
    let text = declare_prefixes(text);
    let document = parsed(&text, path, EXPECTED)?;
    let source = XmlSource { document: &document, path };
    let root = document.root_element();
    if root.has_tag_name("mujocoinclude") {
        let message = "found a part of a model (<mujocoinclude>), expected the model that includes it, saved whole by MuJoCo: \
             mujoco.mj_saveLastXML(\"whole.xml\", model)";
        return Err(source.syntax_error(root, message));
    }
    if let Some(node) = root.descendants().find(|node| MADE_BY_MUJOCO.contains(&node.tag_name().name())) {
        let message = format!(
            "found <{}>, expected bodies alone: save the whole model with MuJoCo, mujoco.mj_saveLastXML(\"whole.xml\", model)",
            node.tag_name().name()
        );
        return Err(source.syntax_error(node, message));
    }
    let settings = CompilerSettings::read(&source, root)?;
    let mut reader = MjcfReader {
        defaults: MjcfDefaults::read(source, settings, root)?,
        named,
        links: LinkTree::new(root.attribute("model").unwrap_or("robot")),
        references: BTreeMap::new(),
    };
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
    reader.links.unread = unread_elements::sentence(&source, root, unread_elements::MJCF)?;
    Ok(reader.links)
}

struct MjcfReader<'a, 'b> {
    defaults: MjcfDefaults<'a>,
    named: &'b [&'b str],
    links: LinkTree,
    /// Value of each joint in the pose in which bodies are stated.
    references: BTreeMap<String, f64>,
}

/// Contents of a body: their pose in the link, the class of their defaults, and whether the only site is the tip.
#[derive(Clone)]
struct BodyItem<'a> {
    link: String,
    link_from_here: Pose,
    class: Option<&'a str>,
    ends_in_site: bool,
}

/// An element of a body, in a frame within the body or not: its pose in the body.
#[derive(Clone, Copy)]
struct BodyElement<'a> {
    stated: ElementClass<'a>,
    body_from_frame: Pose,
}

impl<'a> MjcfReader<'a, '_> {
    /// Bodies in the world's body.
    fn read_bodies(&mut self, world: Node<'a, 'a>) -> Result<()> {
        let here = BodyItem {
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
                let stated = ElementClass { node: child, class: here.class };
                match child.tag_name().name() {
                    "frame" => {
                        let link_from_here = here.link_from_here * self.defaults.pose(stated)?;
                        let class = child.attribute("childclass").or(here.class);
                        next.push((child, BodyItem { link_from_here, class, ..here.clone() }));
                    }
                    "body" => next.push((child, self.read_body(stated, &here)?)),
                    "site" => self.read_site(stated, &here)?,
                    _ => {}
                }
            }
            steps.extend(next.into_iter().rev());
        }
        Ok(())
    }

    /// Reads a site as a link, if it is named or the only one at the end of a chain.
    fn read_site(&mut self, site: ElementClass<'a>, here: &BodyItem<'a>) -> Result<()> {
        let name = site.node.attribute("name").unwrap_or_default();
        let is_wanted = self.named.contains(&name) && !self.links.has(name);
        if name.is_empty() || !(here.ends_in_site || is_wanted) {
            return Ok(());
        }
        if self.defaults.find_stating(site, "fromto")?.is_some() {
            let of = describe_element(site.node);
            let message = format!("found `fromto` of {of}, expected a site with a pose of its own");
            return self.defaults.source.refuse(site.node, message);
        }
        let pose = here.link_from_here * self.defaults.pose(site)?;
        // Bodies and sites may have the same names.
        let link = if self.links.has(name) {
            self.links.add_unnamed(&format!("{name}_site"), None)
        } else {
            self.links.add(name, None)
        };
        self.links.fix(&here.link, &link, pose);
        Ok(())
    }

    /// Elements of a body that belong to it, also those in frames within it, in the order of the file.
    fn parts(&self, body: ElementClass<'a>, tags: &[&str]) -> Result<Vec<BodyElement<'a>>> {
        let mut found = Vec::new();
        let own = |of: ElementClass<'a>, body_from_frame| {
            let children: Vec<_> = of.node.children().filter(Node::is_element).collect();
            let part = move |node| BodyElement { stated: ElementClass { node, ..of }, body_from_frame };
            children.into_iter().rev().map(part)
        };
        let mut steps: Vec<BodyElement<'a>> = own(body, Pose::identity()).collect();
        while let Some(part) = steps.pop() {
            let ElementClass { node, class } = part.stated;
            if node.has_tag_name("frame") {
                let body_from_frame = part.body_from_frame * self.defaults.pose(part.stated)?;
                let class = node.attribute("childclass").or(class);
                steps.extend(own(ElementClass { node, class }, body_from_frame));
            } else if tags.contains(&node.tag_name().name()) {
                found.push(part);
            }
        }
        Ok(found)
    }

    /// Reads a body with its joints; its contents are in its frame.
    fn read_body(&mut self, body: ElementClass<'a>, outer: &BodyItem<'a>) -> Result<BodyItem<'a>> {
        let node = body.node;
        let class = node.attribute("childclass").or(body.class);
        let own = ElementClass { node, class };
        let mut parent = outer.link.clone();
        let mut parent_from_body = outer.link_from_here * self.defaults.pose(body)?;
        for joint in self.parts(own, &["joint", "freejoint"])? {
            (parent, parent_from_body) = self.read_joint(joint, (&parent, &parent_from_body), node)?;
        }
        let inertial = self.inertial(own)?;
        let link = match node.attribute("name") {
            Some(name) => self.links.add(name, inertial),
            None => self.links.add_unnamed("body", inertial),
        };
        // A joint through the origin of the body's frame ends there.
        let is_there = parent_from_body == Pose::identity();
        match self.links.joints.last_mut() {
            Some(last) if is_there && last.child.is_empty() => last.child.clone_from(&link),
            _ => {
                let from = self.link_of_last(&parent, node);
                self.links.fix(&from, &link, parent_from_body);
            }
        }
        let is_leaf = self.parts(own, &["body"])?.is_empty();
        let ends_in_site = is_leaf && self.parts(own, &["site"])?.len() == 1;
        Ok(BodyItem { link, link_from_here: Pose::identity(), class, ends_in_site })
    }

    fn inertial(&self, body: ElementClass<'a>) -> Result<Option<Inertial>> {
        let parts = self.parts(body, &["inertial"])?;
        let Some(&BodyElement { stated: ElementClass { node, .. }, body_from_frame }) = parts.first() else {
            return Ok(None);
        };
        let kg = self.defaults.source.number(node, "mass", &describe_element(body.node))?;
        let Some(kg) = kg else { return Ok(None) };
        let pose = body_from_frame * self.defaults.pose(ElementClass { node, class: None })?;
        Ok(Some(Inertial { pose, kg }).filter(|it| Mass::is_mass(it.kg)))
    }
}
