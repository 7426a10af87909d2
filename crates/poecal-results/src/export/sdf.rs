//! Gazebo's model: links placed in their predecessors, joints about the z axes of their links.

use std::f64::consts::FRAC_PI_2;
use std::fmt::Write as _;

use super::names::ExportNames;
use super::{ExportedText, Proof, read_back};
use poecal_arm::lie::Pose;
use poecal_formats::urdf::{escape_attribute, origin_values};
use poecal_model::forms::AxisFrames;
use poecal_model::robot::{Joint, JointKind, JointLimits, Robot};
use poecal_numerics::error::Result;
use poecal_storage::numbers::format_shortest;

/// Limit of a joint that has none: SDF's own.
const UNLIMITED: f64 = 1e16;

pub(crate) fn write(robot: &Robot) -> Result<ExportedText> {
    let frames = AxisFrames::with_followers(robot)?;
    let (names, plain) = (ExportNames::from_robot(robot), frames.robot(robot)?);
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<sdf version=\"{}\">\n  <model name=\"{}\">\n",
        // Joints that follow others came later.
        if plain.joints.iter().any(|it| plain.leader(it).is_some()) { "1.11" } else { "1.9" },
        escape_attribute(&robot.name)
    );
    let _ = writeln!(text, "    <link name=\"{}\"/>", escape_attribute(&names.base));
    let mut before = names.base.clone();
    for (at, (joint, frame)) in plain.joints.iter().zip(&frames.joints).enumerate() {
        let link = names.links[at].clone();
        push_link(&mut text, &link, &before, frame);
        let kind = match joint.kind {
            JointKind::Revolute => "revolute",
            JointKind::Prismatic => "prismatic",
        };
        let JointLimits { lower, upper } = joint.limits.unwrap_or(JointLimits { lower: -UNLIMITED, upper: UNLIMITED });
        let _ = writeln!(
            text,
            "    <joint name=\"{}\" type=\"{kind}\">\n      <parent>{}</parent>\n      <child>{}</child>\n      <axis>\n        <xyz>0 0 1</xyz>\n        \
             <limit>\n          <lower>{}</lower>\n          <upper>{}</upper>\n        </limit>\n{}      </axis>\n    </joint>",
            escape_attribute(&names.joints[at]),
            escape_attribute(&before),
            escape_attribute(&link),
            format_shortest(lower),
            format_shortest(upper),
            plain.leader(joint).map_or_else(String::new, |leader| mimic(joint, &names.joints[leader]))
        );
        before = link;
    }
    push_link(&mut text, &names.tip, &before, &frames.last_from_tip);
    let _ = writeln!(
        text,
        "    <joint name=\"{2}\" type=\"fixed\">\n      <parent>{1}</parent>\n      <child>{0}</child>\n    </joint>\n  </model>\n</sdf>",
        escape_attribute(&names.tip),
        escape_attribute(&before),
        escape_attribute(&names.mount)
    );
    let again = read_back(&text, "robot.sdf", Some((&names.base, &names.tip)))?;
    let masses = "the file has no masses and meshes, since a calibration has none: Gazebo takes 1 kg a link";
    let notes = names.note(robot).into_iter().chain([masses.to_owned()]).collect();
    Ok(ExportedText { text, notes, proof: Proof::Again(again.into()) })
}

/// The element of a joint that follows another one.
fn mimic(joint: &Joint, leader: &str) -> String {
    format!(
        "        <mimic joint=\"{}\">\n          <multiplier>{}</multiplier>\n          <offset>{}</offset>\n          <reference>0</reference>\n        </mimic>\n",
        escape_attribute(leader),
        format_shortest(joint.reading.multiplier),
        format_shortest(joint.reading.offset)
    )
}

fn push_link(text: &mut String, name: &str, before: &str, pose: &Pose) {
    let (xyz, rpy) = origin_values(pose);
    let [x, y, z] = xyz.map(format_shortest);
    // Angles near 90° about y would lose half their digits.
    let (format, turn) = if (rpy[1].abs() - FRAC_PI_2).abs() < 1e-3 {
        let [qx, qy, qz, qw] = pose.quaternion_xyzw().map(format_shortest);
        (" rotation_format=\"quat_xyzw\"", format!("{qx} {qy} {qz} {qw}"))
    } else {
        ("", rpy.map(format_shortest).join(" "))
    };
    let _ = writeln!(
        text,
        "    <link name=\"{}\">\n      <pose relative_to=\"{}\"{format}>{x} {y} {z} {turn}</pose>\n    </link>",
        escape_attribute(name),
        escape_attribute(before)
    );
}
