//! Origins of joints by link or joint, in YAML, in the forms of Universal Robots' driver, uFactory's and Franka's descriptions.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::links::{LinkJoint, LinkJointKind, LinkTree};
use poecal_arm::lie::Pose;
use poecal_model::forms::AxisFrames;
use poecal_numerics::error::{ErrorKind, Result, first_few};
use poecal_storage::yaml::{YamlValue, values};

const EXPECTED: &str = "the origins of an arm's joints in YAML: `kinematics` with `shoulder` … `wrist_3` (Universal Robots) or `joint1` … (uFactory), \
                        or `joint1` … `joint8` with `kinematic` (Franka)";
/// Numbers of an origin.
const NUMBERS: [&str; 6] = ["x", "y", "z", "roll", "pitch", "yaw"];
/// Links of Universal Robots' arms in their driver's file, and the joint that moves each in their description.
const UR: [(&str, &str); 6] = [
    ("shoulder", "shoulder_pan_joint"),
    ("upper_arm", "shoulder_lift_joint"),
    ("forearm", "elbow_joint"),
    ("wrist_1", "wrist_1_joint"),
    ("wrist_2", "wrist_2_joint"),
    ("wrist_3", "wrist_3_joint"),
];

pub(crate) fn read(text: &str, path: &Path) -> Result<LinkTree> {
    let values = values(text, path, EXPECTED)?;
    let refuse =
        |found: String| Err(ErrorKind::Model.error(format!("found {found}, expected {EXPECTED}")).in_file(path));
    let Some(first) = values.first() else { return refuse("no values".to_owned()) };
    // Franka's numbers are nested more deeply, below no other key.
    let is_franka = first.keys.get(1).is_some_and(|key| key == "kinematic");
    let own: &[&str] = if is_franka { &["kinematic"] } else { &[] };
    let above: &[&str] = if is_franka { &[] } else { &["kinematics"] };
    let mut known: BTreeMap<&str, BTreeMap<&str, &YamlValue>> = BTreeMap::new();
    for value in &values {
        if let Some((key, number)) = parts(value, above, own) {
            known.entry(key).or_default().insert(number, value);
        }
    }
    let has = |key: &str| known.contains_key(key);
    let keys: Vec<String> = if UR.iter().any(|(link, _)| has(link)) {
        UR.map(|(link, _)| link.to_owned()).to_vec()
    } else {
        (1..).map(|k| format!("joint{k}")).take_while(|key| has(key)).collect()
    };
    if keys.is_empty() {
        return refuse(format!("`{}`", first.keys.join(".")));
    }
    let names: BTreeSet<&str> = keys.iter().map(String::as_str).collect();
    let unknown = values.iter().find(|value| match parts(value, above, own) {
        Some((key, _)) => !names.contains(key),
        // Joint limits, masses and a checksum may be beside, but no other origin.
        None => strip(&value.keys, above).and_then(<[String]>::split_first).is_some_and(|(key, rest)| {
            let is_joint = names.contains(key.as_str()) || key.strip_prefix("joint").is_some_and(is_number);
            is_joint && !rest.is_empty() && strip(rest, own).is_some()
        }),
    });
    if let Some(value) = unknown {
        let message = format!(
            "found `{}`, expected origins of {} alone, each of {}: is a joint missing?",
            value.keys.join("."),
            first_few(&keys.iter().map(String::as_str).collect::<Vec<_>>()),
            NUMBERS.join(", ")
        );
        return Err(value.error(path, message));
    }
    let mut joints = keys.iter().map(|key| origin(known.get(key.as_str()), path, key)).collect::<Result<Vec<_>>>()?;
    if keys.first().is_some_and(|key| key == UR[0].0) {
        return Ok(ur_arm(&AxisFrames { joints, last_from_tip: Pose::identity() }));
    }
    // Franka's last joint is its flange, which does not move.
    let last_from_tip = if is_franka { joints.pop() } else { None }.unwrap_or_else(Pose::identity);
    let base = if is_franka { "link0" } else { "link_base" };
    let names: Vec<_> = (1..=joints.len()).map(|k| (format!("joint{k}"), format!("link{k}"))).collect();
    let tip = if is_franka { format!("link{}", joints.len() + 1) } else { "link_eef".to_owned() };
    Ok(serial_links("arm", base, &names, &tip, &AxisFrames { joints, last_from_tip }))
}

/// The key and the number's name of a value that is part of an origin.
fn parts<'a>(value: &'a YamlValue, above: &[&str], own: &[&str]) -> Option<(&'a str, &'a str)> {
    let rest = strip(&value.keys, above)?;
    let (key, rest) = rest.split_first()?;
    let (number, none) = strip(rest, own)?.split_first()?;
    (none.is_empty() && NUMBERS.contains(&number.as_str())).then_some((key.as_str(), number.as_str()))
}

fn strip<'a>(keys: &'a [String], first: &[&str]) -> Option<&'a [String]> {
    let (head, rest) = keys.split_at_checked(first.len())?;
    head.iter().eq(first).then_some(rest)
}

fn is_number(word: &str) -> bool {
    !word.is_empty() && word.bytes().all(|byte| byte.is_ascii_digit())
}

fn origin(of: Option<&BTreeMap<&str, &YamlValue>>, path: &Path, key: &str) -> Result<Pose> {
    let mut numbers = [0.0; 6];
    for (number, name) in numbers.iter_mut().zip(NUMBERS) {
        let Some(value) = of.and_then(|of| of.get(name)) else {
            return Err(ErrorKind::Model
                .error(format!("found no `{name}` of `{key}`, expected {}", NUMBERS.join(", ")))
                .in_file(path));
        };
        *number = value.number(path)?;
    }
    let [x, y, z, roll, pitch, yaw] = numbers;
    Ok(Pose::from_xyz_rpy([x, y, z], [roll, pitch, yaw]))
}

/// An arm of Universal Robots, with the names of its description.
pub(crate) fn ur_arm(frames: &AxisFrames) -> LinkTree {
    let names = UR.map(|(link, joint)| (joint.to_owned(), format!("{link}_link")));
    serial_links("ur", "base_link_inertia", &names, "tool0", frames)
}

/// A serial arm of joints that rotate about z.
fn serial_links(name: &str, base: &str, names: &[(String, String)], tip: &str, frames: &AxisFrames) -> LinkTree {
    let mut links = LinkTree::new(name);
    let mut parent = links.add(base, None);
    for ((joint, link), frame) in names.iter().zip(&frames.joints) {
        let child = links.add(link, None);
        let ends = (parent, child.clone());
        links.joints.push(LinkJoint::new(joint.clone(), LinkJointKind::Turns, ends, *frame));
        parent = child;
    }
    let tip = links.add(tip, None);
    links.fix(&parent, &tip, frames.last_from_tip);
    links
}
