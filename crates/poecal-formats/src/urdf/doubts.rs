//! Signs of other units in a URDF, which states none: radians and metres.

use std::f64::consts::PI;

use nalgebra::Vector3;

use super::UrdfDocument;
use poecal_model::robot::{JointKind, Robot};

/// Limit (rad) beyond which a whole number looks like degrees: two turns.
const TURNS: f64 = 4.0 * PI;
/// Rotation of an origin (rad) larger than any that is needed.
const TURN: f64 = 2.0 * PI + 0.01;
/// Distance of two joints (m) that looks like millimetres.
const FAR_M: f64 = 50.0;

/// Signs of degrees, millimetres or placeholders, a sentence each.
pub fn doubts(document: &UrdfDocument, robot: &Robot) -> Vec<String> {
    let mut found = Vec::new();
    let is_degrees = |it: f64| it.abs() > TURNS && it.fract() == 0.0;
    for joint in robot.joints.iter().filter(|it| it.kind == JointKind::Revolute) {
        if let Some(limits) = joint.limits.filter(|it| is_degrees(it.lower) || is_degrees(it.upper)) {
            found.push(format!(
                "joint `{}` has limits from {} to {}, which look like degrees, expected radians: write `lower=\"{:.4}\" upper=\"{:.4}\"` if they are",
                joint.name,
                limits.lower,
                limits.upper,
                limits.lower.to_radians(),
                limits.upper.to_radians()
            ));
        }
    }
    found.extend_from_slice(document.remarks());
    found.extend(find_degree_turns(document.text()));
    let origins = robot.joints.iter().map(|it| it.frame.translation);
    let before = std::iter::once(Vector3::zeros()).chain(origins.clone());
    for ((from, to), joint) in before.zip(origins).zip(&robot.joints) {
        let apart = (to - from).norm();
        if apart > FAR_M {
            found.push(format!(
                "joint `{}` is {apart:.0} m from what is before it, which looks like millimetres, expected metres: divide the lengths by 1000 if they are",
                joint.name
            ));
        }
    }
    found.extend(robot.placeholder_masses());
    found
}

/// The first rotations that look like degrees.
fn find_degree_turns(text: &str) -> Option<String> {
    let mut lines = text.lines().zip(1..).filter_map(|(line, number)| {
        let (_, rest) = line.split_once("rpy=")?;
        let quote = rest.chars().next().filter(|it| ['"', '\''].contains(it))?;
        let value = rest.get(1..)?.split(quote).next()?;
        let angles: Vec<f64> = value.split_whitespace().map(str::parse).collect::<Result<_, _>>().ok()?;
        angles.iter().any(|it| it.abs() > TURN).then(|| (number, value.to_owned()))
    });
    let (line, value) = lines.next()?;
    let more = lines.count();
    let others = if more == 0 { String::new() } else { format!(" (and on {more} more lines)") };
    let radians: Vec<String> = value
        .split_whitespace()
        .filter_map(|it| it.parse::<f64>().ok())
        .map(|it| format!("{}", (it.to_radians() * 1e6).round() / 1e6))
        .collect();
    Some(format!(
        "line {line} has `rpy=\"{value}\"`{others}, which looks like degrees, expected radians: write `rpy=\"{}\"` if it is",
        radians.join(" ")
    ))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::urdf::ChainSelection;

    fn doubts_of_joints(joints: &str) -> Vec<String> {
        let text = format!(
            "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><link name=\"c\"/>\n{joints}\n<joint name=\"two\" type=\"revolute\"><parent link=\"b\"/><child link=\"c\"/><origin xyz=\"0.4 0 0\"/><axis xyz=\"0 1 0\"/><limit lower=\"-3.1\" upper=\"3.1\"/></joint></robot>"
        );
        let document = UrdfDocument::parse(&text, Path::new("r.urdf"), &ChainSelection::default()).unwrap();
        let robot = document.robot().clone();
        doubts(&document, &robot)
    }

    fn joint(origin: &str, limit: &str) -> String {
        format!(
            "<joint name=\"one\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/>\n<origin {origin}/>\n<axis xyz=\"0 0 1\"/><limit {limit}/></joint>"
        )
    }

    #[test]
    fn masses_of_exactly_one_kilogram_are_placeholders() {
        let link = |name: &str, mass: &str| {
            format!(
                "<link name=\"{name}\"><inertial><origin xyz=\"0 0 0.1\"/><mass value=\"{mass}\"/></inertial></link>"
            )
        };
        let of = |masses: [&str; 2]| {
            let text = format!(
                "<robot name=\"r\"><link name=\"a\"/>{}{}\n{}\n<joint name=\"two\" type=\"revolute\"><parent link=\"b\"/><child link=\"c\"/><origin xyz=\"0.4 0 0\"/><axis xyz=\"0 1 0\"/><limit lower=\"-3.1\" upper=\"3.1\"/></joint></robot>",
                link("b", masses[0]),
                link("c", masses[1]),
                joint("xyz=\"0 0 0.3\"", "lower=\"-2.9\" upper=\"2.9\"")
            );
            let document = UrdfDocument::parse(&text, Path::new("r.urdf"), &ChainSelection::default()).unwrap();
            let robot = document.robot().clone();
            doubts(&document, &robot)
        };
        let found = of(["1.0", "1"]);
        assert!(
            found.len() == 1 && found[0].starts_with("2 of the 2 moving links with a mass have exactly 1 kg"),
            "{found:?}"
        );
        assert!(of(["1.0", "3.2"]).is_empty() && of(["2", "2"]).is_empty());
    }

    #[test]
    fn degrees_and_millimetres_are_said_and_usual_numbers_are_not() {
        for (origin, limit, words) in [
            ("xyz=\"0 0 0.3\" rpy=\"0 1.57 -6.28\"", "lower=\"-2.9\" upper=\"2.9\"", ""),
            // Axes with many turns, in radians that are no whole numbers.
            ("xyz=\"0 0 0.3\"", "lower=\"-1520.53\" upper=\"1520.53\"", ""),
            ("xyz=\"0 0 0.3\"", "lower=\"-160\" upper=\"160\"", "write `lower=\"-2.7925\" upper=\"2.7925\"`"),
            (
                "rpy=\"0 90 0\" xyz=\"0 0 0.3\"",
                "lower=\"-2.9\" upper=\"2.9\"",
                "line 3 has `rpy=\"0 90 0\"`, which looks like degrees, expected radians: write `rpy=\"0 1.570796 0\"`",
            ),
        ] {
            let found = doubts_of_joints(&joint(origin, limit));
            assert_eq!(found.len(), usize::from(!words.is_empty()), "{found:?}");
            assert!(found.iter().all(|it| it.contains(words)), "{found:?}");
        }
        let far = doubts_of_joints(&joint("xyz=\"0 0 400\"", "lower=\"-2.9\" upper=\"2.9\""));
        assert!(far.len() == 1 && far.iter().all(|it| it.contains("looks like millimetres")), "{far:?}");
    }
}
