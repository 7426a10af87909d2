//! PAL Robotics' master calibration: differences of the origins of a URDF, which its state publisher adds.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::path::Path;

use super::origins::{self, quote_yaml};
use super::{ExportedText, Proof, export_error, is_same, remaining_difference};
use crate::model::{Model, ModelSource};
use poecal_formats::urdf::UrdfOrigin;
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;
use poecal_storage::yaml::values;

/// Ends of the keys of a joint.
const PARTS: [&str; 6] = ["_dx", "_dy", "_dz", "_droll", "_dpitch", "_dyaw"];
/// Smaller differences (metres, radians) are rounding.
const NONE: f64 = 1e-15;

pub(crate) fn write(model: &Model, robot: &Robot) -> Result<ExportedText> {
    let kept = match &model.source {
        ModelSource::Calibration(file) => file.original_urdf(&model.path)?,
        ModelSource::Urdf(_) | ModelSource::Toml => None,
    };
    let Some(document) = kept.filter(|_| robot.is_serial()) else {
        let message = "found no URDF in the calibration whose origins could be corrected, expected the calibration of a chain of one";
        return Err(export_error(message.to_owned()));
    };
    let (before, after) = (document.origins(), origins::corrected_origins(&document, robot, &model.path)?);
    let mut text = String::new();
    for (origin, after) in before.iter().zip(&after) {
        for (end, difference) in PARTS.iter().zip(differences(origin, after)) {
            if difference.abs() > NONE {
                let _ = writeln!(text, "    {}: {difference:?}", quote_yaml(&format!("{}{end}", origin.joint)));
            }
        }
    }
    let mut notes = Vec::new();
    let again = document.with_origins(&add_numbers(&before, &read(&text)?));
    let remains = remaining_difference(robot, &again);
    let mut head = "# Differences of the origins of the joints: metres, and radians of roll, pitch, yaw.\n".to_owned();
    if !is_same(robot, &remains) {
        let lost = format!(
            "origins alone cannot hold all of it (an axis was turned, or the tip has no fixed joint): the tip is off by up to {:.4} mm and {:.5} deg",
            remains.position_m * 1e3,
            remains.rotation_rad.to_degrees()
        );
        let _ = writeln!(head, "# {lost}");
        notes.push(lost);
    }
    head.push_str("robot_state_publisher:\n  geometric_calibration:\n");
    Ok(ExportedText { text: head + &text, notes, proof: Proof::Remains(remains) })
}

/// Numbers by their names.
fn read(text: &str) -> Result<BTreeMap<String, f64>> {
    let path = Path::new("master_calibration.yaml");
    // An unchanged robot has an empty text.
    let values = if text.is_empty() { Vec::new() } else { values(text, path, "differences of origins")? };
    values.into_iter().map(|value| Ok((value.keys.concat(), value.number(path)?))).collect()
}

/// Addition to an origin; of the two equivalent sets of angles the smaller one.
fn differences(before: &UrdfOrigin, after: &UrdfOrigin) -> [f64; 6] {
    let turn = |angle: f64| angle - TAU * (angle / TAU).round();
    let by = |rpy: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| turn(rpy[k] - before.rpy[k])) };
    let [roll, pitch, yaw] = after.rpy;
    let (one, other) = (by([roll, pitch, yaw]), by([roll + PI, PI - pitch, yaw + PI]));
    let size = |rpy: &[f64; 3]| rpy.iter().map(|it| it * it).sum::<f64>();
    let [a, b, c] = if size(&other) < size(&one) { other } else { one };
    let [x, y, z] = std::array::from_fn(|k| after.xyz[k] - before.xyz[k]);
    [x, y, z, a, b, c]
}

/// Origins with the file's differences added.
fn add_numbers(origins: &[UrdfOrigin], numbers: &BTreeMap<String, f64>) -> Vec<UrdfOrigin> {
    let of = |origin: &UrdfOrigin| {
        let added: [f64; 6] = PARTS.map(|end| numbers.get(&format!("{}{end}", origin.joint)).copied().unwrap_or(0.0));
        UrdfOrigin {
            joint: origin.joint.clone(),
            xyz: std::array::from_fn(|k| origin.xyz[k] + added[k]),
            rpy: std::array::from_fn(|k| origin.rpy[k] + added[k + 3]),
        }
    };
    origins.iter().map(of).collect()
}
