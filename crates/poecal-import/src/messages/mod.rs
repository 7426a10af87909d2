//! Messages of robot_calibration (`CalibrationData`), as `ros2 topic echo` prints them or as JSON: each is a picture of each camera in it, with the
//! readings of the joints by name. They become rows of corners, which are read as those of a table.

mod bodies;
mod parsed;
mod refused;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use self::bodies::{Bodies, Seen, partner, seen};
use self::parsed::{CameraInfo, Message, Observation};
pub(crate) use self::refused::are_messages;
use super::read::Reader;
use super::table::Table;
use crate::pictures::lens_checks::{check, distortion, size_of_pictures};
use crate::pictures::picture_files::NO_CAMERA;
use crate::table::mapping::ColumnMap;
use crate::table::text::Blocks;
use poecal_model::camera::{Board, Camera, Lens};
use poecal_model::robot::ReadingKind;
use poecal_numerics::error::{Error, ErrorKind, Result, first_few};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;

/// The rows of corners that messages say.
#[derive(Default)]
struct Rows {
    text: String,
    /// The line of the file of each line of the text.
    lines: Vec<usize>,
    /// Messages without pixels.
    without: Vec<String>,
}

/// Columns of joints with their units, as the messages name them.
type Joints = Vec<(String, NamedUnit)>;

impl Reader<'_> {
    /// Reads a file of messages.
    pub(crate) fn messages(&mut self, path: &Path, mut blocks: Blocks<'_>) -> Result<()> {
        let text = blocks.rest()?;
        let nodes = parsed::nodes(&text, path)?;
        let messages: Vec<Message<'_>> =
            nodes.iter().map(|node| parsed::message(node, path)).collect::<Result<_>>()?;
        let joints = self.joints_of(&messages, path)?;
        let mut bodies = Bodies::default();
        let mut points = Vec::with_capacity(messages.len());
        for message in &messages {
            let mut own = Vec::new();
            for observation in &message.observations {
                if seen(observation, path)? == Seen::Points {
                    own.push(bodies.take(observation));
                }
            }
            points.push(own);
        }
        bodies.refuse_moving(path)?;
        let said = self.take_cameras(&messages, path)?;
        if self.cameras.is_empty() {
            return Err(Error::new(ErrorKind::Measurement, NO_CAMERA).in_file(path));
        }
        let board = self.take_boards(&bodies, path)?;
        let is_one_camera = self.options.cameras.len() == 1 && sensors(&messages, path)?.len() == 1;
        let mut rows = Rows::of(&joints);
        for (at, (message, own)) in messages.iter().zip(&points).enumerate() {
            let name = format!("message {}", at + 1);
            let mut has_pixels = false;
            for observation in &message.observations {
                if seen(observation, path)? == Seen::Pixels {
                    has_pixels = true;
                    let names = self.names((message, observation), &bodies, own, path)?;
                    let camera = if is_one_camera { "" } else { observation.sensor };
                    rows.add(&name, camera, (observation, names), &readings(message, &joints, path)?);
                }
            }
            if !has_pixels {
                rows.without.push(name);
            }
        }
        if rows.without.len() == messages.len() {
            let message = "found no feature in pixels (x and y, with z = 0) in any message, expected corners that a camera saw";
            return Err(Error::new(ErrorKind::Measurement, message).in_file(path));
        }
        let map = ColumnMap::default();
        let table = Table::open(path, Blocks::new(path, rows.text.as_bytes()), &map)?;
        // A column of the header is none of the file.
        let column = |error: &Error| error.place().and_then(|place| place.column);
        self.corners(path, table.with_lines(rows.lines))
            .map_err(|error| if column(&error).is_some() { error.without_line() } else { error })?;
        self.found.sha256.extend(blocks.sha256().map(|sha256| (path.display().to_string(), sha256)));
        let others = unused(&messages, &joints);
        let say = |words: String| self.found.warnings.push(format!("{}: {words}", path.display()));
        let left_out = (!rows.without.is_empty()).then(|| {
            format!("left out {} messages without pixels: {}", rows.without.len(), first_few(&rows.without))
        });
        said.into_iter().chain(board).chain(others).chain(left_out).for_each(say);
        Ok(())
    }

    /// The joints that the readings need, all of which the first message must have.
    fn joints_of(&self, messages: &[Message<'_>], path: &Path) -> Result<Joints> {
        let Some(first) = messages.first() else {
            let message = format!("found no message, expected {}", parsed::EXPECTED);
            return Err(Error::new(ErrorKind::Measurement, message).in_file(path));
        };
        let mut joints: Joints = Vec::new();
        for name in self.found.data.reading_names() {
            let unit = match self.robot.reading_kind(name) {
                ReadingKind::Length => Unit::Metre,
                ReadingKind::Angle | ReadingKind::Factor => Unit::Radian,
            };
            let kept = self.options.controller.iter().flat_map(|it| &it.readings);
            let kept = kept.filter(|it| it.reading == *name).flat_map(|it| it.columns.keys());
            let columns: Vec<&String> = match self.map.joints.get(name) {
                Some(spec) if spec.value.is_some() => Vec::new(),
                Some(spec) => spec.columns.iter().flat_map(BTreeMap::keys).chain(&spec.column).collect(),
                None => kept.collect(),
            };
            let own =
                if columns.is_empty() && !self.map.joints.contains_key(name) { vec![name] } else { columns };
            for column in own {
                if !joints.iter().any(|(known, _)| known == column) {
                    joints.push((column.clone(), NamedUnit::from(unit)));
                }
            }
        }
        // With the error of one that is missing.
        readings(first, &joints, path)?;
        Ok(joints)
    }

    /// The cameras that the messages state, unless there are stated ones. Says which.
    fn take_cameras(&mut self, messages: &[Message<'_>], path: &Path) -> Result<Option<String>> {
        let mut infos: BTreeMap<&str, &CameraInfo> = BTreeMap::new();
        for observation in messages.iter().flat_map(|it| &it.observations) {
            let Some(info) = &observation.camera else { continue };
            let first = *infos.entry(observation.sensor).or_insert(info);
            if first != info {
                let message = format!(
                    "found another `camera_info` of `{}` than in the first message, expected one lens in all",
                    observation.sensor
                );
                return Err(observation.node.error(path, message));
            }
        }
        if infos.is_empty() {
            return Ok(None);
        }
        if !self.options.cameras.is_empty() {
            return Ok(Some("took the stated lens, and not that of ext_camera_info".to_owned()));
        }
        let (mut names, mut regions) = (Vec::new(), Vec::new());
        for (name, info) in infos {
            let (lens, region) = lens(info, path)?;
            let camera = Camera::new(name.to_owned(), lens);
            check(name, &camera.lens).map_err(|error| error.in_file(path))?;
            let [width, height] = camera.lens.size_px.unwrap_or_default();
            names.push(format!("{name} ({width} x {height} px)"));
            regions.extend(region.map(|words| format!("{name}: {words}")));
            match self.cameras.iter().find(|own| own.name == name) {
                Some(own) if *own != camera => {
                    let message = format!(
                        "found another lens of the camera `{name}` than in the file before, expected one"
                    );
                    return Err(Error::new(ErrorKind::Measurement, message).in_file(path));
                }
                Some(_) => {}
                None => self.cameras.push(camera),
            }
        }
        let regions: String = regions.iter().map(|it| format!("; {it}")).collect();
        Ok(Some(format!("took ext_camera_info for the lens of {}{regions}", first_few(&names))))
    }

    /// The boards that the messages state, unless there are stated ones. Says which.
    fn take_boards(&mut self, bodies: &Bodies, path: &Path) -> Result<Option<String>> {
        if bodies.0.is_empty() {
            return Ok(None);
        }
        if !self.options.boards.is_empty() {
            let sensors: Vec<&str> = bodies.0.iter().map(|body| body.sensor.as_str()).collect();
            let sensors = first_few(&sensors);
            return Ok(Some(format!(
                "took the stated board, by the order of its points, and not those of {sensors}"
            )));
        }
        let mut names = Vec::new();
        for body in &bodies.0 {
            let Board { name, points, .. } = &body.board;
            let link = if self.robot.mounted.iter().any(|mount| mount.name == *name) {
                String::new()
            } else {
                format!(": --target {name}=LINK says on which link of a URDF it is")
            };
            names.push(format!("`{name}` ({} points of the sensor {}){link}", points.len(), body.sensor));
            match self.boards.iter().find(|own| own.name == *name) {
                Some(own) if own.points != *points => {
                    let message =
                        format!("found other points of the board `{name}` than before, expected the same");
                    return Err(Error::new(ErrorKind::Measurement, message).in_file(path));
                }
                Some(_) => {}
                None => self.boards.push(body.board.clone()),
            }
        }
        Ok(Some(format!("took the board {}", names.join(", "))))
    }

    /// The board of an observation of pixels, empty if there is one, and the names of its features.
    fn names(
        &self,
        (message, observation): (&Message<'_>, &Observation<'_>),
        bodies: &Bodies,
        points: &[(usize, Vec<usize>)],
        path: &Path,
    ) -> Result<(String, Vec<String>)> {
        let stated = &self.options.boards;
        if stated.len() == 1
            && let Some(board) = stated.first()
        {
            let (count, all) = (observation.features.len(), board.names.len());
            if count != all {
                let message = format!(
                    "found {count} features of `{}`, expected the {all} points of the board: features go by order",
                    observation.sensor
                );
                return Err(observation.node.error(path, message));
            }
            return Ok((String::new(), board.names.clone()));
        }
        let (body, points) = partner(message, observation, points, path)?;
        let Some(body) = bodies.0.get(*body) else { return Ok(Default::default()) };
        let name = body.board.name.clone();
        let names = match stated.iter().find(|board| board.name == name) {
            Some(board) => &board.names,
            None if stated.is_empty() => &body.board.names,
            None => {
                let names: Vec<&str> = stated.iter().map(|board| board.name.as_str()).collect();
                let message = format!("found the board `{name}`, expected one of {}", first_few(&names));
                return Err(observation.node.error(path, message));
            }
        };
        let names = points.iter().filter_map(|at| names.get(*at).cloned()).collect();
        Ok((name, names))
    }
}

/// Sensors that see pixels.
fn sensors<'a>(messages: &'a [Message<'_>], path: &Path) -> Result<Vec<&'a str>> {
    let mut found = Vec::new();
    for observation in messages.iter().flat_map(|it| &it.observations) {
        if seen(observation, path)? == Seen::Pixels && !found.contains(&observation.sensor) {
            found.push(observation.sensor);
        }
    }
    Ok(found)
}

/// Joints of the first message that the robot does not have.
fn unused(messages: &[Message<'_>], joints: &Joints) -> Option<String> {
    let has = |name: &str| joints.iter().any(|(own, _)| own == name);
    let others = messages.first()?.joints.iter().map(|(name, _)| *name).filter(|name| !has(name));
    let others: Vec<&str> = others.collect();
    (!others.is_empty()).then(|| format!("ignored the joints {}", first_few(&others)))
}

/// The readings of a message in the order of the joints.
fn readings(message: &Message<'_>, joints: &Joints, path: &Path) -> Result<Vec<f64>> {
    let reading = |(name, _): &(String, NamedUnit)| {
        let found = message.joints.iter().find(|(own, _)| own == name);
        found.map(|(_, value)| *value).ok_or_else(|| {
            let names: Vec<&str> = message.joints.iter().map(|(name, _)| *name).collect();
            let text = format!(
                "found no joint `{name}` in `joint_states` ({}), expected it in each message",
                first_few(&names)
            );
            message.node.error(path, text)
        })
    };
    joints.iter().map(reading).collect()
}

/// The lens of the pictures, and what its region changed in words.
fn lens(info: &CameraInfo, path: &Path) -> Result<(Lens, Option<String>)> {
    let CameraInfo { size_px, k, d, model, region } = info;
    let [fx, skew, cx, _, fy, cy, ..] = *k;
    if skew != 0.0 {
        let message = format!("found a skew of {skew} in `K`, expected 0");
        return Err(Error::new(ErrorKind::Measurement, message).in_file(path));
    }
    // Messages of a camera that is not calibrated have zeros.
    let is_stated = size_px.iter().any(|it| *it != 0.0);
    let size_px = size_of_pictures(size_px.map(|side| is_stated.then_some(side)));
    let size_px = size_px.map_err(|error| error.in_file(path))?;
    let distortion = distortion(model, d, path)?;
    let whole = Lens { focal_px: [fx, fy], centre_px: [cx, cy], distortion, size_px };
    region.applied(&whole).map_err(|found| Error::new(ErrorKind::Measurement, found).in_file(path))
}

impl Rows {
    fn of(joints: &Joints) -> Self {
        let mut text = "image,camera,board,target,u[px],v[px]".to_owned();
        for (name, unit) in joints {
            // Writing to a String cannot fail.
            let _ = write!(text, ",{}", quoted(&format!("{name}[{}]", unit.symbol())));
        }
        text.push('\n');
        Rows { text, lines: vec![1], without: Vec::new() }
    }

    /// Adds the corners of an observation.
    fn add(
        &mut self,
        image: &str,
        camera: &str,
        (observation, (board, names)): (&Observation<'_>, (String, Vec<String>)),
        readings: &[f64],
    ) {
        for (feature, name) in observation.features.iter().zip(&names) {
            let [u, v, _] = feature.at;
            let cells = [image, camera, &board, name].map(quoted).join(",");
            let _ = write!(self.text, "{cells},{u:?},{v:?}");
            for reading in readings {
                let _ = write!(self.text, ",{reading:?}");
            }
            self.text.push('\n');
            self.lines.push(feature.node.line);
        }
    }
}

/// A cell of a table.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}
