//! `poecal iso9283`: accuracy and repeatability as a data sheet states them.

use std::collections::BTreeMap;
use std::ffi::OsString;

use poecal_calibrate::{Decision, iso9283 as tested};
use poecal_numerics::error::Result;
use poecal_report as report;
use poecal_results::calibration_file::Inputs;
use poecal_results::iso9283::{TestFile, TestOptions, TestResult, read_test};
use poecal_results::record::Record;
use poecal_results::validation::ValidationInputs;
use poecal_storage::named_files::refuse_repeats;

use super::frames::model;
use super::reproducing_command::command;
use crate::args::Iso9283Args;
use crate::console::Console;
use crate::{DONE, WORSE};

pub(crate) fn iso9283(arguments: &Iso9283Args, typed: &[OsString], console: &Console) -> Result<u8> {
    refuse_repeats(&arguments.measurements)?;
    let place = arguments.place.reserve(&arguments.inputs(), console)?;
    let record =
        Record::from_pairs(arguments.record.iter().map(|(key, text)| (key.as_str(), text.as_str())))?;
    let model = model(arguments.robot.as_ref(), &arguments.chain, console)?;
    let options = TestOptions {
        reading: arguments.meaning.options()?,
        frame: arguments.device_frame,
        sigma_position_m: arguments.sigma_position,
        sigma_rotation_rad: arguments.sigma_rotation,
    };
    let file = read_test(&arguments.measurements, model.as_ref(), &options)?;
    console.said_of(&file.read);
    let found = tested(&file.rows, file.base_from_device)?;
    let inputs = inputs(arguments, typed, &file)?;
    let stated = (file.speed.clone(), record);
    let mut test = TestResult::new(&found, arguments.device_frame, &arguments.accept, inputs, stated)?;
    test.warnings.extend(file.warnings);
    let text = if arguments.json { test.to_text()? } else { report::iso9283(&test) };
    console.show(text, place, arguments.json)?;
    console.warnings(&test.warnings);
    Ok(if test.decision.is_some_and(|it| it != Decision::Pass) { WORSE } else { DONE })
}

/// The files of a test.
fn inputs(arguments: &Iso9283Args, typed: &[OsString], file: &TestFile) -> Result<ValidationInputs> {
    let robot = arguments.robot.as_deref();
    let sha256: BTreeMap<_, _> = Inputs::checksums(robot.into_iter())?;
    Ok(ValidationInputs {
        calibration: robot.map_or_else(String::new, |path| path.display().to_string()),
        measurements: arguments.measurements.iter().map(|path| path.display().to_string()).collect(),
        sha256: sha256.into_iter().chain(file.read.sha256.clone()).collect(),
        files: file.read.inputs(),
        joins: file.read.joins.clone(),
        command: Some(command(typed)),
    })
}
