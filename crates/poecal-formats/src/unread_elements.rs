//! Unread attributes and elements of models: those that scale or shift are refused, others are listed unless they are known to be harmless.
//!
//! Only elements that define the poses of links and joints are examined; the contents of shapes, sensors and plugins change no chain.

use roxmltree::Node;

use poecal_numerics::error::Result;
use poecal_storage::other_keys::{KeyOwner, other_keys};
use poecal_storage::xml::XmlSource;
use poecal_storage::yaml::YamlLeaf;

/// A known element, with attributes and inner elements that are read or change no pose of a link: words with blanks between.
pub(crate) type KnownElement = (&'static str, &'static str, &'static str);

fn has(words: &str, name: &str) -> bool {
    words.split_whitespace().any(|it| it == name)
}

/// Known elements of URDF.
pub(crate) const URDF: &[KnownElement] = &[
    ("link", "name type", "inertial visual collision contact sensor self_collision_checking gazebo inertia"),
    (
        "joint",
        "name type",
        "parent child origin axis limit mimic dynamics safety_controller calibration gazebo hardwareInterface \
         transmission",
    ),
    ("origin", "xyz rpy quat_xyzw", ""),
    ("axis", "xyz", ""),
    ("limit", "lower upper effort velocity acceleration deceleration jerk", ""),
    ("mimic", "joint multiplier offset", ""),
    ("parent", "link", ""),
    ("child", "link", ""),
];

/// Known elements of MuJoCo's models.
pub(crate) const MJCF: &[KnownElement] = &[
    (
        "compiler",
        "angle autolimits eulerseq coordinate boundmass boundinertia settotalmass balanceinertia strippath fitaabb \
         assetdir meshdir texturedir discardvisual convexhull usethread fusestatic inertiafromgeom \
         inertiagrouprange exactmeshinertia alignfree saveinertial",
        "lengthrange",
    ),
    (
        "body",
        "name childclass mocap pos quat axisangle xyaxes zaxis euler gravcomp sleep user",
        "inertial joint freejoint geom site camera light flexcomp plugin body frame",
    ),
    (
        "frame",
        "name childclass pos quat axisangle xyaxes zaxis euler",
        "inertial joint freejoint geom site camera light flexcomp plugin body frame",
    ),
    (
        "joint",
        "name class type group pos axis springdamper limited actuatorfrclimited solreflimit solimplimit \
         solreffriction solimpfriction solref solimp stiffness range actuatorfrcrange actuatorgravcomp margin ref \
         springref damping armature frictionloss user joint1 joint2 polycoef active",
        "plugin",
    ),
];

/// Known elements of Gazebo's models.
pub(crate) const SDF: &[KnownElement] = &[
    (
        "model",
        "name canonical_link placement_frame",
        "link joint frame model pose static self_collide allow_auto_disable enable_wind plugin gripper",
    ),
    (
        "joint",
        "name type",
        "parent child pose axis axis2 gearbox_ratio gearbox_reference_body thread_pitch screw_thread_pitch physics \
         sensor",
    ),
    ("frame", "name attached_to", "pose"),
    ("axis", "", "xyz limit dynamics mimic use_parent_model_frame initial_position"),
    ("pose", "relative_to frame degrees rotation_format", ""),
    ("xyz", "expressed_in", ""),
    ("mimic", "joint axis", "multiplier offset reference"),
    ("limit", "", "lower upper effort velocity stiffness dissipation"),
];

/// Elements in which links and joints are sought in MuJoCo's models; in URDF and Gazebo's models it is the root.
const SOUGHT_IN: [&str; 4] = ["compiler", "worldbody", "default", "equality"];

/// The sentence that lists unknown contents of the known elements below the root; the contents of other elements are not examined.
///
/// # Errors
/// The model has an unknown value that scales or shifts; the error states its position.
pub(crate) fn sentence<'a>(
    source: &XmlSource<'a>,
    root: Node<'a, 'a>,
    known: &[KnownElement],
) -> Result<Option<String>> {
    let mut found = Vec::new();
    let is_sought = |it: &Node<'a, 'a>| !root.has_tag_name("mujoco") || SOUGHT_IN.contains(&it.tag_name().name());
    let of_root = root.children().rev().filter(Node::is_element);
    let mut steps: Vec<Node<'a, 'a>> = of_root.filter(is_sought).collect();
    // Not recursive: models may be deep.
    while let Some(node) = steps.pop() {
        let tag = node.tag_name().name();
        let Some((_, attributes, elements)) = known.iter().find(|it| it.0 == tag) else {
            let leads = ["worldbody", "default", "equality", "world"].contains(&tag);
            steps.extend(node.children().rev().filter(|it| leads && it.is_element()));
            continue;
        };
        for attribute in node.attributes().filter(|it| it.namespace().is_none()) {
            if !has(attributes, attribute.name()) {
                found.push(leaf(source, node, &[tag, attribute.name()], attribute.value()));
            }
        }
        let mut next = Vec::new();
        for child in
            node.children().filter(|it| it.is_element() && it.tag_name().namespace() == node.tag_name().namespace())
        {
            let name = child.tag_name().name();
            if has(elements, name) {
                next.push(child);
                continue;
            }
            if child.attributes().len() == 0 {
                found.push(leaf(source, child, &[tag, name], child.text().unwrap_or_default().trim()));
            }
            for attribute in child.attributes() {
                found.push(leaf(source, child, &[tag, name, attribute.name()], attribute.value()));
            }
        }
        steps.extend(next.into_iter().rev());
    }
    other_keys(&found, 1, |_| false, (KeyOwner::Robot, source.path))
}

fn leaf<'a>(source: &XmlSource<'a>, node: Node<'a, 'a>, path: &[&str], text: &str) -> YamlLeaf {
    let line = source.error(node, String::new()).place().and_then(|it| it.line).unwrap_or(1);
    YamlLeaf { path: path.iter().map(|it| (*it).to_owned()).collect(), text: text.to_owned(), line }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::foreign::ForeignForm;
    use crate::urdf::{ChainSelection, UrdfDocument};

    fn urdf(joint: &str, inside: &str) -> Result<UrdfDocument> {
        let text = format!(
            "<robot name='r' xmlns:own='urn:own'><link name='a'/><link name='b'><visual><geometry><mesh scale='2 2 2'/></geometry></visual></link>\n\
             <joint name='one' type='revolute' own:scale='3' {joint}><parent link='a'/><child link='b'/><origin xyz='0 0 0.3'/>{inside}\
             <axis xyz='0 0 1'/><limit lower='-3' upper='3' effort='1' velocity='1'/></joint></robot>"
        );
        UrdfDocument::parse(&text, Path::new("r.urdf"), &ChainSelection::default())
    }

    fn read_other(form: ForeignForm, text: &str) -> Result<UrdfDocument> {
        form.read(text, Path::new("r.xml"), None, &ChainSelection::default())
    }

    fn mjcf(joint: &str) -> Result<UrdfDocument> {
        let text = format!(
            "<mujoco><compiler angle='radian' meshdir='a'/><asset><mesh scale='2 2 2'/></asset><worldbody><body name='a'><joint name='one' {joint}/>\
             <geom size='1'/></body></worldbody><actuator><position joint='one' gear='3'/></actuator></mujoco>"
        );
        read_other(ForeignForm::Mjcf, &text)
    }

    fn sdf(joint: &str) -> Result<UrdfDocument> {
        let text = format!(
            "<sdf version='1.9'><model name='m'><link name='a'/><link name='b'/><joint name='one' type='revolute'><parent>a</parent><child>b</child>\
             {joint}<axis><xyz>0 0 1</xyz></axis></joint></model></sdf>"
        );
        read_other(ForeignForm::Sdf, &text)
    }

    #[test]
    fn what_is_known_is_not_named_and_what_is_not_is_once() {
        for sound in [urdf("", ""), urdf("", "<dynamics damping='1'/>"), mjcf("armature='1'"), sdf("<physics/>")] {
            assert_eq!(sound.unwrap().remarks(), [""; 0]);
        }
        let found = urdf("colour='red'", "<wire length='1'/><wire length='2'/><hint/>").unwrap();
        assert_eq!(found.remarks(), ["did not read `colour`, `wire`, `hint`"]);
        assert_eq!(mjcf("colour='red'").unwrap().remarks(), ["did not read `colour`"]);
        assert_eq!(sdf("<colour>red</colour>").unwrap().remarks(), ["did not read `colour`"]);
    }

    #[test]
    fn what_scales_or_shifts_is_refused_unless_it_changes_nothing() {
        for (refused, key) in [
            (urdf("scale='0.001'", ""), "joint.scale"),
            (urdf("", "<offset value='0.3'/>"), "joint.offset.value"),
            (urdf("", "<zero_shift>0.1</zero_shift>"), "joint.zero_shift"),
            (mjcf("gear='5'"), "joint.gear"),
            (sdf("<scale>2</scale>"), "joint.scale"),
        ] {
            let error = refused.unwrap_err();
            assert!(error.place().is_some_and(|it| it.line.is_some()), "{error}");
            let expected = format!(
                "for `{key}`, which this program does not apply, expected lengths and angles as they are: work it into them, and remove the key"
            );
            assert!(error.message().contains(&expected), "{error}");
        }
        assert_eq!(urdf("scale='1'", "<offset value='0.0'/>").unwrap().remarks(), [""; 0]);
    }
}
