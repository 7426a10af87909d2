//! Messages of robot_calibration (`CalibrationData`), as printed by `ros2 topic echo` or as JSON. Each is a picture of each camera in it, with the
//! readings of the joints by name. They become rows of corners, which are read as those of a table.

mod bodies;
mod parsed_message;
mod recognition;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use self::bodies::{MessageBodies, SortedMessage};
use self::parsed_message::{CameraInfo, NO_PATH, ParsedMessage, PartRefusal as _, SensorObservation};
pub(crate) use self::recognition::are_messages;
use super::instruments::{CellValue, MadeTable, TableColumn};
use super::read::MeasurementReader;
use super::table::FileTable;
use crate::pictures::lens_checks::{check, distortion};
use crate::pictures::picture_files::NO_CAMERA;
use crate::table::mapping::ColumnMap;
use crate::table::text::LineBlocks;
use poecal_model::camera::{Board, Camera, Lens, size_of_pictures};
use poecal_model::robot::ReadingKind;
use poecal_numerics::error::{Error, ErrorKind, Result, first_few};

/// The joints of the readings, by their names in the messages, each with whether it is a length.
type MessageJoints = Vec<(String, bool)>;

impl MeasurementReader<'_> {
    /// Reads a file of messages.
    pub(crate) fn messages(&mut self, path: &Path, mut blocks: LineBlocks<'_>) -> Result<()> {
        let text = blocks.rest()?;
        let made = self.corners_of_messages(&text).map_err(|error| error.with_path(path).in_file(path))?;
        let mut rows = made.blocks(path, "messages");
        let warned = rows.take_remarks().warnings;
        // A column of the header is not one of the file.
        let column = |error: &Error| error.place().and_then(|place| place.column);
        FileTable::open(path, rows, &ColumnMap::default())
            .and_then(|table| self.corners(path, table))
            .map_err(|error| if column(&error).is_some() { error.without_line() } else { error })?;
        self.found.sha256.extend(blocks.sha256().map(|sha256| (path.display().to_string(), sha256)));
        self.found.warnings.extend(warned);
        Ok(())
    }

    /// The rows of corners of the messages; errors name no file.
    fn corners_of_messages(&mut self, text: &str) -> Result<MadeTable> {
        let nodes = parsed_message::nodes(text)?;
        let messages: Vec<ParsedMessage<'_>> = nodes.iter().map(parsed_message::message).collect::<Result<_>>()?;
        let Some(first) = messages.first() else {
            return ErrorKind::Measurement.refuse(format!("found no message, expected {}", parsed_message::EXPECTED));
        };
        let joints = self.joints_of(first)?;
        let mut bodies = MessageBodies::default();
        let pictures: Vec<SortedMessage<'_>> = messages.iter().map(|it| bodies.take(it)).collect::<Result<_>>()?;
        bodies.refuse_moving()?;
        let camera = self.take_cameras(&messages)?;
        if self.cameras.is_empty() {
            return ErrorKind::Measurement.refuse(NO_CAMERA);
        }
        let board = self.take_boards(&bodies)?;
        let sensors: BTreeSet<&str> = pictures.iter().flat_map(|it| &it.pixels).map(|it| it.sensor).collect();
        let is_one_camera = self.options.cameras.len() == 1 && sensors.len() == 1;
        let pixel = |axis: &str| TableColumn::from(axis).in_unit("px");
        let reading = |it: &(String, bool)| TableColumn::from(&*it.0).in_unit(if it.1 { "m" } else { "rad" });
        let columns = ["image", "camera", "board", "target"].into_iter().map(TableColumn::from);
        let columns = columns.chain(["u", "v"].map(pixel)).chain(joints.iter().map(reading));
        let mut made = MadeTable::new(1, columns).of_file("messages", None);
        let mut without = Vec::new();
        for (number, picture) in (1..).zip(&pictures) {
            let image = format!("message {number}");
            for observation in &picture.pixels {
                let (board, names) = self.names(picture, observation, &bodies)?;
                let camera = if is_one_camera { "" } else { observation.sensor };
                let readings = readings(picture.message, &joints)?;
                for (feature, name) in observation.features.iter().zip(&names) {
                    let words = [&image, camera, &board, name].map(CellValue::Text);
                    let numbers = feature.at.iter().take(2).chain(&readings).copied();
                    made.row(feature.node.line, words.into_iter().chain(numbers.map(CellValue::Number)));
                }
            }
            if picture.pixels.is_empty() {
                without.push(image);
            }
        }
        if without.len() == messages.len() {
            return ErrorKind::Measurement.refuse(
                "found no feature in pixels (x and y, with z = 0) in any message, expected corners that a camera saw",
            );
        }
        let others = first.joints.iter().map(|it| it.0);
        let others: Vec<&str> = others.filter(|name| !joints.iter().any(|own| own.0 == *name)).collect();
        made.warned.extend(camera.into_iter().chain(board));
        if !others.is_empty() {
            made.warn(format!("ignored the joints {}", first_few(&others)));
        }
        if !without.is_empty() {
            let names = first_few(&without);
            made.warn(format!("left out {} messages without pixels: {names}", without.len()));
        }
        Ok(made)
    }

    /// The joints that the readings need; the first message must have all of them.
    fn joints_of(&self, first: &ParsedMessage<'_>) -> Result<MessageJoints> {
        let mut joints: MessageJoints = Vec::new();
        for name in self.found.data.reading_names() {
            let is_length = self.robot.reading_kind(name) == ReadingKind::Length;
            let kept = self.options.controller.iter().flat_map(|it| &it.readings);
            let kept = kept.filter(|it| it.reading == *name).flat_map(|it| it.columns.keys());
            let columns: Vec<&String> = match self.map.joints.get(name) {
                Some(spec) if spec.value.is_some() => Vec::new(),
                Some(spec) => spec.columns.iter().flat_map(BTreeMap::keys).chain(&spec.column).collect(),
                None => kept.collect(),
            };
            let is_own = columns.is_empty() && !self.map.joints.contains_key(name);
            for column in if is_own { vec![name] } else { columns } {
                if !joints.iter().any(|(known, _)| known == column) {
                    joints.push((column.clone(), is_length));
                }
            }
        }
        // Reports the error of a joint that is missing.
        readings(first, &joints)?;
        Ok(joints)
    }

    /// Takes the cameras of the messages, unless the user stated cameras. Returns a sentence on them.
    fn take_cameras(&mut self, messages: &[ParsedMessage<'_>]) -> Result<Option<String>> {
        let mut infos: BTreeMap<&str, &CameraInfo> = BTreeMap::new();
        for observation in messages.iter().flat_map(|it| &it.observations) {
            let Some(info) = &observation.camera else { continue };
            if *infos.entry(observation.sensor).or_insert(info) != info {
                return observation.node.refuse(format!(
                    "found another `camera_info` of `{}` than in the first message, expected one lens in all",
                    observation.sensor
                ));
            }
        }
        if infos.is_empty() {
            return Ok(None);
        }
        if !self.options.cameras.is_empty() {
            return Ok(Some("took the stated lens, and not that of ext_camera_info".to_owned()));
        }
        let (mut names, mut regions) = (Vec::new(), String::new());
        for (name, info) in infos {
            let (lens, region) = lens(info)?;
            let camera = Camera::new(name.to_owned(), lens);
            check(name, &camera.lens)?;
            let [width, height] = camera.lens.size_px.unwrap_or_default();
            names.push(format!("{name} ({width} x {height} px)"));
            regions.extend(region.map(|words| format!("; {name}: {words}")));
            match self.cameras.iter().find(|own| own.name == name) {
                Some(own) if *own != camera => {
                    return ErrorKind::Measurement.refuse(format!(
                        "found another lens of the camera `{name}` than in the file before, expected one"
                    ));
                }
                Some(_) => {}
                None => self.cameras.push(camera),
            }
        }
        Ok(Some(format!("took ext_camera_info for the lens of {}{regions}", first_few(&names))))
    }

    /// Takes the boards of the messages, unless the user stated boards. Returns a sentence on them.
    fn take_boards(&mut self, bodies: &MessageBodies) -> Result<Option<String>> {
        if bodies.0.is_empty() {
            return Ok(None);
        }
        if !self.options.boards.is_empty() {
            let sensors: Vec<&str> = bodies.0.iter().map(|body| body.sensor.as_str()).collect();
            return Ok(Some(format!(
                "took the stated board, by the order of its points, and not those of {}",
                first_few(&sensors)
            )));
        }
        let mut names = Vec::new();
        for body in &bodies.0 {
            let Board { name, points, .. } = &body.board;
            let is_mounted = self.robot.mounted.iter().any(|mount| mount.name == *name);
            let link = match is_mounted {
                true => String::new(),
                false => format!(": --target {name}=LINK states its link in a URDF"),
            };
            names.push(format!("`{name}` ({} points of the sensor {}){link}", points.len(), body.sensor));
            match self.boards.iter().find(|own| own.name == *name) {
                Some(own) if own.points != *points => {
                    return ErrorKind::Measurement
                        .refuse(format!("found other points of the board `{name}` than before, expected the same"));
                }
                Some(_) => {}
                None => self.boards.push(body.board.clone()),
            }
        }
        Ok(Some(format!("took the board {}", names.join(", "))))
    }

    /// The board of an observation of pixels, empty if there is only one, and the names of its features.
    fn names(
        &self,
        picture: &SortedMessage<'_>,
        observation: &SensorObservation<'_>,
        bodies: &MessageBodies,
    ) -> Result<(String, Vec<String>)> {
        let stated = &self.options.boards;
        if let [board] = stated.as_slice() {
            let (count, all) = (observation.features.len(), board.names.len());
            if count != all {
                return observation.node.refuse(format!(
                    "found {count} features of `{}`, expected the {all} points of the board: features go by order",
                    observation.sensor
                ));
            }
            return Ok((String::new(), board.names.clone()));
        }
        let (body, points) = picture.partner(observation)?;
        let Some(body) = bodies.0.get(*body) else { return Ok(Default::default()) };
        let name = body.board.name.clone();
        let names = match stated.iter().find(|board| board.name == name) {
            Some(board) => &board.names,
            None if stated.is_empty() => &body.board.names,
            None => {
                let names: Vec<&str> = stated.iter().map(|board| board.name.as_str()).collect();
                let names = first_few(&names);
                return observation.node.refuse(format!("found the board `{name}`, expected one of {names}"));
            }
        };
        Ok((name, points.iter().filter_map(|at| names.get(*at).cloned()).collect()))
    }
}

/// The readings of a message in the order of the joints.
fn readings(message: &ParsedMessage<'_>, joints: &MessageJoints) -> Result<Vec<f64>> {
    let mut readings = Vec::with_capacity(joints.len());
    for (name, _) in joints {
        let Some((_, value)) = message.joints.iter().find(|(own, _)| own == name) else {
            let names: Vec<&str> = message.joints.iter().map(|it| it.0).collect();
            let names = first_few(&names);
            return message
                .node
                .refuse(format!("found no joint `{name}` in `joint_states` ({names}), expected it in each message"));
        };
        readings.push(*value);
    }
    Ok(readings)
}

/// The lens of the pictures, and the effect of its region in words.
fn lens(info: &CameraInfo) -> Result<(Lens, Option<String>)> {
    let CameraInfo { size_px, k, d, model, region } = info;
    let [fx, skew, cx, _, fy, cy, ..] = *k;
    if skew != 0.0 {
        return ErrorKind::Measurement.refuse(format!("found a skew of {skew} in `K`, expected 0"));
    }
    // Messages of a camera that is not calibrated have zeros.
    let is_stated = size_px.iter().any(|it| *it != 0.0);
    let size_px = size_of_pictures(size_px.map(|side| is_stated.then_some(side)))?;
    let distortion = distortion(model, d, Path::new(NO_PATH))?;
    let whole = Lens { focal_px: [fx, fy], centre_px: [cx, cy], distortion, size_px };
    region.apply_region(&whole).map_err(|found| ErrorKind::Measurement.error(found))
}
