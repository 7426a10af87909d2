//! `poecal track`: detection of a robot's change since its calibration.

use std::ffi::OsString;
use std::path::PathBuf;

use poecal_import as measurements;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_report as report;
use poecal_results::calibration_file::{CalibrationFile, Inputs, RecalibrationSources, RepairedPart};
use poecal_results::output::{ExistingFiles, ReservedFile};
use poecal_results::record::Record;
use poecal_results::track::{RecalibratedJoint, RobotCondition, recalibrate, track as judged};
use poecal_results::validation::{ValidationInputs, current_time};
use poecal_storage::named_files::refuse_repeats;

use super::check_history::CheckHistory;
use super::reproducing_command::command;
use super::visits::{VisitSettings, VisitedCalibration};
use crate::args::TrackArgs;
use crate::console::Console;
use crate::style::{label_paragraph, printable_path};
use crate::{DONE, WORSE};

pub(crate) fn track(arguments: &TrackArgs, typed: &[OsString], console: &Console) -> Result<u8> {
    refuse_repeats(&arguments.measurements)?;
    let (place, page) = reserve(arguments, console)?;
    let record = Record::from_pairs(arguments.record.iter().map(|(key, text)| (key.as_str(), text.as_str())))?;
    let stated = VisitSettings {
        calibration: &arguments.calibration,
        reference: &arguments.reference,
        meaning: arguments.meaning.options()?,
        device_is_known: arguments.device,
        tool_is_anew: arguments.tool,
        repeatability_m: arguments.repeatability,
    };
    let visited = VisitedCalibration::read(stated, console)?;
    if let Some(count) = arguments.plan {
        return plan(arguments, &visited, usize::from(count), place, console);
    }
    let VisitedCalibration { file, robot, meaning, options, earlier } = visited;
    let in_file = |error: poecal_numerics::error::Error| {
        if error.kind() == ErrorKind::Model { error.in_file(&arguments.calibration) } else { error }
    };
    let mut history = CheckHistory::read(arguments.history.as_ref(), &arguments.calibration)?;
    let read = measurements::read(&arguments.measurements, &robot, &meaning)?;
    let mut sha256 = Inputs::checksums(std::iter::once(arguments.calibration.as_path()))?;
    sha256.extend(read.sha256.clone());
    sha256.extend(earlier.read.iter().flat_map(|it| it.sha256.clone()));
    let calibration = arguments.calibration.display().to_string();
    let names: Vec<String> = arguments.measurements.iter().map(|path| path.display().to_string()).collect();
    console.said_of(&read);
    if let (Some(words), Some(place)) = (&arguments.recalibrate, place) {
        let (joint, part) = RepairedPart::from_name(words);
        let sources = RecalibrationSources { measurements: names, calibration, sha256 };
        let found =
            recalibrate(&file, &read.data, earlier.rows(), &options, (joint, part), sources).map_err(in_file)?;
        return deliver(&found, &file, place, console);
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
    let told = report::TrackReport::new(&found, &file.robot.name, inputs).with_record(record);
    if let Some(page) = page {
        page.write(report::visit_page(&told, &file, current_time().as_deref()))?;
    }
    history.append(|history, time| history.append(&told, time), console)?;
    if arguments.json {
        console.data(&report::json(&told)?)?;
    } else {
        let written = arguments.report.as_deref().map(|path| label_paragraph("report", &printable_path(path)));
        console.say(&(told.text() + &written.unwrap_or_default()))?;
    }
    console.warnings(&found.notes);
    Ok(if found.state == RobotCondition::Changed { WORSE } else { DONE })
}

/// Places of the output: of a plan or a recalibration of one joint, and of the page of a visit.
fn reserve(arguments: &TrackArgs, console: &Console) -> Result<(Option<ReservedFile>, Option<ReservedFile>)> {
    if arguments.out.is_some() && arguments.plan.is_none() && arguments.recalibrate.is_none() {
        return ErrorKind::Option
            .refuse("--out: found a file to write, expected it with --plan or --recalibrate alone");
    }
    let reserve = |path: &PathBuf| {
        let existing = ExistingFiles::from_switch(arguments.force);
        ReservedFile::reserve(path, existing, &arguments.inputs(), &mut console.warner())
    };
    Ok((arguments.out.as_ref().map(reserve).transpose()?, arguments.report.as_ref().map(reserve).transpose()?))
}

/// Writes a calibration with one joint recalibrated, and reports that.
fn deliver(found: &RecalibratedJoint, before: &CalibrationFile, place: ReservedFile, console: &Console) -> Result<u8> {
    let text = report::describe_recalibrated(found, before);
    place.write(vec![found.file.to_text()?.into()])?;
    console.say(&text)?;
    console.warnings(&found.notes);
    Ok(DONE)
}

/// Chooses witness configurations, and prints their detectable shifts.
fn plan(
    arguments: &TrackArgs,
    visited: &VisitedCalibration,
    count: usize,
    place: Option<ReservedFile>,
    console: &Console,
) -> Result<u8> {
    let (told, table) = visited.plan_visit("--plan", count, arguments.target.as_deref(), None)?;
    if let Some(place) = place {
        place.write(vec![table.into()])?;
    }
    if arguments.json {
        console.data(&report::json(&told)?)?;
    } else {
        console.say(&told.text())?;
    }
    Ok(DONE)
}
