//! The frames on the robot and beside it that the page draws: tip, targets and instruments.

use std::borrow::Cow;

use serde::Serialize;

use super::devices::{device_of, devices};
use super::short_name;
use poecal_arm::lie::Pose;
use poecal_model::measurement::Device;
use poecal_model::robot::{Body, Mount, Robot};
use poecal_numerics::error::Result;
use poecal_numerics::text::escape_invisible;
use poecal_results::calibration_file::{BoardEntry, CalibrationFile, CameraEntry, PoseEntry, StationEntry};
use poecal_results::residuals::Residuals;

/// A frame on a body.
#[derive(Serialize)]
pub(crate) struct FrameData<'a> {
    /// Its displayed name.
    name: Cow<'a, str>,
    /// The joint that moves its body; `None` for the base.
    pub(crate) on: Option<usize>,
    /// Its pose in the base at zero joint values.
    pub(crate) pose: PoseEntry,
    /// Its pose in the nominal model; `None` for a target in the tip frame.
    nominal_pose: Option<PoseEntry>,
    /// Kind of an instrument, if it has no frame of its own: anchor, socket, plane, sphere, direction, pair.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) kind: Option<&'static str>,
    /// Radius of a sphere, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    radius_m: Option<f64>,
    /// For a camera the directions to the corners of its image, in its frame, in order around it, with z = 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    camera: Option<[[f64; 3]; 4]>,
    /// For a board its points in its frame, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    board: Option<Vec<[f64; 3]>>,
}

impl<'a> FrameData<'a> {
    fn new(name: &'a str, body: Body, pose: &Pose, nominal: Option<&Pose>) -> Self {
        FrameData {
            name: escape_invisible(name),
            on: body.joint(),
            pose: pose.into(),
            nominal_pose: nominal.map(PoseEntry::from),
            kind: None,
            radius_m: None,
            camera: None,
            board: None,
        }
    }

    /// The frame with its role in pictures, by its name in the file.
    fn seen_as(self, file: &CalibrationFile, name: &str) -> Self {
        let Some(pictures) = &file.pictures else { return self };
        let camera = pictures.cameras.iter().find(|it| it.name == name).map(corners_of);
        let points =
            |board: &BoardEntry| board.points.iter().map(|it| it.place_mm.map(|mm| (1e3 * mm).round() / 1e6)).collect();
        let board = pictures.boards.iter().find(|it| it.name == name).map(points);
        FrameData { camera, board, ..self }
    }

    /// The frame with the kind of a station.
    fn of_station(self, station: Option<&StationEntry>) -> Self {
        let place = station.map(device_of).filter(|it| *it != Device::Instrument);
        FrameData {
            kind: place.map(Device::word),
            radius_m: station.and_then(|it| it.radius_mm).map(|radius| 1e-3 * radius),
            ..self
        }
    }
}

/// Directions to the corners of a camera's image, without its distortion.
fn corners_of(camera: &CameraEntry) -> [[f64; 3]; 4] {
    let [cx, cy] = camera.centre_px;
    let [width, height] = camera.size_px.map_or([2.0 * cx, 2.0 * cy], |size| size.map(f64::from));
    let [fx, fy] = camera.focal_px;
    let round = |value: f64| (1e4 * value).round() / 1e4;
    [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]]
        .map(|[u, v]| [round((u - cx) / fx), round((v - cy) / fy), 1.0])
}

/// All frames of a calibration.
pub(crate) struct PageFrames<'a> {
    pub(crate) tip: FrameData<'a>,
    /// Targets of the rows in the order of the residuals, then those that no row names.
    pub(crate) targets: Vec<FrameData<'a>>,
    /// Instruments in the same order.
    pub(crate) instruments: Vec<FrameData<'a>>,
}

impl<'a> PageFrames<'a> {
    pub(crate) fn from_calibration(file: &'a CalibrationFile, robot: &Robot, residuals: &'a Residuals) -> Result<Self> {
        let nominal = file.nominal_robot()?;
        let places = robot.places_of_targets();
        let target = |name: &'a String| {
            let (body, pose) = places(Some(name));
            let nominal = mount(&nominal, &nominal.mounted, name).map(|it| it.1);
            FrameData::new(name, body, &pose, nominal.as_ref()).seen_as(file, name)
        };
        let unseen = file.targets.iter().filter(|(name, it)| it.on.is_some() && !residuals.targets.contains(name));
        let targets = residuals.targets.iter().chain(unseen.map(|(name, _)| name)).map(target).collect();

        let first = file.stations.first().and_then(|it| it.instrument.as_deref()).unwrap_or_default();
        let seeing: Vec<&str> = match residuals.stations.as_slice() {
            [] => vec![first],
            names => names.iter().map(String::as_str).collect(),
        };
        let unused = file.instruments.keys().map(String::as_str).filter(|name| !seeing.contains(name));
        let instrument = |name: &'a str| {
            let shown = short_name(&residuals.files, name);
            let own = |it: &&StationEntry| it.instrument.as_deref().unwrap_or_default() == name;
            let station = file.stations.iter().find(own);
            if let Some((body, pose)) = mount(robot, &robot.instruments, name) {
                let nominal = mount(&nominal, &nominal.instruments, name).map_or(pose, |it| it.1);
                let frame = FrameData::new(shown, body, &pose, Some(&nominal));
                return Ok(frame.of_station(station).seen_as(file, name));
            }
            let pose = station.map_or(&file.measurement_frame.base_from_device, |it| &it.base_from_device).pose()?;
            let frame = FrameData::new(shown, Body::Base, &pose, Some(&pose));
            Ok(frame.of_station(station).seen_as(file, name))
        };
        let instruments = seeing.iter().copied().chain(unused).map(instrument).collect::<Result<_>>()?;
        let tip = FrameData::new("tip", robot.tip_body(), &robot.home, Some(&nominal.home));
        Ok(PageFrames { tip, targets, instruments })
    }
}

/// A target or an instrument of a robot by its name: its body, and its pose in the base at zero joint values.
fn mount(robot: &Robot, mounts: &[Mount], name: &str) -> Option<(Body, Pose)> {
    let found = mounts.iter().find(|mount| mount.name == name)?;
    Some((found.body, robot.base_from(found)))
}

/// True if instruments are drawn: cameras and boards, but no pairs. A single other one beside a robot without branches is not drawn: its pose has
/// little meaning.
pub(crate) fn draws_instruments(file: &CalibrationFile) -> bool {
    let has_branches = file.joints.iter().any(|joint| joint.on.is_some()) || file.robot.tip_on.is_some();
    let has_mounts = !file.instruments.is_empty() || file.targets.values().any(|target| target.on.is_some());
    let places = devices(file);
    let has_places = places.iter().any(|it| ![Device::Instrument, Device::Pair].contains(it));
    let drawn = file.stations.iter().filter(|it| device_of(it) != Device::Pair).count();
    file.pictures.is_some() || has_branches || has_mounts || has_places || drawn > 1
}
