//! MuJoCo's model: bodies with their joints along z.

use std::fmt::Write as _;

use super::names::Names;
use super::{Proof, Written, read_back};
use poecal_arm::lie::Pose;
use poecal_formats::urdf::escaped;
use poecal_model::forms::AxisFrames;
use poecal_model::robot::{JointKind, Limits, Robot};
use poecal_numerics::error::Result;
use poecal_storage::numbers::{shortest, tidy};

pub(crate) fn write(robot: &Robot) -> Result<Written> {
    let frames = AxisFrames::with_followers(robot)?;
    let (names, plain) = (Names::from_robot(robot), frames.robot(robot)?);
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
    text.push_str("    </body>\n  </worldbody>\n");
    let followers =
        plain.joints.iter().zip(&names.joints).filter_map(|(it, own)| Some((it, own, plain.leader(it)?)));
    let equalities: String = followers
        .map(|(joint, own, leader)| {
            let (offset, multiplier) = (shortest(joint.reading.offset), shortest(joint.reading.multiplier));
            format!(
                "    <joint joint1=\"{}\" joint2=\"{}\" polycoef=\"{offset} {multiplier} 0 0 0\"/>\n",
                escaped(own),
                escaped(&names.joints[leader])
            )
        })
        .collect();
    if !equalities.is_empty() {
        let _ = write!(text, "  <equality>\n{equalities}  </equality>\n");
    }
    text.push_str("</mujoco>\n");
    let again = read_back(&text, "robot.xml", Some((&names.base, &names.tip)))?;
    let masses = "the masses in the file are placeholders (1 kg a link), since a calibration has none; meshes are those of another file";
    let notes = names.note(robot).into_iter().chain([masses.to_owned()]).collect();
    Ok(Written { text, notes, proof: Proof::Again(again.into()) })
}

/// Attributes of a pose.
fn placed(pose: &Pose) -> String {
    let [x, y, z, w] = pose.quaternion_xyzw();
    let numbers = |numbers: &[f64]| numbers.iter().map(|&it| shortest(it)).collect::<Vec<_>>().join(" ");
    format!("pos=\"{}\" quat=\"{}\"", numbers(&tidy(pose.translation.into())), numbers(&[w, x, y, z]))
}
