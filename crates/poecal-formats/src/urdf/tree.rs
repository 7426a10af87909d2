//! Tree of links and joints, checked.

use std::collections::BTreeMap;

use roxmltree::Node;

use poecal_numerics::error::{Result, nearest_or_all};
use poecal_storage::xml::XmlSource;

/// The types of joints in URDF.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum JointType {
    Fixed,
    Revolute,
    Continuous,
    Prismatic,
    Floating,
    Planar,
}

impl JointType {
    const WORDS: [(&'static str, JointType); 6] = [
        ("revolute", JointType::Revolute),
        ("continuous", JointType::Continuous),
        ("prismatic", JointType::Prismatic),
        ("fixed", JointType::Fixed),
        ("floating", JointType::Floating),
        ("planar", JointType::Planar),
    ];

    fn of_word(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(known, _)| *known == word).map(|&(_, kind)| kind)
    }

    pub(crate) fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, kind)| *kind == self).map_or("", |&(word, _)| word)
    }

    /// True if the joint has one degree of freedom.
    pub(crate) fn moves(self) -> bool {
        matches!(self, JointType::Revolute | JointType::Continuous | JointType::Prismatic)
    }
}

/// A joint between two links, which are indices into [`UrdfTree::links`].
pub(crate) struct TreeJoint<'a> {
    pub(crate) name: &'a str,
    pub(crate) kind: JointType,
    pub(crate) parent: usize,
    pub(crate) child: usize,
    pub(crate) node: Node<'a, 'a>,
}

/// All links and joints; every link has at most one parent joint, and there is no loop.
pub(crate) struct UrdfTree<'a> {
    pub(crate) source: XmlSource<'a>,
    pub(crate) links: Vec<&'a str>,
    pub(crate) joints: Vec<TreeJoint<'a>>,
    /// Parent joint of each link.
    joint_above: Vec<Option<usize>>,
    link_indices: BTreeMap<&'a str, usize>,
    joint_indices: BTreeMap<&'a str, usize>,
}

impl<'a> UrdfTree<'a> {
    pub(crate) fn read(source: XmlSource<'a>) -> Result<Self> {
        let robot = source.document.root_element();
        let (mut links, mut link_indices) = (Vec::new(), BTreeMap::new());
        for node in source.children(robot, "link") {
            let (name, _) = source.require_attribute(node, "name", "the link")?;
            if link_indices.insert(name, links.len()).is_some() {
                let message = format!("found a second link named `{name}`, expected unique link names");
                return Err(source.error(node, message));
            }
            links.push(name);
        }
        let mut tree = UrdfTree {
            source,
            joint_above: vec![None; links.len()],
            links,
            joints: Vec::new(),
            link_indices,
            joint_indices: BTreeMap::new(),
        };
        for node in source.children(robot, "joint") {
            let joint = read_joint(source, node, &tree.link_indices)?;
            if tree.joint_indices.insert(joint.name, tree.joints.len()).is_some() {
                let message = format!("found a second joint named `{}`, expected unique joint names", joint.name);
                return Err(source.error(node, message));
            }
            tree.add(joint)?;
        }
        tree.check_no_loop()?;
        Ok(tree)
    }

    fn add(&mut self, joint: TreeJoint<'a>) -> Result<()> {
        let index = self.joints.len();
        if let Some(above) = self.joint_above.get_mut(joint.child) {
            if let Some(first) = above.and_then(|first| self.joints.get(first)) {
                let message = format!(
                    "link `{}` is the child of joint `{}` and again of joint `{}`, expected one parent: a closed chain cannot be read",
                    self.link_name(joint.child),
                    first.name,
                    joint.name
                );
                return Err(self.source.error(joint.node, message));
            }
            *above = Some(index);
        }
        self.joints.push(joint);
        Ok(())
    }

    /// Parent joint of a link, with its index.
    pub(crate) fn parent_joint(&self, link: usize) -> Option<(usize, &TreeJoint<'a>)> {
        let index = self.joint_above.get(link).copied().flatten()?;
        Some((index, self.joints.get(index)?))
    }

    /// Joints above a link, upwards.
    pub(crate) fn ancestors(&self, link: usize) -> impl Iterator<Item = (usize, &TreeJoint<'a>)> {
        std::iter::successors(self.parent_joint(link), |(_, joint)| self.parent_joint(joint.parent))
    }

    pub(crate) fn link_name(&self, link: usize) -> &'a str {
        self.links.get(link).copied().unwrap_or("")
    }

    pub(crate) fn link(&self, name: &str) -> Option<usize> {
        self.link_indices.get(name).copied()
    }

    pub(crate) fn joint_index(&self, name: &str) -> Option<usize> {
        self.joint_indices.get(name).copied()
    }

    pub(crate) fn joint(&self, name: &str) -> Option<&TreeJoint<'a>> {
        self.joints.get(self.joint_index(name)?)
    }

    /// Checks that every path upwards ends: the links of a loop, each with one parent, have no root above them.
    fn check_no_loop(&self) -> Result<()> {
        let mut rooted = vec![false; self.links.len()];
        for link in 0..self.links.len() {
            let above = self.ancestors(link).map(|(_, joint)| joint.parent);
            let way = std::iter::once(link).chain(above).take_while(|&at| !rooted[at]);
            // A path longer than the number of links visits one of them twice.
            let way: Vec<usize> = way.take(self.links.len() + 1).collect();
            if let Some((_, joint)) = way.get(self.links.len()).and_then(|&at| self.parent_joint(at)) {
                let message =
                    format!("joint `{}` closes a loop of links, expected a tree with one root link", joint.name);
                return Err(self.source.error(joint.node, message));
            }
            way.into_iter().for_each(|at| rooted[at] = true);
        }
        Ok(())
    }
}

fn read_joint<'a>(
    source: XmlSource<'a>,
    node: Node<'a, 'a>,
    links: &BTreeMap<&'a str, usize>,
) -> Result<TreeJoint<'a>> {
    let (name, _) = source.require_attribute(node, "name", "the joint")?;
    let of = format!("joint `{name}`");
    let (word, attribute) = source.require_attribute(node, "type", &of)?;
    let kind = JointType::of_word(word).ok_or_else(|| {
        let message =
            format!("{of} has type `{word}`, expected revolute, continuous, prismatic, fixed, floating or planar");
        source.error_at(attribute.range_value().start, message)
    })?;
    let link = |role: &'static str| -> Result<usize> {
        let Some(element) = source.only_child(node, role, &of, false)? else {
            return Err(source.error(node, format!("{of} has no <{role}>, expected <{role} link=\"...\"/>")));
        };
        let (link, attribute) = source.require_attribute(element, "link", &format!("<{role}> of {of}"))?;
        links.get(link).copied().ok_or_else(|| {
            let names: Vec<&str> = links.keys().copied().collect();
            let known = nearest_or_all(link, &names);
            let message = format!("{of} names link `{link}`, expected a link of this file, {known}");
            source.error_at(attribute.range_value().start, message)
        })
    };
    Ok(TreeJoint { name, kind, parent: link("parent")?, child: link("child")?, node })
}
