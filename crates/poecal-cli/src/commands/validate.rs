//! `poecal validate`: a calibration judged by other measurements.

use std::collections::BTreeMap;
use std::ffi::OsString;

use poecal_calibrate::{AcceptanceLimits, Decision, Judgement, Level};
use poecal_import as measurements;
use poecal_import::{MeasurementFile, ReadOptions};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_report as report;
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_results::output::{ExistingFiles, ValidationOutputs};
use poecal_results::record::Record;
use poecal_results::validation::{JudgedRows, Validation, ValidationInputs, ValidationOptions};
use poecal_storage::named_files::refuse_repeats;

use super::check_history::CheckHistory;
use super::reproducing_command::command;
use crate::args::{RefitChoice, ReportPlace, Validate};
use crate::console::Console;
use crate::style::{self, label_paragraph, printable_path};
use crate::{DONE, WORSE};

pub(crate) fn validate(arguments: &Validate, typed: &[OsString], console: &Console) -> Result<u8> {
    refuse_repeats(&arguments.measurements)?;
    let places = places(arguments, console)?;
    let file = CalibrationFile::read(&arguments.calibration)?;
    let mut history = CheckHistory::read(arguments.history.as_ref(), &arguments.calibration)?;
    let in_file = |error: poecal_numerics::error::Error| {
        if error.kind() == ErrorKind::Model { error.in_file(&arguments.calibration) } else { error }
    };
    let calibrated = file.robot().map_err(in_file)?;
    // Every row counts, in any set.
    let controller = file.controller.clone();
    let mut options = ReadOptions { ignore_sets: true, controller, ..arguments.meaning.options()? };
    if let Some(known) = &file.pictures {
        known.complete_options(&mut options).map_err(|error| error.in_file(&arguments.calibration))?;
    }
    let read = measurements::read(&arguments.measurements, &calibrated, &options)?;
    let limits = AcceptanceLimits::from_choice(arguments.accept.clone(), arguments.accept_model)?;
    let judging = ValidationOptions {
        refit_frame: arguments.refit.contains(&RefitChoice::Device),
        refit_moved: arguments.refit.contains(&RefitChoice::Auto),
        refit_tool: arguments.refit.contains(&RefitChoice::Tool),
        accept: limits.as_ref(),
    };
    let sha256 = Inputs::checksums(std::iter::once(arguments.calibration.as_path()))?;
    let own = sha256.get(&arguments.calibration.display().to_string()).cloned();
    let inputs = inputs(arguments, typed, &read, sha256);
    let record = Record::from_pairs(arguments.record.iter().map(|(key, text)| (key.as_str(), text.as_str())))?;
    let found = Validation::from_measurements(&file, &read.data, &judging, inputs).map_err(in_file)?;
    let found = Validation { record, ..found };
    console.said_of(&read);
    if let Some(doubt) = file.pictures.as_ref().and_then(|it| it.read_otherwise(&read.data)) {
        console.warning(doubt);
    }
    let rows = JudgedRows { data: &read.data, robot: &calibrated, rows: &found.judgement.rows };
    let earlier: Vec<_> = own.iter().flat_map(|own| history.checks.checks_before(&found, own)).collect();
    let (folder, report) = places.write(&found, rows, || report::validation_page(&found, &rows, &earlier))?;
    let mut written =
        folder.as_ref().map_or_else(String::new, |it| style::describe_written_files(&it.folder, &it.files));
    written.extend(report.as_ref().map(|path| label_paragraph("report", &printable_path(path))));
    let place = folder.map(|it| it.folder).or(report);
    history.append(|history, time| history.append(&found, time), console)?;
    let table = || {
        let calibration = arguments.calibration.display().to_string();
        report::judgement(&calibration, &found.inputs.measurements.join(", "), &found.judgement) + &written
    };
    let text = if arguments.json { found.to_text()? } else { table() };
    let told = match (place, arguments.json) {
        (Some(place), true) => console.data_of(&text, &place),
        (Some(place), false) => console.say_of(&text, &place),
        (None, true) => console.data(&text).map(|()| DONE)?,
        (None, false) => console.say(&text).map(|()| DONE)?,
    };
    console.warnings(&found.warnings());
    let refused = found.judgement.acceptance.as_ref().is_some_and(|it| it.decision != Decision::Pass);
    let fails = found.verdict.level == Some(Level::DoNotUse);
    let missing = required_and_missing(arguments, &found.judgement);
    missing.iter().for_each(|it| console.warning(it));
    Ok(if refused || fails || !missing.is_empty() { WORSE.max(told) } else { told })
}

/// Requirements that the measurements do not show, a sentence each.
fn required_and_missing(arguments: &Validate, judgement: &Judgement) -> Vec<String> {
    let level = arguments.require.and_then(|required| {
        let reason = judgement.falls_short(required)?;
        Some(format!("not what --require {} asks for: {reason}", required.word()))
    });
    let gain = judgement.gain_doubt().filter(|_| arguments.require_gain);
    level.into_iter().chain(gain.map(|why| format!("not what --require-gain asks for: {why}"))).collect()
}

/// The judged calibration and the measurements that judge it.
fn inputs(
    arguments: &Validate,
    typed: &[OsString],
    read: &MeasurementFile,
    sha256: BTreeMap<String, String>,
) -> ValidationInputs {
    ValidationInputs {
        calibration: arguments.calibration.display().to_string(),
        measurements: arguments.measurements.iter().map(|path| path.display().to_string()).collect(),
        sha256: sha256.into_iter().chain(read.sha256.clone()).collect(),
        files: read.inputs(),
        joins: read.joins.clone(),
        command: Some(command(typed)),
    }
}

/// Places of the results.
fn places(arguments: &Validate, console: &Console) -> Result<ValidationOutputs> {
    let report = match &arguments.report {
        Some(ReportPlace::File(path)) => (true, Some(path.as_path())),
        Some(ReportPlace::None) => (false, None),
        None => (true, None),
    };
    let (existing, inputs) = (ExistingFiles::from_switch(arguments.force), arguments.inputs());
    ValidationOutputs::reserve(arguments.out.as_deref(), report, existing, &inputs, &mut console.warner())
}
