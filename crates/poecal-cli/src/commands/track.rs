//! `poecal track`: whether a robot is as it was calibrated.

use std::ffi::OsString;

use poecal::calibration::DeviceFrameKnowledge;
use poecal::io::calibration_file::{CalibrationFile, Inputs, RecalibratedEntry, RepairedPart};
use poecal::io::measurements::{self, ReadOptions};
use poecal::io::named_files::refuse_repeats;
use poecal::io::output::{Existing, FilePlace};
use poecal::io::validation::ValidationInputs;
use poecal::track::{Earlier, State, TrackOptions, recalibrate, track as judged, witnesses};
use poecal::{ErrorKind, MeasurementFile, Result, Robot, report};

use super::kept::Kept;
use super::typed::command;
use crate::args::Track;
use crate::console::Console;
use crate::{DONE, WORSE};

pub(crate) fn track(arguments: &Track, typed: &[OsString], console: &Console) -> Result<u8> {
    refuse_repeats(&arguments.measurements)?;
    if arguments.out.is_some() && arguments.plan.is_none() && arguments.recalibrate.is_none() {
        return ErrorKind::Option
            .refuse("--out: found a file to write, expected it with --plan or --recalibrate alone");
    }
    let place = match &arguments.out {
        None => None,
        Some(out) => {
            let existing = Existing::forced(arguments.force);
            Some(FilePlace::reserve(out, existing, &arguments.inputs(), &mut console.warner())?)
        }
    };
    let file = CalibrationFile::read(&arguments.calibration)?;
    let in_file = |error: poecal::Error| {
        if error.kind() == ErrorKind::Model { error.in_file(&arguments.calibration) } else { error }
    };
    let robot = file.robot().map_err(in_file)?;
    let mut meaning = ReadOptions {
        ignore_sets: true,
        controller: file.controller.clone(),
        ..arguments.meaning.options()?
    };
    if let Some(known) = &file.pictures {
        known.complete(&mut meaning).map_err(|error| error.in_file(&arguments.calibration))?;
    }
    let options = TrackOptions {
        device_is_known: arguments.device.unwrap_or(file.frame() == DeviceFrameKnowledge::Base),
        tool_is_anew: arguments.tool,
        repeatability_m: arguments.repeatability,
    };
    let earlier = EarlierRows::read(arguments, &file, &robot, &meaning, console)?;
    if let Some(count) = arguments.plan {
        return plan(arguments, (&file, &robot, earlier, usize::from(count)), &options, place, console);
    }
    let mut history = Kept::read(arguments.history.as_ref(), &arguments.calibration)?;
    let read = measurements::read(&arguments.measurements, &robot, &meaning)?;
    let mut sha256 = Inputs::checksums(std::iter::once(arguments.calibration.as_path()))?;
    sha256.extend(read.sha256.clone());
    sha256.extend(earlier.read.iter().flat_map(|it| it.sha256.clone()));
    let calibration = arguments.calibration.display().to_string();
    let names: Vec<String> = arguments.measurements.iter().map(|path| path.display().to_string()).collect();
    console.said_of(&read);
    if let (Some(words), Some(place)) = (&arguments.recalibrate, place) {
        let (joint, part) = repaired_part(words);
        let provenance = RecalibratedEntry {
            joint: joint.to_owned(),
            part,
            size: 0.0,
            sigma: 0.0,
            motion: [0.0; 6],
            rows: 0,
            repeated: 0,
            measurements: names,
            calibration,
            sha256,
        };
        let found = recalibrate(&file, &read.data, earlier.rows(), &options, (joint, part), provenance)
            .map_err(in_file)?;
        let text = report::recalibrated(&found, &file);
        place.write(vec![found.file.to_text()?.into()])?;
        console.say(&text)?;
        console.warnings(&found.notes);
        return Ok(DONE);
    }
    let found = judged(&file, &read.data, earlier.rows(), &options).map_err(in_file)?;
    let inputs = ValidationInputs {
        calibration,
        measurements: names,
        sha256,
        files: read.inputs(),
        joins: read.joins.clone(),
        command: Some(command(typed)),
    };
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

/// Chooses witness configurations, and prints what they would show.
fn plan(
    arguments: &Track,
    (file, robot, earlier, count): (&CalibrationFile, &Robot, EarlierRows, usize),
    options: &TrackOptions,
    place: Option<FilePlace>,
    console: &Console,
) -> Result<u8> {
    let Some(rows) = earlier.rows() else {
        return ErrorKind::Option.refuse(
            "--plan: found no earlier rows, expected those of the calibration or of --reference: their configurations are those to be repeated",
        );
    };
    let found = witnesses(file, rows.data, count, arguments.target.as_deref(), options)?;
    let told = report::WitnessPlan::new(&found, &file.robot.name);
    let text = measurements::to_measure_again(rows.data, &found.configurations, robot)?;
    if let Some(place) = place {
        place.write(vec![text.into()])?;
    }
    if arguments.json {
        console.data(&report::json(&told)?)?;
    } else {
        console.say(&told.text())?;
    }
    Ok(DONE)
}

/// A joint, and what of it is calibrated anew.
fn repaired_part(words: &str) -> (&str, RepairedPart) {
    match words.rsplit_once('.') {
        Some((joint, "axis")) => (joint, RepairedPart::Axis),
        Some((joint, "offset")) => (joint, RepairedPart::Zero),
        _ => (words, RepairedPart::Zero),
    }
}

/// The earlier rows.
struct EarlierRows {
    read: Option<MeasurementFile>,
    /// Whether they are those of the calibration.
    is_own: bool,
}

impl EarlierRows {
    /// Those that are named, or else those of the calibration where they still are.
    fn read(
        arguments: &Track,
        file: &CalibrationFile,
        robot: &Robot,
        meaning: &ReadOptions,
        console: &Console,
    ) -> Result<Self> {
        if !arguments.reference.is_empty() {
            refuse_repeats(&arguments.reference)?;
            let read = measurements::read(&arguments.reference, robot, meaning)?;
            let own: Vec<&String> =
                file.inputs.measurements.iter().filter_map(|name| file.inputs.sha256.get(name)).collect();
            let is_own = read.sha256.values().all(|sha256| own.contains(&sha256));
            return Ok(EarlierRows { read: Some(read), is_own });
        }
        let names = file.inputs.measurements.join(", ");
        let Some(paths) = file.own_measurements(&arguments.calibration) else {
            console.remark(format!(
                "the measurements of the calibration ({names}) are not where it was made, or have other bytes: name earlier rows by --reference; \
                 without, rows are judged by the model"
            ));
            return Ok(EarlierRows { read: None, is_own: false });
        };
        let read = measurements::read(&paths, robot, meaning);
        if let Err(error) = &read {
            console.remark(format!(
                "the measurements of the calibration ({names}) cannot be read as those of the visit ({error}): judged by the model"
            ));
        }
        Ok(EarlierRows { read: read.ok(), is_own: true })
    }

    fn rows(&self) -> Option<Earlier<'_>> {
        self.read.as_ref().map(|it| Earlier { data: &it.data, is_own: self.is_own })
    }
}
