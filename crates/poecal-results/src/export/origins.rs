//! Origins of joints with their axes along z, as URDF has them: YAML for the descriptions of several makers, and CSV.

use std::fmt::Write as _;
use std::path::Path;

use super::{ExportedText, Proof, export_error, is_same, read_back, remaining_difference, unreadable_error};
use crate::model::Model;
use poecal_arm::lie::{Pose, rotation};
use poecal_formats::urdf::{UrdfDocument, UrdfOrigin, origin_values};
use poecal_model::forms::AxisFrames;
use poecal_model::robot::{JointKind, Robot};
use poecal_numerics::error::Result;
use poecal_numerics::text::escape_invisible;
use poecal_storage::csv_text;
use poecal_storage::numbers::format_shortest;
use poecal_storage::yaml::values;

/// Numbers of an origin: `R = Rz(yaw) Ry(pitch) Rx(roll)`.
const NUMBERS: [&str; 6] = ["x", "y", "z", "roll", "pitch", "yaw"];
/// Links of Universal Robots' arms, by the joint that moves each.
const UR_LINKS: [&str; 6] = ["shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3"];
/// Smaller parts of a tool (metres, radians) are rounding.
const NO_TOOL: f64 = 1e-12;

const NO_HASH: &str = "the file has no `hash`, which the driver compares with the controller's checksum and complains of if it is another: state it \
                       with --hash calib_…, as the driver's own extraction prints it";

/// Maker of the file's reader.
pub(crate) enum Flavour<'a> {
    /// Joints by their own names.
    Names,
    /// Universal Robots' driver, with the controller's checksum.
    Ur(Option<&'a str>),
    /// uFactory.
    Xarm,
    /// Franka: the flange is an eighth joint.
    Franka,
}

impl Flavour<'_> {
    fn keys(&self, robot: &Robot) -> Result<Vec<String>> {
        let count = robot.joints.len();
        let numbered = |count: usize| (1..=count).map(|k| format!("joint{k}")).collect();
        let expected = |wanted: usize, of: &str| {
            let message = format!("found {count} joints, expected the {wanted} of {of}");
            if count == wanted { Ok(()) } else { Err(export_error(message)) }
        };
        if let Some(joint) = robot.joints.iter().find(|it| it.kind != JointKind::Revolute)
            && !matches!(self, Flavour::Names)
        {
            return Err(export_error(format!("found joint `{}`, which slides, expected joints that turn", joint.name)));
        }
        match self {
            Flavour::Names => Ok(robot.joints.iter().map(|it| it.name.clone()).collect()),
            Flavour::Ur(_) => {
                expected(UR_LINKS.len(), "an arm of Universal Robots")?;
                Ok(UR_LINKS.map(str::to_owned).to_vec())
            }
            Flavour::Xarm if !(5..=7).contains(&count) => {
                Err(export_error(format!("found {count} joints, expected the 5, 6 or 7 of an arm of uFactory")))
            }
            Flavour::Xarm => Ok(numbered(count)),
            Flavour::Franka => {
                expected(7, "an arm of Franka")?;
                Ok(numbered(count))
            }
        }
    }
}

pub(crate) fn write(model: &Model, robot: &Robot, flavour: &Flavour<'_>) -> Result<ExportedText> {
    let document = model.document()?;
    if let (Flavour::Names, Some(document)) = (flavour, &document)
        && let Some(written) = write_own(document, robot, &model.path)?
    {
        return Ok(written);
    }
    let mut frames = AxisFrames::from_robot(robot)?;
    // A table of screws has no frames; that of a URDF is the flange.
    if document.is_none() && matches!(flavour, Flavour::Ur(_) | Flavour::Xarm) {
        frames.end_at_tip();
    }
    let before = document.map_or_else(Pose::identity, |document| document.base_from_first_parent());
    if let Some(first) = frames.joints.first_mut() {
        *first = before.inverse() * *first;
    }
    let keys = flavour.keys(robot)?;
    let mut text = format!(
        "# Origins of the joints of {}, calibrated: metres and radians, R = Rz(yaw) Ry(pitch) Rx(roll) as in URDF; each joint turns about z.\n",
        escape_invisible(&robot.name)
    );
    let mut notes = Vec::new();
    let is_franka = matches!(flavour, Flavour::Franka);
    let (head, indent) = match flavour {
        Flavour::Franka => ("", ""),
        Flavour::Names => ("origins:\n", "  "),
        Flavour::Ur(_) | Flavour::Xarm => ("kinematics:\n", "  "),
    };
    text.push_str(head);
    for (key, frame) in keys.iter().zip(&frames.joints) {
        push_origin(&mut text, indent, &quote_yaml(key), named_numbers(frame), is_franka);
    }
    if is_franka {
        push_origin(&mut text, indent, "joint8", named_numbers(&frames.last_from_tip), true);
    }
    match flavour {
        Flavour::Ur(Some(hash)) => text.push_str(&format!("  hash: {}\n", quote_yaml(hash))),
        Flavour::Ur(None) => notes.push(NO_HASH.to_owned()),
        Flavour::Names | Flavour::Xarm | Flavour::Franka => {}
    }
    if !is_franka && !is_none(&frames.last_from_tip) {
        notes.push(push_tool(&mut text, robot, &frames.last_from_tip));
    }
    if !is_none(&before) {
        let stands = format!(
            "the first origin counts from the link on which the first joint stands, which is at {} in `{}` by fixed joints of the URDF",
            format_pose(&before),
            robot.base_name
        );
        let _ = writeln!(text, "# {}", escape_invisible(&stands));
        notes.push(stands);
    }
    let mut again = frames_of(&text, flavour, &keys, frames.last_from_tip)?;
    if let Some(first) = again.joints.first_mut() {
        *first = before * *first;
    }
    Ok(ExportedText { text, notes, proof: Proof::Again(again.robot(robot)?.into()) })
}

/// The frames of a text as written here; most forms have no place for the tip.
fn frames_of(text: &str, flavour: &Flavour<'_>, keys: &[String], last_from_tip: Pose) -> Result<AxisFrames> {
    match flavour {
        Flavour::Names => {
            let joints = read(text, keys)?.into_iter().map(|(xyz, rpy)| Pose::from_xyz_rpy(xyz, rpy));
            Ok(AxisFrames { joints: joints.collect(), last_from_tip })
        }
        Flavour::Franka => AxisFrames::from_robot(&read_back(text, "arm.yaml", None)?),
        Flavour::Ur(_) | Flavour::Xarm => {
            let read = AxisFrames::from_robot(&read_back(text, "arm.yaml", None)?)?;
            Ok(AxisFrames { last_from_tip, ..read })
        }
    }
}

/// Origins of the joints of the URDF that was calibrated, including fixed ones, with its axes. `None` if an axis turned in its frame.
fn write_own(document: &UrdfDocument, robot: &Robot, path: &Path) -> Result<Option<ExportedText>> {
    if !robot.is_serial() {
        return Ok(None);
    }
    let origins = corrected_origins(document, robot, path)?;
    let mut text = format!(
        "# Origins of the joints of {}, calibrated: metres and radians, R = Rz(yaw) Ry(pitch) Rx(roll), for the axes of the URDF that was \
         calibrated.\norigins:\n",
        escape_invisible(&robot.name)
    );
    for origin in &origins {
        let numbers = NUMBERS.into_iter().zip(origin.xyz.into_iter().chain(origin.rpy));
        push_origin(&mut text, "  ", &quote_yaml(&origin.joint), numbers, false);
    }
    let keys: Vec<String> = origins.iter().map(|origin| origin.joint.clone()).collect();
    let read =
        keys.iter().zip(read(&text, &keys)?).map(|(joint, (xyz, rpy))| UrdfOrigin { joint: joint.clone(), xyz, rpy });
    let mut again = document.with_origins(&read.collect::<Vec<_>>());
    let tool = again.home.inverse() * robot.home;
    let mut notes = Vec::new();
    if !is_none(&tool) {
        notes.push(push_tool(&mut text, robot, &tool));
        again.home = robot.home;
    }
    let is_whole = is_same(robot, &remaining_difference(robot, &again));
    Ok(is_whole.then_some(ExportedText { text, notes, proof: Proof::Again(again.into()) }))
}

/// The origins of a URDF's joints after a calibration, in its order.
pub(crate) fn corrected_origins(document: &UrdfDocument, robot: &Robot, path: &Path) -> Result<Vec<UrdfOrigin>> {
    let patched = document.patch(robot)?;
    let after = UrdfDocument::parse(&patched.text, path, &patched.selection)?.origins();
    let of = |before: UrdfOrigin| after.iter().find(|it| it.joint == before.joint).cloned().unwrap_or(before);
    Ok(document.origins().into_iter().map(of).collect())
}

/// States the tip, which the file has no place for; returns the words of a note.
fn push_tool(text: &mut String, robot: &Robot, tool: &Pose) -> String {
    let turn = rotation::log(&tool.rotation);
    let _ = writeln!(
        text,
        "# The tip `{}` in the frame of the last joint, which this file has no place for: {}",
        escape_invisible(&robot.tip_name),
        format_pose(tool)
    );
    format!(
        "the file has no place for the tip in the last joint's frame, which is a comment in it: enter it as the tool, {:.3}, {:.3}, {:.3} mm, \
         rotation vector {:.5}, {:.5}, {:.5} rad",
        tool.translation.x * 1e3,
        tool.translation.y * 1e3,
        tool.translation.z * 1e3,
        turn.x,
        turn.y,
        turn.z
    )
}

/// The numbers of an origin with their names.
fn named_numbers(pose: &Pose) -> impl Iterator<Item = (&'static str, f64)> {
    let (xyz, rpy) = origin_values(pose);
    NUMBERS.into_iter().zip(xyz.into_iter().chain(rpy))
}

/// The numbers of an origin with their names, on one line.
fn format_pose(pose: &Pose) -> String {
    let parts: Vec<String> =
        named_numbers(pose).map(|(name, number)| format!("{name}: {}", format_shortest(number))).collect();
    parts.join(", ")
}

fn push_origin(
    text: &mut String,
    indent: &str,
    key: &str,
    numbers: impl Iterator<Item = (&'static str, f64)>,
    is_franka: bool,
) {
    let _ = writeln!(text, "{indent}{key}:");
    if is_franka {
        let _ = writeln!(text, "{indent}  kinematic:");
    }
    let deeper = if is_franka { "  " } else { "" };
    for (name, number) in numbers {
        let _ = writeln!(text, "{indent}{deeper}  {name}: {}", yaml_number(number));
    }
}

/// A number that YAML reads as one with decimals.
fn yaml_number(number: f64) -> String {
    let text = format!("{number:?}");
    // YAML 1.1 requires a point before an exponent.
    match text.split_once('e') {
        Some((digits, power)) if !digits.contains('.') => format!("{digits}.0e{power}"),
        _ => text,
    }
}

fn is_none(tool: &Pose) -> bool {
    tool.translation.norm() < NO_TOOL && rotation::log(&tool.rotation).norm() < NO_TOOL
}

/// A key or text of YAML, in quotes unless it is plain.
pub(crate) fn quote_yaml(text: &str) -> String {
    let is_plain = text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        && text.starts_with(|c: char| c.is_ascii_alphabetic())
        && !["y", "n", "yes", "no", "on", "off", "true", "false", "null"].contains(&text.to_ascii_lowercase().as_str());
    if is_plain {
        return text.to_owned();
    }
    // YAML breaks lines at more characters than JSON escapes.
    let mut found = String::new();
    for c in serde_json::Value::from(text).to_string().chars() {
        match c {
            ' '..='~' => found.push(c),
            c if u32::from(c) <= 0xffff && (c.is_control() || c.is_whitespace()) => {
                let _ = write!(found, "\\u{:04x}", u32::from(c));
            }
            c => found.push(c),
        }
    }
    found
}

/// Position, and roll, pitch, yaw, of the joints by their keys, of a text as written here.
fn read(text: &str, keys: &[String]) -> Result<Vec<([f64; 3], [f64; 3])>> {
    let path = Path::new("origins.yaml");
    let values = values(text, path, "origins of joints")?;
    let origin = |key: &String| {
        let mut numbers = [0.0; 6];
        for (number, name) in numbers.iter_mut().zip(NUMBERS) {
            let found = values.iter().find(|value| value.keys.iter().eq(["origins", key, name]));
            *number = found.ok_or_else(|| unreadable_error(&format!("no number `{name}` of `{key}`")))?.number(path)?;
        }
        let [x, y, z, roll, pitch, yaw] = numbers;
        Ok(([x, y, z], [roll, pitch, yaw]))
    };
    keys.iter().map(origin).collect()
}

/// Origins as a table.
pub(crate) fn write_csv(robot: &Robot) -> Result<ExportedText> {
    let frames = AxisFrames::from_robot(robot)?;
    let mut text = "joint,kind,x[m],y[m],z[m],roll[rad],pitch[rad],yaw[rad]\n".to_owned();
    let names = robot.joints.iter().map(|it| (it.name.as_str(), it.kind.word()));
    let rows = names.chain([(robot.tip_name.as_str(), "tip")]);
    for ((name, kind), frame) in rows.zip(frames.joints.iter().chain([&frames.last_from_tip])) {
        let numbers: Vec<String> = named_numbers(frame).map(|(_, number)| format_shortest(number)).collect();
        let _ = writeln!(text, "{},{kind},{}", csv_text::cell(name), numbers.join(","));
    }
    let mut poses = Vec::new();
    for line in text.lines().skip(1) {
        let mut cells = line.rsplitn(7, ',');
        let mut values = [0.0; 6];
        for value in values.iter_mut().rev() {
            *value = cells
                .next()
                .and_then(|cell| cell.parse().ok())
                .ok_or_else(|| unreadable_error("a cell that is no number"))?;
        }
        let [x, y, z, roll, pitch, yaw] = values;
        poses.push(Pose::from_xyz_rpy([x, y, z], [roll, pitch, yaw]));
    }
    let last_from_tip = poses.pop().ok_or_else(|| unreadable_error("no row"))?;
    let again = AxisFrames { joints: poses, last_from_tip }.robot(robot)?;
    Ok(ExportedText { text, notes: Vec::new(), proof: Proof::Again(again.into()) })
}
