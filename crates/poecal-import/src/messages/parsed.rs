//! Messages of robot_calibration as they stand in a file.

use std::path::Path;

use crate::pictures::region::{KEYS, Region};
use poecal_numerics::error::{ErrorKind, Result, first_few};
use poecal_storage::numbers::LARGEST_NUMBER;
use poecal_storage::yaml_tree::{Node, NodeKind, documents};

/// What such a file is.
pub(crate) const EXPECTED: &str =
    "messages of robot_calibration (CalibrationData) as YAML or JSON, with joint_states and observations";

/// A message: one configuration, and what sensors observed in it.
pub(crate) struct Message<'a> {
    pub(crate) node: &'a Node,
    /// Names and readings of the joints.
    pub(crate) joints: Vec<(&'a str, f64)>,
    pub(crate) observations: Vec<Observation<'a>>,
}

/// What a sensor observed.
pub(crate) struct Observation<'a> {
    pub(crate) node: &'a Node,
    pub(crate) sensor: &'a str,
    /// The frame of the features.
    pub(crate) frame: &'a str,
    pub(crate) features: Vec<Feature<'a>>,
    /// The camera, where the message states its lens.
    pub(crate) camera: Option<CameraInfo>,
}

/// A point that a sensor observed.
pub(crate) struct Feature<'a> {
    pub(crate) node: &'a Node,
    pub(crate) at: [f64; 3],
}

/// The lens of a camera as ROS has it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CameraInfo {
    pub(crate) size_px: [f64; 2],
    pub(crate) k: [f64; 9],
    pub(crate) d: Vec<f64>,
    pub(crate) model: String,
    /// The part of the sensor that the pictures show.
    pub(crate) region: Region,
}

/// The messages of a file: each a document, or in a list.
pub(crate) fn nodes(text: &str, path: &Path) -> Result<Vec<Node>> {
    let mut found = Vec::new();
    for document in documents(text, path, EXPECTED)? {
        match document.kind {
            NodeKind::List(entries) => found.extend(entries),
            // Behind the last `---`.
            NodeKind::Text(text) if text.trim().is_empty() || text == "~" || text == "null" => {}
            kind @ (NodeKind::Map(_) | NodeKind::Text(_)) => found.push(Node { kind, ..document }),
        }
    }
    Ok(found)
}

/// A message with its parts.
pub(crate) fn message<'a>(node: &'a Node, path: &Path) -> Result<Message<'a>> {
    let states = required(node, "joint_states", path)?;
    let names = list(required(states, "name", path)?, "names of joints", path)?;
    let positions = list(required(states, "position", path)?, "positions of joints", path)?;
    if names.len() != positions.len() {
        let message = format!(
            "found {} names and {} positions in `joint_states`, expected as many",
            names.len(),
            positions.len()
        );
        return Err(states.error(path, message));
    }
    let mut joints = Vec::with_capacity(names.len());
    for (name, position) in names.iter().zip(positions) {
        let own = name.text().filter(|name| !name.is_empty() && !name.chars().any(char::is_control));
        let own = own.ok_or_else(|| name.error(path, "found no name of a joint, expected one"))?;
        if joints.iter().any(|(other, _)| *other == own) {
            return Err(
                name.error(path, format!("found the joint `{own}` twice in `name`, expected it once"))
            );
        }
        joints.push((own, number(position, own, path)?));
    }
    let observations = list(required(node, "observations", path)?, "observations", path)?;
    let observations = observations.iter().map(|node| observation(node, path)).collect::<Result<_>>()?;
    Ok(Message { node, joints, observations })
}

fn observation<'a>(node: &'a Node, path: &Path) -> Result<Observation<'a>> {
    let sensor = required(node, "sensor_name", path)?;
    let sensor = word(sensor).ok_or_else(|| sensor.error(path, "found no name of a sensor, expected one"))?;
    let mut features = Vec::new();
    let mut frame = "";
    for node in list(required(node, "features", path)?, "features", path)? {
        let point = required(node, "point", path)?;
        let mut at = [0.0; 3];
        for (value, axis) in at.iter_mut().zip(["x", "y", "z"]) {
            *value = number(required(point, axis, path)?, axis, path)?;
        }
        let own = node.get("header").and_then(|it| it.get("frame_id")).and_then(word).unwrap_or_default();
        if !features.is_empty() && own != frame {
            let message = format!(
                "found a feature of `{sensor}` in the frame `{own}` beside `{frame}`, expected one frame"
            );
            return Err(node.error(path, message));
        }
        frame = own;
        features.push(Feature { node: point, at });
    }
    let info = node.get("ext_camera_info").and_then(|it| it.get("camera_info"));
    let camera = info.map(|info| camera_info(info, path)).transpose()?.flatten();
    Ok(Observation { node, sensor, frame, features, camera })
}

/// A name on one line.
fn word(node: &Node) -> Option<&str> {
    node.text().filter(|text| !text.is_empty() && !text.chars().any(char::is_control))
}

/// The lens; `None` of an empty message.
fn camera_info(node: &Node, path: &Path) -> Result<Option<CameraInfo>> {
    let either = |small: &str, large: &str| node.get(small).or_else(|| node.get(large));
    let Some(k) = either("k", "K") else { return Ok(None) };
    let numbers = |node: &Node, name: &str| -> Result<Vec<f64>> {
        list(node, name, path)?.iter().map(|node| number(node, name, path)).collect()
    };
    let matrix = numbers(k, "K")?;
    let count = matrix.len();
    let matrix: [f64; 9] = matrix.try_into().map_err(|_| {
        k.error(path, format!("found {count} numbers of the camera's matrix `K`, expected 9"))
    })?;
    if matrix.iter().all(|it| *it == 0.0) {
        return Ok(None);
    }
    let d = either("d", "D").map(|node| numbers(node, "D")).transpose()?.unwrap_or_default();
    let size = |key: &str| node.get(key).map(|node| number(node, key, path)).transpose();
    let size_px = [size("width")?.unwrap_or(0.0), size("height")?.unwrap_or(0.0)];
    let model = node.get("distortion_model").and_then(Node::text).unwrap_or_default().to_owned();
    let mut part = [0.0; KEYS.len()];
    for (value, keys) in part.iter_mut().zip(KEYS) {
        let found = keys.split('.').try_fold(node, |node, key| node.get(key));
        *value = found.map_or(Ok(0.0), |node| number(node, keys, path))?;
    }
    let region = Region::new(part).map_err(|found| node.error(path, found))?;
    Ok(Some(CameraInfo { size_px, k: matrix, d, model, region }))
}

fn required<'a>(node: &'a Node, key: &str, path: &Path) -> Result<&'a Node> {
    node.get(key).ok_or_else(|| {
        let has = match &node.kind {
            NodeKind::Map(entries) => {
                let keys: Vec<&str> = entries.iter().map(|(key, _)| key.as_str()).collect();
                format!("{} without `{key}`", first_few(&keys))
            }
            NodeKind::Text(text) if text == "..." => return cut(node, path),
            NodeKind::Text(text) => format!("`{text}`"),
            NodeKind::List(_) => "a list".to_owned(),
        };
        node.error(path, format!("found {has}, expected {EXPECTED}"))
    })
}

fn list<'a>(node: &'a Node, what: &str, path: &Path) -> Result<&'a [Node]> {
    node.list().ok_or_else(|| node.error(path, format!("found no list of {what}, expected {EXPECTED}")))
}

/// The error of a list that was printed in part.
fn cut(node: &Node, path: &Path) -> poecal_numerics::error::Error {
    let message = "found `...` in place of the rest of a list, expected all of it: record with `ros2 topic echo --full-length`";
    node.error(path, message)
}

fn number(node: &Node, name: &str, path: &Path) -> Result<f64> {
    let text = node.text().unwrap_or("a list");
    if text == "..." {
        return Err(cut(node, path));
    }
    let found = text.parse::<f64>().ok().filter(|it| it.is_finite() && it.abs() <= LARGEST_NUMBER);
    found.ok_or_else(|| {
        let message =
            format!("found `{text}` for `{name}`, expected a finite number of at most {LARGEST_NUMBER:e}");
        ErrorKind::Measurement.error(message).at(path, node.line, node.column)
    })
}
