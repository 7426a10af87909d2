//! The frames on the robot and beside it that the page draws: tip, targets and instruments.

use std::borrow::Cow;

use serde::Serialize;

use super::devices::{device_of, devices};
use super::short;
use crate::error::Result;
use crate::io::calibration_file::{CalibrationFile, PoseEntry, StationEntry};
use crate::io::residuals::Residuals;
use crate::lie::Pose;
use crate::measurement::Device;
use crate::robot::{Body, Mount, Robot};
use crate::text::visible;

/// A frame on a body.
#[derive(Serialize)]
pub(super) struct FrameData<'a> {
    /// Its name as it is shown.
    name: Cow<'a, str>,
    /// The joint that moves its body; none for the base.
    on: Option<usize>,
    /// Its pose in the base at zero joint values.
    pose: PoseEntry,
    /// The same in the nominal model; none of a target in the tip frame.
    nominal_pose: Option<PoseEntry>,
    /// What an instrument is, if it has no frame of its own: anchor, socket, plane, sphere, direction, pair.
    #[serde(skip_serializing_if = "Option::is_none")]
    kind: Option<&'static str>,
    /// Radius of a sphere, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    radius_m: Option<f64>,
}

impl<'a> FrameData<'a> {
    fn new(name: &'a str, body: Body, pose: &Pose, nominal: Option<&Pose>) -> Self {
        FrameData {
            name: visible(name),
            on: body.joint(),
            pose: pose.into(),
            nominal_pose: nominal.map(PoseEntry::from),
            kind: None,
            radius_m: None,
        }
    }

    /// The same as what a station is.
    fn of_station(self, station: Option<&StationEntry>) -> Self {
        let place = station.map(device_of).filter(|it| *it != Device::Instrument);
        FrameData {
            kind: place.map(Device::word),
            radius_m: station.and_then(|it| it.radius_mm).map(|radius| 1e-3 * radius),
            ..self
        }
    }
}

/// All frames of a calibration.
pub(super) struct Frames<'a> {
    pub(super) tip: FrameData<'a>,
    /// Those of the rows in the order of the residuals, then those that no row names.
    pub(super) targets: Vec<FrameData<'a>>,
    /// Likewise.
    pub(super) instruments: Vec<FrameData<'a>>,
}

impl<'a> Frames<'a> {
    pub(super) fn of(file: &'a CalibrationFile, robot: &Robot, residuals: &'a Residuals) -> Result<Self> {
        let nominal = file.nominal_robot()?;
        let places = robot.places_of_targets();
        let target = |name: &'a String| {
            let (body, pose) = places(Some(name));
            FrameData::new(name, body, &pose, mount(&nominal, &nominal.mounted, name).map(|it| it.1).as_ref())
        };
        let unseen =
            file.targets.iter().filter(|(name, it)| it.on.is_some() && !residuals.targets.contains(name));
        let targets = residuals.targets.iter().chain(unseen.map(|(name, _)| name)).map(target).collect();

        let first = file.stations.first().and_then(|it| it.instrument.as_deref()).unwrap_or_default();
        let seeing: Vec<&str> = match residuals.stations.as_slice() {
            [] => vec![first],
            names => names.iter().map(String::as_str).collect(),
        };
        let unused = file.instruments.keys().map(String::as_str).filter(|name| !seeing.contains(name));
        let instrument = |name: &'a str| {
            let shown = short(&residuals.files, name);
            let own = |it: &&StationEntry| it.instrument.as_deref().unwrap_or_default() == name;
            let station = file.stations.iter().find(own);
            if let Some((body, pose)) = mount(robot, &robot.instruments, name) {
                let nominal = mount(&nominal, &nominal.instruments, name).map_or(pose, |it| it.1);
                return Ok(FrameData::new(shown, body, &pose, Some(&nominal)).of_station(station));
            }
            let pose =
                station.map_or(&file.measurement_frame.base_from_device, |it| &it.base_from_device).pose()?;
            Ok(FrameData::new(shown, Body::Base, &pose, Some(&pose)).of_station(station))
        };
        let instruments = seeing.iter().copied().chain(unused).map(instrument).collect::<Result<_>>()?;
        let tip = FrameData::new("tip", robot.tip_body(), &robot.home, Some(&nominal.home));
        Ok(Frames { tip, targets, instruments })
    }
}

/// A target or an instrument of a robot by its name: its body, and its pose in the base at zero joint values.
fn mount(robot: &Robot, mounts: &[Mount], name: &str) -> Option<(Body, Pose)> {
    let found = mounts.iter().find(|mount| mount.name == name)?;
    Some((found.body, robot.base_from(found)))
}

/// Whether instruments are drawn: not a single one with a frame beside a robot without branches, whose place says little, and no pairs.
pub(super) fn draws_instruments(file: &CalibrationFile) -> bool {
    let has_branches = file.joints.iter().any(|joint| joint.on.is_some()) || file.robot.tip_on.is_some();
    let has_mounts = !file.instruments.is_empty() || file.targets.values().any(|target| target.on.is_some());
    let places = devices(file);
    let has_places = places.iter().any(|it| ![Device::Instrument, Device::Pair].contains(it));
    let drawn = file.stations.iter().filter(|it| device_of(it) != Device::Pair).count();
    has_branches || has_mounts || has_places || drawn > 1
}
