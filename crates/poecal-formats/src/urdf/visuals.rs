//! Shapes of links: `<visual>` of every link, or `<collision>` if no link has one.

use std::collections::BTreeMap;
use std::path::Path;

use roxmltree::Node;

use super::tree::UrdfTree;
use super::urdf_joints::{fixed_pose, read_origin};
use super::{EXPECTED, UrdfDocument};
use poecal_arm::lie::Pose;
use poecal_model::robot::Body;
use poecal_storage::xml::{XmlSource, declare_prefixes, parsed};

/// Largest number of shapes of a file.
const MOST: usize = 4000;

/// The shape of a part of a link, metres. Cylinders are along z, everything is about its middle; a mesh has the axes of its file.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// A box with these edges.
    Box([f64; 3]),
    /// A cylinder.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Length along z.
        length: f64,
    },
    /// A sphere.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// A mesh of a file, and the factors along its axes.
    Mesh {
        /// Name of the file in the URDF.
        file: String,
        /// Factors along the axes of the file.
        scale: [f64; 3],
    },
}

/// A shape with its pose: the body that carries it, and its pose in the base with all joints at zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Visual {
    /// Name of the link.
    pub link: String,
    /// The body that carries it.
    pub body: Body,
    /// Its pose in the base with all joints at zero.
    pub base_from_shape: Pose,
    /// Its shape.
    pub geometry: Geometry,
}

impl UrdfDocument {
    /// The shapes of all links, in the order of the text. Links that no joint of the robot moves are posed with all other joints at zero. They are
    /// optional: an unreadable shape is omitted.
    pub fn visuals(&self) -> Vec<Visual> {
        self.shapes("visual", "collision")
    }

    /// The shapes that may collide: `<collision>` of every link, or `<visual>` if no link has one.
    pub fn collisions(&self) -> Vec<Visual> {
        self.shapes("collision", "visual")
    }

    /// The shapes of one element, or of another if there are none.
    fn shapes(&self, first: &'static str, else_of: &'static str) -> Vec<Visual> {
        let path = Path::new(&self.path);
        let text = declare_prefixes(&self.text);
        let Ok(document) = parsed(&text, path, EXPECTED) else { return Vec::new() };
        let source = XmlSource { document: &document, path };
        let Ok(tree) = UrdfTree::read(source) else { return Vec::new() };
        let links = self.links(&tree);
        let of = |element: &'static str| -> Vec<Visual> {
            let robot = document.root_element();
            let all = source.children(robot, "link").zip(&links).flat_map(|(node, at)| {
                let shapes = source.children(node, element);
                shapes.filter_map(move |shape| visual(source, (node, shape), (*at)?))
            });
            all.take(MOST).collect()
        };
        let shapes = of(first);
        if shapes.is_empty() { of(else_of) } else { shapes }
    }

    /// Body and pose in the base of each link of the tree, with all joints at zero; `None` if an origin above it cannot be read.
    fn links(&self, tree: &UrdfTree) -> Vec<Option<(Body, Pose)>> {
        let joints = self.robot.joints.iter().enumerate();
        let bodies: BTreeMap<&str, usize> = joints.map(|(k, joint)| (joint.name.as_str(), k)).collect();
        let mut known: Vec<Option<Option<(Body, Pose)>>> = vec![None; tree.links.len()];
        for link in 0..tree.links.len() {
            // The walk goes from the nearest known link, or the root, down to this one.
            let up = std::iter::once(link).chain(tree.ancestors(link).map(|(_, joint)| joint.parent));
            let way: Vec<usize> = up.take_while(|&at| known[at].is_none()).collect();
            for at in way.into_iter().rev() {
                known[at] = Some(match tree.parent_joint(at) {
                    None => Some((Body::Base, Pose::identity())),
                    Some((_, joint)) => known[joint.parent].flatten().and_then(|(body, pose)| {
                        let own = bodies.get(joint.name).map_or(body, |&k| Body::Link(k));
                        Some((own, pose * fixed_pose(&tree.source, joint)?))
                    }),
                });
            }
        }
        let links: Vec<Option<(Body, Pose)>> = known.into_iter().map(Option::flatten).collect();
        let base = tree.link(&self.robot.base_name).and_then(|base| links[base]);
        let from_root = base.map_or_else(Pose::identity, |(_, pose)| pose.inverse());
        links.into_iter().map(|link| link.map(|(body, pose)| (body, from_root * pose))).collect()
    }
}

fn visual<'a>(
    source: XmlSource<'a>,
    (link, shape): (Node<'a, 'a>, Node<'a, 'a>),
    (body, base_from_link): (Body, Pose),
) -> Option<Visual> {
    let of = "a shape";
    let mut link_from_shape = Pose::identity();
    if let Some(origin) = source.child(shape, "origin") {
        link_from_shape = read_origin(&source, origin, of).ok()?;
    }
    let geometry = source.child(shape, "geometry")?;
    let form = geometry.children().find(Node::is_element)?;
    let length = |name| source.number(form, name, of).ok().flatten().map(f64::abs);
    let geometry = match form.tag_name().name() {
        "box" => Geometry::Box(source.numbers(form, "size", of).ok()??.map(f64::abs)),
        "cylinder" => Geometry::Cylinder { radius: length("radius")?, length: length("length")? },
        "sphere" => Geometry::Sphere { radius: length("radius")? },
        "mesh" => Geometry::Mesh {
            file: form.attribute("filename").filter(|name| !name.trim().is_empty())?.trim().to_owned(),
            scale: source.numbers(form, "scale", of).ok()?.unwrap_or([1.0; 3]),
        },
        _ => return None,
    };
    Some(Visual {
        link: link.attribute("name").unwrap_or_default().to_owned(),
        body,
        base_from_shape: base_from_link * link_from_shape,
        geometry,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::urdf::ChainSelection;

    const TEXT: &str = r#"<robot name="r">
      <link name="world"/>
      <link name="base"><visual><origin xyz="0 0 0.1"/><geometry><box size="0.2 0.3 0.2"/></geometry></visual></link>
      <link name="arm"><visual><geometry><cylinder radius="0.05" length="0.4"/></geometry></visual>
        <visual><geometry><sphere radius="-0.06"/></geometry></visual><visual><geometry><cone/></geometry></visual></link>
      <link name="tool"><collision><geometry><sphere radius="1"/></geometry></collision></link>
      <link name="finger"><visual><geometry><mesh filename="package://p/finger.stl" scale="1 1 0.001"/></geometry></visual></link>
      <link name="lamp"><visual><geometry><sphere radius="0.1"/></geometry></visual></link>
      <joint name="stand" type="fixed"><parent link="world"/><child link="base"/><origin xyz="5 0 0" rpy="0 0 1.5707963267948966"/></joint>
      <joint name="turn" type="continuous"><parent link="base"/><child link="arm"/><origin xyz="0 0 1"/><axis xyz="0 0 1"/></joint>
      <joint name="mount" type="fixed"><parent link="arm"/><child link="tool"/><origin xyz="0.5 0 0"/></joint>
      <joint name="grip" type="prismatic"><parent link="tool"/><child link="finger"/><origin xyz="0.1 0 0"/><limit lower="0" upper="1"/></joint>
      <joint name="hang" type="fixed"><parent link="world"/><child link="lamp"/><origin xyz="5 0 3"/></joint>
    </robot>"#;

    #[test]
    fn shapes_stand_on_the_body_that_carries_them_in_the_base() {
        let selection = ChainSelection {
            base_link: Some("base".to_owned()),
            tip_link: Some("tool".to_owned()),
            ..ChainSelection::default()
        };
        let urdf = UrdfDocument::parse(TEXT, "r.urdf", &selection).unwrap();
        let found: Vec<(String, Body, [f64; 3], Geometry)> = urdf
            .visuals()
            .into_iter()
            .map(|it| {
                (
                    it.link,
                    it.body,
                    it.base_from_shape.translation.map(|value| (value * 1e9).round() / 1e9).into(),
                    it.geometry,
                )
            })
            .collect();
        let name = |name: &str| name.to_owned();
        let mesh = Geometry::Mesh { file: name("package://p/finger.stl"), scale: [1.0, 1.0, 0.001] };
        let expected = [
            (name("base"), Body::Base, [0.0, 0.0, 0.1], Geometry::Box([0.2, 0.3, 0.2])),
            (name("arm"), Body::Link(0), [0.0, 0.0, 1.0], Geometry::Cylinder { radius: 0.05, length: 0.4 }),
            (name("arm"), Body::Link(0), [0.0, 0.0, 1.0], Geometry::Sphere { radius: 0.06 }),
            (name("finger"), Body::Link(0), [0.6, 0.0, 1.0], mesh),
            (name("lamp"), Body::Base, [0.0, 0.0, 3.0], Geometry::Sphere { radius: 0.1 }),
        ];
        assert_eq!(found, expected);
    }
}
