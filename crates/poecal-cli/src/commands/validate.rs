//! `poecal validate`: a calibration judged by other measurements.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use poecal::calibration::{AcceptanceLimits, Decision, Refitted};
use poecal::io::calibration_file::CalibrationFile;
use poecal::io::measurements::{self, ReadOptions};
use poecal::io::named_files::{actual, refuse_repeats};
use poecal::{ErrorKind, Result, report};

use crate::args::Validate;
use crate::console::Console;
use crate::{DONE, WORSE};

pub(crate) fn validate(arguments: &Validate, console: &Console) -> Result<u8> {
    refuse_repeats(&arguments.measurements)?;
    let file = CalibrationFile::read(&arguments.calibration)?;
    let in_file = |error: poecal::Error| {
        if error.kind() == ErrorKind::Model { error.in_file(&arguments.calibration) } else { error }
    };
    let calibrated = file.robot().map_err(in_file)?;
    // Every row counts, whatever its set.
    let controller = file.controller.clone();
    let options = ReadOptions { ignore_sets: true, controller, ..arguments.meaning.options()? };
    let read = measurements::read(&arguments.measurements, &calibrated, &options)?;
    let refit_tool = arguments.refit_tool;
    let judged = if arguments.refit_frame {
        file.judge(&read.data, true, refit_tool)
    } else {
        file.judge_wherever(&read.data, refit_tool, arguments.refit)
    };
    let mut judgement = judged.map_err(in_file)?;
    let refit_frame = judgement.refitted.contains(&Refitted::DeviceFrame);
    if let Some(limits) = AcceptanceLimits::chosen(arguments.accept.clone(), arguments.accept_model)? {
        let found = file.accept(&read.data, refit_frame, refit_tool, &limits, &read.sha256);
        judgement.acceptance = Some(found.map_err(in_file)?);
    }
    console.warnings(&read.warnings);
    let table = || {
        let calibration = arguments.calibration.display().to_string();
        report::judgement(&calibration, &named(arguments, &file), &judgement)
    };
    console.json_or_table(arguments.json, || report::json(&judgement), table)?;
    if let Some(doubt) = file.doubt(&judgement) {
        console.warning(doubt);
    }
    let refused = judgement.acceptance.as_ref().is_some_and(|it| it.decision != Decision::Pass);
    let code = if refused { WORSE } else { DONE };
    let Some(required) = arguments.require else { return Ok(code) };
    let Some(reason) = judgement.falls_short(required) else { return Ok(code) };
    console.warning(format!("not what --require {} asks for: {reason}", required.word()));
    Ok(WORSE)
}

/// The measurement files; those of the calibration are marked.
fn named(arguments: &Validate, file: &CalibrationFile) -> String {
    let training: HashSet<PathBuf> =
        file.inputs.measurements.iter().map(|name| actual(Path::new(name))).collect();
    let names = arguments.measurements.iter().map(|path| {
        let name = path.display().to_string();
        let mark = if training.contains(&actual(path)) { " (has training rows)" } else { "" };
        name + mark
    });
    names.collect::<Vec<_>>().join(", ")
}
