//! MuJoCo's model: bodies with their joints along z.

use std::fmt::Write as _;

use super::names::ExportNames;
use super::{ExportedText, Proof, read_back};
use poecal_arm::lie::Pose;
use poecal_formats::urdf::escape_attribute;
use poecal_model::forms::AxisFrames;
use poecal_model::robot::{JointKind, JointLimits, Robot};
use poecal_numerics::error::Result;
use poecal_storage::numbers::{format_shortest, tidy_numbers};

pub(crate) fn write(robot: &Robot) -> Result<ExportedText> {
    let frames = AxisFrames::with_followers(robot)?;
    let (names, plain) = (ExportNames::from_robot(robot), frames.robot(robot)?);
    let mut text = format!("<mujoco model=\"{}\">\n", escape_attribute(&robot.name));
    text.push_str("  <compiler angle=\"radian\" autolimits=\"true\"/>\n  <worldbody>\n");
    let _ = writeln!(text, "    <body name=\"{}\">", escape_attribute(&names.base));
    let mut indent = 6;
    for (at, (joint, frame)) in plain.joints.iter().zip(&frames.joints).enumerate() {
        let space = " ".repeat(indent);
        let _ =
            writeln!(text, "{space}<body name=\"{}\" {}>", escape_attribute(&names.links[at]), pose_attributes(frame));
        let _ = writeln!(text, "{space}  <inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"0.01 0.01 0.01\"/>");
        let kind = match joint.kind {
            JointKind::Revolute => "hinge",
            JointKind::Prismatic => "slide",
        };
        let range = match joint.limits {
            Some(JointLimits { lower, upper }) => {
                format!(" range=\"{} {}\"", format_shortest(lower), format_shortest(upper))
            }
            None => String::new(),
        };
        let _ = writeln!(
            text,
            "{space}  <joint name=\"{}\" type=\"{kind}\" axis=\"0 0 1\"{range}/>",
            escape_attribute(&names.joints[at])
        );
        indent += 2;
    }
    let _ = writeln!(
        text,
        "{}<site name=\"{}\" {}/>",
        " ".repeat(indent),
        escape_attribute(&names.tip),
        pose_attributes(&frames.last_from_tip)
    );
    for _ in &robot.joints {
        indent -= 2;
        let _ = writeln!(text, "{}</body>", " ".repeat(indent));
    }
    text.push_str("    </body>\n  </worldbody>\n");
    text.push_str(&equalities(&plain, &names));
    text.push_str("</mujoco>\n");
    let again = read_back(&text, "robot.xml", Some((&names.base, &names.tip)))?;
    let masses = "the masses in the file are placeholders (1 kg a link), since a calibration has none; meshes are those of another file";
    let notes = names.note(robot).into_iter().chain([masses.to_owned()]).collect();
    Ok(ExportedText { text, notes, proof: Proof::Again(again.into()) })
}

/// Equations of the joints that follow others; empty if none does.
fn equalities(plain: &Robot, names: &ExportNames) -> String {
    let followers = plain.joints.iter().zip(&names.joints).filter_map(|(it, own)| Some((it, own, plain.leader(it)?)));
    let lines: String = followers
        .map(|(joint, own, leader)| {
            let [offset, multiplier] = [joint.reading.offset, joint.reading.multiplier].map(format_shortest);
            format!(
                "    <joint joint1=\"{}\" joint2=\"{}\" polycoef=\"{offset} {multiplier} 0 0 0\"/>\n",
                escape_attribute(own),
                escape_attribute(&names.joints[leader])
            )
        })
        .collect();
    if lines.is_empty() { lines } else { format!("  <equality>\n{lines}  </equality>\n") }
}

/// Attributes of a pose.
fn pose_attributes(pose: &Pose) -> String {
    let [x, y, z, w] = pose.quaternion_xyzw();
    let numbers = |numbers: &[f64]| numbers.iter().map(|&it| format_shortest(it)).collect::<Vec<_>>().join(" ");
    format!("pos=\"{}\" quat=\"{}\"", numbers(&tidy_numbers(pose.translation.into())), numbers(&[w, x, y, z]))
}
