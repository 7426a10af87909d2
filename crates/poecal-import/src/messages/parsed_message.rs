//! Messages of robot_calibration, parsed from a file.

use std::path::Path;

use poecal_model::camera::{REGION_KEYS, Region};
use poecal_numerics::error::{Result, first_few};
use poecal_storage::numbers::LARGEST_NUMBER;
use poecal_storage::yaml_tree::{NodeKind, YamlNode, documents};

/// Description of such a file in errors.
pub(crate) const EXPECTED: &str =
    "messages of robot_calibration (CalibrationData) as YAML or JSON, with joint_states and observations";

/// A message: one configuration, and the observations of the sensors there.
pub(crate) struct ParsedMessage<'a> {
    pub(crate) node: &'a YamlNode,
    /// Names and readings of the joints.
    pub(crate) joints: Vec<(&'a str, f64)>,
    pub(crate) observations: Vec<SensorObservation<'a>>,
}

/// An observation of a sensor.
pub(crate) struct SensorObservation<'a> {
    pub(crate) node: &'a YamlNode,
    pub(crate) sensor: &'a str,
    /// The frame of the features.
    pub(crate) frame: &'a str,
    pub(crate) features: Vec<Feature<'a>>,
    /// The camera, if the message states its lens.
    pub(crate) camera: Option<CameraInfo>,
}

/// A point that a sensor observed.
pub(crate) struct Feature<'a> {
    pub(crate) node: &'a YamlNode,
    pub(crate) at: [f64; 3],
}

/// The lens of a camera in the form of ROS.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CameraInfo {
    pub(crate) size_px: [f64; 2],
    pub(crate) k: [f64; 9],
    pub(crate) d: Vec<f64>,
    pub(crate) model: String,
    /// The region of the sensor that the pictures show.
    pub(crate) region: Region,
}

/// Placeholder of the path in errors; the reader of the file replaces it.
pub(crate) const NO_PATH: &str = "";

/// Refuses a part of a file.
pub(crate) trait PartRefusal {
    /// The error at its place.
    fn refuse<T>(&self, message: impl Into<String>) -> Result<T>;
}

impl PartRefusal for YamlNode {
    fn refuse<T>(&self, message: impl Into<String>) -> Result<T> {
        Err(self.error(Path::new(NO_PATH), message))
    }
}

/// The messages of a file: each is a document, or an entry of a list.
pub(crate) fn nodes(text: &str) -> Result<Vec<YamlNode>> {
    let mut found = Vec::new();
    for document in documents(text, Path::new(NO_PATH), EXPECTED)? {
        match document.kind {
            NodeKind::List(entries) => found.extend(entries),
            // An empty document is behind the last `---`.
            NodeKind::Text(text) if text.trim().is_empty() || text == "~" || text == "null" => {}
            kind @ (NodeKind::Map(_) | NodeKind::Text(_)) => found.push(YamlNode { kind, ..document }),
        }
    }
    Ok(found)
}

/// A message with its parts.
pub(crate) fn message(node: &YamlNode) -> Result<ParsedMessage<'_>> {
    let states = require_key(node, "joint_states")?;
    let names = list(require_key(states, "name")?, "names of joints")?;
    let positions = list(require_key(states, "position")?, "positions of joints")?;
    let counts = (names.len(), positions.len());
    if counts.0 != counts.1 {
        return states.refuse(format!(
            "found {} names and {} positions in `joint_states`, expected as many",
            counts.0, counts.1
        ));
    }
    let mut joints = Vec::with_capacity(names.len());
    for (name, position) in names.iter().zip(positions) {
        let own = word(name, "a joint")?;
        if joints.iter().any(|(other, _)| *other == own) {
            return name.refuse(format!("found the joint `{own}` twice in `name`, expected it once"));
        }
        joints.push((own, number(position, own)?));
    }
    let observations = list(require_key(node, "observations")?, "observations")?;
    Ok(ParsedMessage { node, joints, observations: observations.iter().map(observation).collect::<Result<_>>()? })
}

fn observation(node: &YamlNode) -> Result<SensorObservation<'_>> {
    let sensor = word(require_key(node, "sensor_name")?, "a sensor")?;
    let mut features = Vec::new();
    let mut frame = "";
    for node in list(require_key(node, "features")?, "features")? {
        let point = require_key(node, "point")?;
        let mut at = [0.0; 3];
        for (value, axis) in at.iter_mut().zip(["x", "y", "z"]) {
            *value = number(require_key(point, axis)?, axis)?;
        }
        let own = node.get("header").and_then(|it| it.get("frame_id")).and_then(name).unwrap_or_default();
        if !features.is_empty() && own != frame {
            return node.refuse(format!(
                "found a feature of `{sensor}` in the frame `{own}` beside `{frame}`, expected one frame"
            ));
        }
        frame = own;
        features.push(Feature { node: point, at });
    }
    let info = node.get("ext_camera_info").and_then(|it| it.get("camera_info"));
    let camera = info.map(camera_info).transpose()?.flatten();
    Ok(SensorObservation { node, sensor, frame, features, camera })
}

/// A name on one line, if it is one.
fn name(node: &YamlNode) -> Option<&str> {
    node.text().filter(|text| !text.is_empty() && !text.chars().any(char::is_control))
}

/// The name of something.
fn word<'a>(node: &'a YamlNode, of: &str) -> Result<&'a str> {
    name(node).map_or_else(|| node.refuse(format!("found no name of {of}, expected one")), Ok)
}

/// The lens; `None` if the message is empty.
fn camera_info(node: &YamlNode) -> Result<Option<CameraInfo>> {
    let either = |small: &str, large: &str| node.get(small).or_else(|| node.get(large));
    let numbers = |node: &YamlNode, name: &str| -> Result<Vec<f64>> {
        list(node, name)?.iter().map(|node| number(node, name)).collect()
    };
    let stated = |keys: &[&str]| {
        let found = keys.iter().try_fold(node, |node, key| node.get(key));
        found.map_or(Ok(0.0), |node| number(node, &keys.join(".")))
    };
    let Some(matrix) = either("k", "K") else { return Ok(None) };
    let k = numbers(matrix, "K")?;
    let Ok(k) = <[f64; 9]>::try_from(k.as_slice()) else {
        return matrix.refuse(format!("found {} numbers of the camera's matrix `K`, expected 9", k.len()));
    };
    if k == [0.0; 9] {
        return Ok(None);
    }
    let d = either("d", "D").map_or(Ok(Vec::new()), |it| numbers(it, "D"))?;
    let size_px = [stated(&["width"])?, stated(&["height"])?];
    let model = node.get("distortion_model").and_then(YamlNode::text).unwrap_or_default().to_owned();
    let mut part = [0.0; REGION_KEYS.len()];
    for (value, keys) in part.iter_mut().zip(REGION_KEYS) {
        *value = stated(&keys.split('.').collect::<Vec<_>>())?;
    }
    let region = Region::new(part).or_else(|found| node.refuse(found))?;
    Ok(Some(CameraInfo { size_px, k, d, model, region }))
}

fn require_key<'a>(node: &'a YamlNode, key: &str) -> Result<&'a YamlNode> {
    if let Some(found) = node.get(key) {
        return Ok(found);
    }
    let has = match &node.kind {
        NodeKind::Map(entries) => {
            let keys: Vec<&str> = entries.iter().map(|(key, _)| key.as_str()).collect();
            format!("{} without `{key}`", first_few(&keys))
        }
        NodeKind::Text(text) if text == CUT => return refuse_cut(node),
        NodeKind::Text(text) => format!("`{text}`"),
        NodeKind::List(_) => "a list".to_owned(),
    };
    node.refuse(format!("found {has}, expected {EXPECTED}"))
}

fn list<'a>(node: &'a YamlNode, what: &str) -> Result<&'a [YamlNode]> {
    node.list().map_or_else(|| node.refuse(format!("found no list of {what}, expected {EXPECTED}")), Ok)
}

/// Mark in place of the rest of a list that was printed in part.
const CUT: &str = "...";

fn refuse_cut<T>(node: &YamlNode) -> Result<T> {
    node.refuse(
        "found `...` in place of the rest of a list, expected all of it: record with `ros2 topic echo --full-length`",
    )
}

fn number(node: &YamlNode, name: &str) -> Result<f64> {
    let text = node.text().unwrap_or("a list");
    if text == CUT {
        return refuse_cut(node);
    }
    match text.parse::<f64>() {
        Ok(number) if number.abs() <= LARGEST_NUMBER => Ok(number),
        _ => {
            node.refuse(format!("found `{text}` for `{name}`, expected a finite number of at most {LARGEST_NUMBER:e}"))
        }
    }
}
