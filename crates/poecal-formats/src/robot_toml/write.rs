//! A robot as a TOML model of screws, in metres and radians.

use std::fmt::Write;

use super::mounts::BASE;
use poecal_arm::lie::Pose;
use poecal_model::robot::{Body, Joint, JointKind, Robot};
use poecal_storage::numbers::{format_shortest, tidy_numbers};

/// The robot as a TOML text of screws, SI units. Numbers are the shortest decimals that read back the same, freed of rounding below 1e-15.
///
/// Joint frames are not part of the format: screws and home pose suffice for forward kinematics.
#[must_use]
pub fn write(robot: &Robot) -> String {
    let mut text = format!(
        "poecal_robot = 1\nname = {}\nlength_unit = \"m\"\nangle_unit = \"rad\"\nbase_link = {}\ntip_link = {}\n",
        quote_toml(&robot.name),
        quote_toml(&robot.base_name),
        quote_toml(&robot.tip_name)
    );
    // Writing to a String cannot fail.
    if let Some(tip) = robot.tip {
        let _ = writeln!(text, "tip_on = {}", body_name(robot, tip));
    }
    text.push_str("\njoint = [\n");
    for (index, joint) in robot.joints.iter().enumerate() {
        let parent = joint.stands_on.map_or_else(String::new, |on| format!(", parent = {}", body_name(robot, on)));
        let terms = term_keys(robot, index);
        let _ = writeln!(text, "  {{ {}{parent}{terms} }},", joint_keys(joint));
    }
    let _ = write!(text, "]\n\n[home]\n{}", pose_keys(&robot.home));
    for (name, pose) in &robot.targets {
        let _ = write!(text, "\n[[target]]\nname = {}\n{}", quote_toml(name), pose_keys(pose));
    }
    for (key, mounts) in [("target", &robot.mounted), ("instrument", &robot.instruments)] {
        for mount in mounts {
            let (name, on) = (quote_toml(&mount.name), body_name(robot, mount.body));
            let pose = pose_keys(&robot.base_from(mount));
            let _ = write!(text, "\n[[{key}]]\nname = {name}\non = {on}\n{pose}");
        }
    }
    for mass in &robot.masses {
        let (on, position) = (body_name(robot, mass.body), array(mass.place.into()));
        let _ = write!(text, "\n[[mass]]\non = {on}\nposition = {position}\nkg = {}\n", format_shortest(mass.kg));
    }
    text
}

/// Name of the joint that moves a body, or the word for the base.
fn body_name(robot: &Robot, body: Body) -> String {
    let is_joint = |name: &str| robot.joints.iter().any(|joint| joint.name == name);
    match body.joint().and_then(|joint| robot.joints.get(joint)) {
        Some(joint) => quote_toml(&joint.name),
        None if is_joint(BASE) => quote_toml(""),
        None => quote_toml(BASE),
    }
}

fn joint_keys(joint: &Joint) -> String {
    let (v, w) = (array(joint.screw.v().into()), array(joint.screw.w().into()));
    let screw = match joint.kind {
        JointKind::Revolute => format!("screw = {{ v = {v}, w = {w} }}"),
        JointKind::Prismatic => format!("screw = {{ v = {v} }}"),
    };
    let mut keys = format!("name = {}, type = \"{}\", {screw}", quote_toml(&joint.name), joint.kind.word());
    if let Some(limits) = joint.limits {
        let _ = write!(keys, ", limits = [{}, {}]", format_shortest(limits.lower), format_shortest(limits.upper));
    }
    if let Some(tolerance) = joint.tolerance {
        let (angle, length) = (format_shortest(tolerance.angle_rad), format_shortest(tolerance.length_m));
        let _ = write!(keys, ", tolerance = {{ angle = {angle}, length = {length} }}");
    }
    let reading = &joint.reading;
    if reading.name != joint.name {
        let _ = write!(
            keys,
            ", mimic = {{ joint = {}, multiplier = {}, offset = {} }}",
            quote_toml(&reading.name),
            format_shortest(reading.multiplier),
            format_shortest(reading.offset)
        );
    }
    keys
}

/// The terms of a joint's value.
fn term_keys(robot: &Robot, joint: usize) -> String {
    let own = robot.terms.iter().filter(|it| it.joint == joint);
    let keys: Vec<String> = own.map(|it| format!("{} = {}", it.term, format_shortest(it.coefficient))).collect();
    if keys.is_empty() { String::new() } else { format!(", terms = {{ {} }}", keys.join(", ")) }
}

fn pose_keys(pose: &Pose) -> String {
    let mut keys = format!("position = {}\n", array(pose.translation.into()));
    if (pose.rotation - nalgebra::Matrix3::identity()).amax() > 1e-15 {
        let _ = writeln!(keys, "quaternion_xyzw = {}", array(pose.quaternion_xyzw()));
    }
    keys
}

fn array<const N: usize>(numbers: [f64; N]) -> String {
    format!("[{}]", tidy_numbers(numbers).map(format_shortest).join(", "))
}

fn quote_toml(name: &str) -> String {
    toml::Value::String(name.to_owned()).to_string()
}
