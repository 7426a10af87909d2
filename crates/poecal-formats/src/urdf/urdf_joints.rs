//! Joints of the chain or tree: origins, axes, limits and mimic relations, with their positions in the text.

use std::collections::BTreeMap;
use std::ops::Range;

use nalgebra::Vector3;
use roxmltree::Node;

use super::chain::UrdfChain;
use super::tree::{JointType, TreeJoint, UrdfTree};
use crate::mimic;
use poecal_arm::lie::Pose;
use poecal_model::robot::{Body, Joint, JointKind, JointLimits, Mass, Reading, Robot, check_name};
use poecal_numerics::error::{Result, first_few, nearest_or_all};
use poecal_storage::xml::{XmlSource, value_range};

/// A fixed or moving joint, with its positions in the text for changes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct UrdfJoint {
    /// Name of the joint.
    pub(crate) name: String,
    /// The joint above its parent link; `None` for the base.
    pub(crate) parent: Option<usize>,
    /// `<origin>`: pose of the joint's frame in its parent link.
    pub(crate) parent_from_joint: Pose,
    /// Unit `<axis>` in the joint's frame; `None` for a fixed joint.
    pub(crate) axis: Option<Vector3<f64>>,
    /// Length of the axis in the text.
    pub(crate) axis_length: f64,
    /// True for a revolute or prismatic joint without a range, which other readers refuse or hold at 0.
    pub(crate) is_without_range: bool,
    /// True if its origin has a quaternion that does not count in this version of URDF.
    pub(crate) has_idle_quaternion: bool,
    pub(crate) place: JointSpans,
}

/// Longer or shorter axes are not rounded unit vectors.
const ROUNDED_AXIS: f64 = 1e-6;
/// Differences of lengths that are mistakes.
const WRONG_AXIS: f64 = 1e-3;

impl UrdfJoint {
    /// True if the axis in the text is a unit vector.
    pub(crate) fn has_unit_axis(&self) -> bool {
        (self.axis_length - 1.0).abs() < ROUNDED_AXIS
    }
}

/// Properties of these joints that other readers understand differently, a sentence each.
pub(crate) fn remarks(parts: &[UrdfJoint]) -> Vec<String> {
    let list = |is: &dyn Fn(&UrdfJoint) -> bool, words: &dyn Fn(&UrdfJoint) -> String| {
        let found: Vec<String> = parts.iter().filter(|it| is(it)).map(words).collect();
        (!found.is_empty()).then(|| first_few(&found))
    };
    let name = |it: &UrdfJoint| format!("`{}`", it.name);
    let lengths = list(&|it| (it.axis_length - 1.0).abs() > WRONG_AXIS, &|it| {
        format!("`{}` (length {})", it.name, (1e4 * it.axis_length).round() / 1e4)
    });
    let ranges = list(&|it| it.is_without_range, &name);
    let quaternions = list(&|it| it.has_idle_quaternion, &name);
    [
        lengths.map(|it| {
            format!("took only the direction of axes that are no unit vectors, by which others scale the motion: {it}")
        }),
        ranges.map(|it| {
            format!(
                "joints without `lower` and `upper`, which others refuse or hold at 0: {it}; state them, or type=\"continuous\" if the joint turns without end"
            )
        }),
        quaternions.map(|it| {
            format!(
                "ignored `quat_xyzw` in the origins of {it}, which counts from version 1.1 of URDF on: state <robot version=\"1.1\"> if it is meant"
            )
        }),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Byte offsets in the text of a joint.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct JointSpans {
    /// The whole `<joint>` element.
    pub(crate) element: Range<usize>,
    /// Start of its first child element.
    pub(crate) first_child: usize,
    /// The byte after `<origin`.
    pub(crate) origin: Option<usize>,
    pub(crate) xyz: Option<Range<usize>>,
    /// The rotation's numbers: roll, pitch and yaw, or a quaternion.
    pub(crate) rpy: Option<Range<usize>>,
    pub(crate) is_quaternion: bool,
    /// The joint's `type`.
    pub(crate) kind: Option<Range<usize>>,
    /// The byte after `<axis`.
    pub(crate) axis: Option<usize>,
    pub(crate) axis_xyz: Option<Range<usize>>,
}

/// A named link: the tip's, an instrument's or a target's.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NamedLink {
    /// Name of the link.
    pub(crate) link: String,
    /// The joint above it; `None` for the base.
    pub(crate) part: Option<usize>,
}

/// Pose of a link.
#[derive(Clone, Copy)]
struct LinkLocation {
    base_from_link: Pose,
    part: Option<usize>,
    body: Body,
}

/// The joints in their order, the ends, and the robot of the moving joints with frames and screws in the base link. The pose is in the base link,
/// of the link from which the chain leads down.
pub(crate) fn read(
    tree: &UrdfTree,
    chain: &UrdfChain,
    name: &str,
) -> Result<(Vec<UrdfJoint>, Vec<NamedLink>, Robot, Pose)> {
    // The walk goes from the base up to the link from which the chain leads down.
    let (mut base_from_top, mut top) = (Pose::identity(), chain.base);
    for joint in chain.up.iter().filter_map(|&joint| tree.joints.get(joint)) {
        base_from_top = base_from_top * read_part(&tree.source, joint)?.parent_from_joint.inverse();
        top = joint.parent;
    }
    let base = LinkLocation { base_from_link: base_from_top, part: None, body: Body::Base };
    let mut links = BTreeMap::from([(top, base)]);
    links.entry(chain.base).or_insert(LinkLocation { base_from_link: Pose::identity(), ..base });
    let (mut parts, mut joints) = (Vec::new(), Vec::new());
    for joint in chain.joints.iter().filter_map(|&joint| tree.joints.get(joint)) {
        let parent = links.get(&joint.parent).copied().unwrap_or(base);
        let mut part = read_part(&tree.source, joint)?;
        part.parent = parent.part;
        let base_from_link = parent.base_from_link * part.parent_from_joint;
        let mut body = parent.body;
        if let Some(axis) = part.axis {
            let before = joints.len().checked_sub(1).map_or(Body::Base, Body::Link);
            body = Body::Link(joints.len());
            let stands_on = Some(parent.body).filter(|&stands_on| stands_on != before);
            joints.push(Joint { stands_on, ..moving_joint(tree, joint, &axis, base_from_link)? });
        }
        links.insert(joint.child, LinkLocation { base_from_link, part: Some(parts.len()), body });
        parts.push(part);
    }
    let at = |link: usize| links.get(&link).copied().unwrap_or(base);
    let tip = at(chain.tip);
    let mut robot = Robot::new(name, joints, tip.base_from_link).map_err(|error| error.in_file(tree.source.path))?;
    tree.link_name(chain.base).clone_into(&mut robot.base_name);
    tree.link_name(chain.tip).clone_into(&mut robot.tip_name);
    robot.tip = Some(tip.body).filter(|&body| body != robot.tip_body());
    let mount = |(name, link): &(String, usize)| {
        let LinkLocation { base_from_link, body, .. } = at(*link);
        check_name(name, "frame").map_err(|error| error.in_file(tree.source.path))?;
        Ok(robot.mount(name, body, &base_from_link))
    };
    let instruments = chain.instruments.iter().map(mount).collect::<Result<_>>()?;
    let mounted = chain.targets.iter().map(mount).collect::<Result<_>>()?;
    (robot.instruments, robot.mounted) = (instruments, mounted);
    robot.masses = masses(tree, &links, base);
    let named = chain.instruments.iter().chain(&chain.targets).map(|(_, link)| *link);
    let end = |link: usize| NamedLink { link: tree.link_name(link).to_owned(), part: at(link).part };
    let ends = std::iter::once(chain.tip).chain(named).map(end).collect();
    Ok((parts, ends, robot, base_from_top))
}

/// Masses of the links of the chain and of the links that it carries, other joints at zero. They are optional: an unreadable mass is omitted.
fn masses(tree: &UrdfTree, links: &BTreeMap<usize, LinkLocation>, base: LinkLocation) -> Vec<Mass> {
    let source = &tree.source;
    let mut links = links.clone();
    let mut found = Vec::new();
    for node in source.children(source.document.root_element(), "link") {
        let Some(link) = node.attribute("name").and_then(|name| tree.link(name)) else { continue };
        // The walk goes from the nearest known link down to this one; links that the chain does not carry count as fixed to the base.
        let unknown = |&(_, joint): &(usize, &TreeJoint)| !links.contains_key(&joint.child);
        let way: Vec<&TreeJoint> = tree.ancestors(link).take_while(unknown).map(|(_, joint)| joint).collect();
        let known = way.last().map_or(links.get(&link), |joint| links.get(&joint.parent));
        let mut at = known.copied().unwrap_or(base);
        for joint in way.into_iter().rev() {
            if at.body != Body::Base {
                match read_part(source, joint) {
                    Ok(part) => at.base_from_link = at.base_from_link * part.parent_from_joint,
                    Err(_) => at = base,
                }
            }
            links.insert(joint.child, at);
        }
        if at.body != Body::Base {
            let of = format!("<inertial> of link `{}`", tree.link_name(link));
            found.extend(mass(source, node, at, &of).ok().flatten());
        }
    }
    found
}

/// The mass of a link.
fn mass<'a>(source: &XmlSource<'a>, link: Node<'a, 'a>, at: LinkLocation, of: &str) -> Result<Option<Mass>> {
    let child = |node, name| source.only_child(node, name, of, true);
    let Some(inertial) = child(link, "inertial")? else { return Ok(None) };
    let Some(mass) = child(inertial, "mass")? else { return Ok(None) };
    let Some(kg) = source.number(mass, "value", of)?.filter(|kg| Mass::is_mass(*kg)) else { return Ok(None) };
    let centre = match child(inertial, "origin")? {
        Some(origin) => source.numbers(origin, "xyz", of)?.unwrap_or_default(),
        None => [0.0; 3],
    };
    Ok(Some(Mass { body: at.body, place: at.base_from_link.act(&Vector3::from(centre)), kg }))
}

/// The `<origin>` of any joint of the tree; `None` if it cannot be read.
pub(crate) fn fixed_pose(source: &XmlSource, joint: &TreeJoint) -> Option<Pose> {
    read_part(source, joint).ok().map(|part| part.parent_from_joint)
}

fn moving_joint(tree: &UrdfTree, joint: &TreeJoint, axis: &Vector3<f64>, base_from_joint: Pose) -> Result<Joint> {
    let direction = base_from_joint.rotation * axis;
    let slides = joint.kind == JointType::Prismatic;
    let kind = if slides { JointKind::Prismatic } else { JointKind::Revolute };
    let screw = kind.screw(&direction, &base_from_joint.translation);
    Ok(Joint {
        frame: base_from_joint,
        limits: read_limits(&tree.source, joint)?,
        reading: read_reading(tree, joint)?,
        ..Joint::with_screw(joint.name, kind, screw)
    })
}

fn read_part<'a>(source: &XmlSource<'a>, joint: &TreeJoint<'a>) -> Result<UrdfJoint> {
    let child = |name| source.only_child(joint.node, name, &format!("joint `{}`", joint.name), true);
    let (origin, axis) = (child("origin")?, child("axis")?);
    let of = format!("<origin> of joint `{}`", joint.name);
    let parent_from_joint = origin.map_or(Ok(Pose::identity()), |origin| read_origin(source, origin, &of))?;
    let has_quaternion = origin.is_some_and(|it| it.has_attribute("quat_xyzw"));
    let is_quaternion = has_quaternion && has_quaternions(source);
    let unit_axis = if joint.kind.moves() { Some(read_axis(source, joint, axis)?) } else { None };
    let attribute = |node: Option<Node>, name| node.and_then(|node| value_range(node, name));
    Ok(UrdfJoint {
        name: joint.name.to_owned(),
        parent: None,
        parent_from_joint,
        axis: unit_axis.map(|(axis, _)| axis),
        axis_length: unit_axis.map_or(1.0, |(_, length)| length),
        is_without_range: is_without_range(source, joint)?,
        has_idle_quaternion: has_quaternion && !is_quaternion,
        place: JointSpans {
            element: joint.node.range(),
            first_child: joint.node.first_element_child().map_or(joint.node.range().end, |child| child.range().start),
            origin: origin.map(|node| source.after_name(node)),
            xyz: attribute(origin, "xyz"),
            rpy: attribute(origin, if is_quaternion { "quat_xyzw" } else { "rpy" }),
            is_quaternion,
            kind: value_range(joint.node, "type"),
            axis: axis.map(|node| source.after_name(node)),
            axis_xyz: attribute(axis, "xyz"),
        },
    })
}

/// True if the version of the text has quaternions: 1.1 and later ones.
fn has_quaternions(source: &XmlSource<'_>) -> bool {
    let version = source.document.root_element().attribute("version");
    version.and_then(|it| it.trim().parse::<f64>().ok()).is_some_and(|it| it >= 1.1)
}

/// The pose of an `<origin>`.
pub(crate) fn read_origin<'a>(source: &XmlSource<'a>, origin: Node<'a, 'a>, of: &str) -> Result<Pose> {
    let xyz = source.numbers(origin, "xyz", of)?.unwrap_or([0.0; 3]);
    let quaternion = match has_quaternions(source) {
        true => source.numbers(origin, "quat_xyzw", of)?,
        false => None,
    };
    let Some(quaternion) = quaternion else {
        return Ok(Pose::from_xyz_rpy(xyz, source.numbers(origin, "rpy", of)?.unwrap_or([0.0; 3])));
    };
    if origin.has_attribute("rpy") {
        return Err(source.error(origin, format!("{of} has `rpy` and `quat_xyzw`, expected one of them")));
    }
    let norm = quaternion.iter().map(|it| it * it).sum::<f64>().sqrt();
    if (norm - 1.0).abs() > WRONG_AXIS {
        return Err(source.error(origin, format!("{of} has a quaternion of length {norm}, expected 1")));
    }
    Ok(Pose::from_position_quaternion(xyz, quaternion))
}

/// True if a joint needs a range and states none: without a `<limit>`, or with one that states neither end.
fn is_without_range<'a>(source: &XmlSource<'a>, joint: &TreeJoint<'a>) -> Result<bool> {
    if !matches!(joint.kind, JointType::Revolute | JointType::Prismatic) {
        return Ok(false);
    }
    let node = source.only_child(joint.node, "limit", &format!("joint `{}`", joint.name), false)?;
    let states = |name: &str| node.is_some_and(|it| it.has_attribute(name));
    Ok(!states("lower") && !states("upper"))
}

/// The unit axis in the joint's frame, with its length in the text; without an `<axis>` it is x.
fn read_axis<'a>(
    source: &XmlSource<'a>,
    joint: &TreeJoint<'a>,
    axis: Option<Node<'a, 'a>>,
) -> Result<(Vector3<f64>, f64)> {
    let of = format!("<axis> of joint `{}`", joint.name);
    let Some(node) = axis else { return Ok((Vector3::x(), 1.0)) };
    let axis = Vector3::from(source.numbers(node, "xyz", &of)?.unwrap_or([1.0, 0.0, 0.0]));
    if axis == Vector3::zeros() {
        return Err(source.error(node, format!("{of} is 0 0 0, expected a direction, such as 0 0 1")));
    }
    // The vector is scaled first, so that tiny numbers do not vanish when squared.
    Ok(((axis / axis.amax()).normalize(), axis.norm()))
}

/// Limits, unless the joint is continuous or its range is empty (exporters write unknown limits so).
fn read_limits<'a>(source: &XmlSource<'a>, joint: &TreeJoint<'a>) -> Result<Option<JointLimits>> {
    let of = format!("joint `{}`", joint.name);
    let Some(node) = source.only_child(joint.node, "limit", &of, false)? else { return Ok(None) };
    if joint.kind == JointType::Continuous {
        return Ok(None);
    }
    let of = format!("<limit> of joint `{}`", joint.name);
    let number = |name| source.bounds::<1>(node, name, &of).map(|number| number.map_or(0.0, |[only]| only));
    let (lower, upper) = (number("lower")?, number("upper")?);
    if lower > upper {
        let message = format!("{of} has lower {lower} above upper {upper}, expected lower < upper");
        return Err(source.error(node, message));
    }
    Ok(JointLimits::from_bounds(lower, upper))
}

/// The reading that determines the value of a joint, through all mimic relations.
fn read_reading(tree: &UrdfTree, joint: &TreeJoint) -> Result<Reading> {
    let follows = |name: &str| tree.joint(name).map_or(Ok(None), |follower| read_mimic(tree, follower));
    mimic::reading(joint.name, follows, |message| tree.source.error(joint.node, message))
}

fn read_mimic<'a>(tree: &UrdfTree<'a>, follower: &TreeJoint<'a>) -> Result<Option<Reading>> {
    let source = &tree.source;
    let of = format!("joint `{}`", follower.name);
    let Some(node) = source.only_child(follower.node, "mimic", &of, false)? else { return Ok(None) };
    let of = format!("<mimic> of joint `{}`", follower.name);
    let (name, attribute) = source.require_attribute(node, "joint", &of)?;
    let error = |message| Err(source.error_at(attribute.range_value().start, message));
    let Some(leader) = tree.joint(name) else {
        let names: Vec<&str> = tree.joints.iter().map(|joint| joint.name).collect();
        let known = nearest_or_all(name, &names);
        return error(format!("{of} names joint `{name}`, expected a joint of this file, {known}"));
    };
    if !leader.kind.moves() {
        return error(format!(
            "{of} names joint `{name}`, which is {}, expected a revolute, continuous or prismatic joint",
            leader.kind.word()
        ));
    }
    Ok(Some(Reading {
        name: name.to_owned(),
        multiplier: source.number(node, "multiplier", &of)?.unwrap_or(1.0),
        offset: source.number(node, "offset", &of)?.unwrap_or(0.0),
    }))
}
