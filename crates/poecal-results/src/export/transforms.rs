//! The frames that a calibration located, as transforms: targets on the tip, and the measuring device or board in the base.

use super::{ExportedRobot, export_error};
use crate::calibration_file::{CalibrationFile, MeasuredEntry, StationEntry};
use crate::frame_texts::NamedFrame;
use crate::model::{Model, ModelSource};
use poecal_calibrate::DeviceFrameKnowledge;
use poecal_formats::proof::Difference;
use poecal_model::measurement::Device;
use poecal_numerics::error::Result;

/// A device without a name.
const DEVICE: &str = "device";

/// The forms of all transforms, as `poecal hand-eye` writes them.
pub(crate) fn write(model: &Model) -> Result<ExportedRobot> {
    let ModelSource::Calibration(file) = &model.source else {
        let message = "found a model, expected a calibration.json: a model has located nothing";
        return Err(export_error(message.to_owned()).in_file(&model.path));
    };
    let (tip, mut notes) = on_tip(file)?;
    let all: Vec<String> = tip.into_iter().chain(in_base(file)?).collect();
    if all.is_empty() {
        let message = "found no target on the tip and no device that were located, expected one: rows in the base frame that see the tip locate nothing";
        return Err(export_error(message.to_owned()).in_file(&model.path));
    }
    let elsewhere: Vec<&str> = names_elsewhere(file);
    if !elsewhere.is_empty() {
        notes.push(format!(
            "{} on other links are not among the transforms: calibration.json has them in the frames of their joints",
            elsewhere.join(", ")
        ));
    }
    let remains = Difference { position_m: 0.0, rotation_rad: 0.0 };
    Ok(ExportedRobot { text: all.join("\n"), notes, remains, beside: None })
}

/// Targets in the frame of the tip, and notes on them.
fn on_tip(file: &CalibrationFile) -> Result<(Vec<String>, Vec<String>)> {
    let mut notes = Vec::new();
    let mut all = Vec::new();
    for (name, target) in file.targets.iter().filter(|(_, it)| it.on.is_none()) {
        let frame = NamedFrame { parent: file.robot.tip_link.clone(), child: name.clone(), pose: target.pose()? };
        match target.measured_entry() {
            MeasuredEntry::Pose => all.push(frame.short_forms()),
            MeasuredEntry::Position => all.push(frame.position_forms()),
            MeasuredEntry::Nothing => {
                notes.push(format!("target `{name}` was not measured: it is not among the transforms"))
            }
        }
    }
    Ok((all, notes))
}

/// Devices in the base that were located: for pictures the camera, or the board.
fn in_base(file: &CalibrationFile) -> Result<Vec<String>> {
    if file.frame() == DeviceFrameKnowledge::Base {
        return Ok(Vec::new());
    }
    let only = [StationEntry::instrument(None, file.measurement_frame.base_from_device)];
    let stations = if file.stations.is_empty() { &only[..] } else { &file.stations[..] };
    let beside =
        stations.iter().filter(|it| !it.instrument.as_ref().is_some_and(|name| file.instruments.contains_key(name)));
    let mut all = Vec::new();
    for station in beside {
        let kind = Device::ALL.into_iter().find(|it| Some(it.word()) == station.kind.as_deref());
        let child = station.instrument.clone().unwrap_or_else(|| device_name(file));
        let pose = station.base_from_device.pose()?;
        let frame = NamedFrame { parent: file.robot.base_link.clone(), child, pose };
        all.push(match kind.unwrap_or(Device::Instrument) {
            Device::Instrument | Device::Plane => frame.short_forms(),
            Device::Anchor | Device::Socket | Device::Sphere => frame.position_forms(),
            Device::Direction | Device::Pair => continue,
        });
    }
    Ok(all)
}

/// The name of the only device: for pictures that of the camera, or of the board if the camera is on the arm.
fn device_name(file: &CalibrationFile) -> String {
    let Some(pictures) = &file.pictures else { return DEVICE.to_owned() };
    let mut names = pictures.cameras.iter().map(|it| &it.name).chain(pictures.boards.iter().map(|it| &it.name));
    names.find(|name| !name.is_empty() && !file.targets.contains_key(*name)).map_or(DEVICE, |it| it).to_owned()
}

/// Names of targets on links other than the tip's.
fn names_elsewhere(file: &CalibrationFile) -> Vec<&str> {
    let targets = file.targets.iter().filter(|(_, it)| it.on.is_some()).map(|(name, _)| name.as_str());
    targets.chain(file.instruments.keys().map(String::as_str)).collect()
}
