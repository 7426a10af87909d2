//! MuJoCo's model: bodies with their joints along z.

use std::fmt::Write as _;

use roxmltree::{Document, Node};

use super::names::Names;
use super::{Written, export_error, unread};
use crate::error::Result;
use crate::forms::AxisFrames;
use crate::io::numbers::{shortest, tidy};
use crate::io::urdf::escaped;
use crate::lie::Pose;
use crate::robot::{JointKind, Limits, Robot};

pub(super) fn write(robot: &Robot) -> Result<Written> {
    let frames = AxisFrames::of(robot)?;
    let (names, plain) = (Names::of(robot), frames.robot(robot)?);
    let mut text = format!("<mujoco model=\"{}\">\n", escaped(&robot.name));
    text.push_str("  <compiler angle=\"radian\" autolimits=\"true\"/>\n  <worldbody>\n");
    let _ = writeln!(text, "    <body name=\"{}\">", escaped(&names.base));
    let mut indent = 6;
    for (at, (joint, frame)) in plain.joints.iter().zip(&frames.joints).enumerate() {
        let space = " ".repeat(indent);
        let _ = writeln!(text, "{space}<body name=\"{}\" {}>", escaped(&names.links[at]), placed(frame));
        let _ =
            writeln!(text, "{space}  <inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"0.01 0.01 0.01\"/>");
        let kind = match joint.kind {
            JointKind::Revolute => "hinge",
            JointKind::Prismatic => "slide",
        };
        let range = match joint.limits {
            Some(Limits { lower, upper }) => format!(" range=\"{} {}\"", shortest(lower), shortest(upper)),
            None => String::new(),
        };
        let _ = writeln!(
            text,
            "{space}  <joint name=\"{}\" type=\"{kind}\" axis=\"0 0 1\"{range}/>",
            escaped(&names.joints[at])
        );
        indent += 2;
    }
    let _ = writeln!(
        text,
        "{}<site name=\"{}\" {}/>",
        " ".repeat(indent),
        escaped(&names.tip),
        placed(&frames.last_from_tip)
    );
    for _ in &robot.joints {
        indent -= 2;
        let _ = writeln!(text, "{}</body>", " ".repeat(indent));
    }
    text.push_str("    </body>\n  </worldbody>\n</mujoco>\n");
    let again = read(&text)?.robot(robot)?;
    let masses = "the masses in the file are placeholders (1 kg a link), since a calibration has none; meshes are those of another file";
    let notes = names.note(robot).into_iter().chain([masses.to_owned()]).collect();
    Ok(Written { text, notes, again, remains: None })
}

/// Attributes of a pose.
fn placed(pose: &Pose) -> String {
    let [x, y, z, w] = pose.quaternion_xyzw();
    let numbers = |numbers: &[f64]| numbers.iter().map(|&it| shortest(it)).collect::<Vec<_>>().join(" ");
    format!("pos=\"{}\" quat=\"{}\"", numbers(&tidy(pose.translation.into())), numbers(&[w, x, y, z]))
}

/// Numbers of an attribute.
pub(super) fn numbers<const N: usize>(text: &str) -> Result<[f64; N]> {
    let found: Vec<f64> = text.split_whitespace().filter_map(|it| it.parse().ok()).collect();
    found.try_into().map_err(|_| unread(&format!("the numbers `{text}`")))
}

fn read(text: &str) -> Result<AxisFrames> {
    let document = Document::parse(text).map_err(|error| export_error(error.to_string()))?;
    let pose = |node: &Node<'_, '_>| -> Result<Pose> {
        let position = numbers::<3>(node.attribute("pos").unwrap_or_default())?;
        let [w, x, y, z] = numbers::<4>(node.attribute("quat").unwrap_or_default())?;
        Ok(Pose::from_position_quaternion(position, [x, y, z, w]))
    };
    let bodies = document.descendants().filter(|node| node.has_tag_name("body") && node.has_attribute("pos"));
    let joints = bodies.map(|node| pose(&node)).collect::<Result<_>>()?;
    let site =
        document.descendants().find(|node| node.has_tag_name("site")).ok_or_else(|| unread("no site"))?;
    Ok(AxisFrames { joints, last_from_tip: pose(&site)? })
}
