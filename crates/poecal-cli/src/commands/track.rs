//! `poecal track`: whether a robot is as it was calibrated.

use std::ffi::OsString;
use std::path::PathBuf;

use poecal::calibration::DeviceFrameKnowledge;
use poecal::io::calibration_file::{CalibrationFile, Inputs};
use poecal::io::measurements::{self, ReadOptions};
use poecal::io::named_files::refuse_repeats;
use poecal::io::validation::ValidationInputs;
use poecal::track::{State, TrackOptions, track as judged};
use poecal::{Dataset, ErrorKind, MeasurementFile, Result, Robot, report};

use super::kept::Kept;
use super::typed::command;
use crate::args::Track;
use crate::console::Console;
use crate::{DONE, WORSE};

pub(crate) fn track(arguments: &Track, typed: &[OsString], console: &Console) -> Result<u8> {
    refuse_repeats(&arguments.measurements)?;
    refuse_repeats(&arguments.inputs().into_iter().map(PathBuf::from).collect::<Vec<_>>())?;
    let file = CalibrationFile::read(&arguments.calibration)?;
    let mut history = Kept::read(arguments.history.as_ref(), &arguments.calibration)?;
    let in_file = |error: poecal::Error| {
        if error.kind() == ErrorKind::Model { error.in_file(&arguments.calibration) } else { error }
    };
    let robot = file.robot().map_err(in_file)?;
    let controller = file.controller.clone();
    let mut meaning = ReadOptions { ignore_sets: true, controller, ..arguments.meaning.options()? };
    if let Some(known) = &file.pictures {
        known.complete(&mut meaning).map_err(|error| error.in_file(&arguments.calibration))?;
    }
    let read = measurements::read(&arguments.measurements, &robot, &meaning)?;
    let earlier = Earlier::read(arguments, &file, &robot, &meaning, console)?;
    let device_is_known = arguments.device.unwrap_or(file.frame() == DeviceFrameKnowledge::Base);
    let options = TrackOptions {
        device_is_known,
        tool_is_anew: arguments.tool,
        repeatability_m: arguments.repeatability,
    };
    let found = judged(&file, &read.data, earlier.data(), &options).map_err(in_file)?;
    let mut sha256 = Inputs::checksums(std::iter::once(arguments.calibration.as_path()))?;
    sha256.extend(read.sha256.clone());
    sha256.extend(earlier.read.iter().flat_map(|it| it.sha256.clone()));
    let inputs = ValidationInputs {
        calibration: arguments.calibration.display().to_string(),
        measurements: arguments.measurements.iter().map(|path| path.display().to_string()).collect(),
        sha256,
        command: Some(command(typed)),
    };
    console.said_of(&read);
    let told = report::Track::new(&found, &file.robot.name, inputs);
    history.append(|history, time| history.append(&told, time), console)?;
    if arguments.json {
        console.data(&report::json(&told)?)?;
    } else {
        console.say(&told.text())?;
    }
    console.warnings(&found.notes);
    Ok(if found.state == State::Changed { WORSE } else { DONE })
}

/// The earlier rows.
struct Earlier {
    read: Option<MeasurementFile>,
}

impl Earlier {
    /// Those that are named, or else those of the calibration where they still are.
    fn read(
        arguments: &Track,
        file: &CalibrationFile,
        robot: &Robot,
        meaning: &ReadOptions,
        console: &Console,
    ) -> Result<Self> {
        if !arguments.reference.is_empty() {
            return Ok(Earlier { read: Some(measurements::read(&arguments.reference, robot, meaning)?) });
        }
        let names = file.inputs.measurements.join(", ");
        let Some(paths) = file.own_measurements(&arguments.calibration) else {
            console.remark(format!(
                "the measurements of the calibration ({names}) are not where it was made, or have other bytes: judged by the model; name earlier rows by \
                 --reference"
            ));
            return Ok(Earlier { read: None });
        };
        let read = measurements::read(&paths, robot, meaning);
        if let Err(error) = &read {
            console.remark(format!("the measurements of the calibration ({names}) cannot be read as those of the visit ({error}): judged by the model"));
        }
        Ok(Earlier { read: read.ok() })
    }

    fn data(&self) -> Option<&Dataset> {
        self.read.as_ref().map(|it| &it.data)
    }
}
