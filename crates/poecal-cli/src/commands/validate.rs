//! `poecal validate`: a calibration judged by measurements that it did not see.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use poecal::calibration::{Subject, judge};
use poecal::io::calibration_file::CalibrationFile;
use poecal::io::measurements::{self, ReadOptions};
use poecal::{Result, report};

use super::files::{actual, refuse_repeats};
use crate::args::Validate;
use crate::console::Console;

/// A device frame that fits leaves errors of the calibration's own size; beyond this many times it, the device was moved.
const MOVED_DEVICE: f64 = 20.0;
/// What a calibration of exact data leaves is rounding, below a nanometre.
const ROUNDING_MM: f64 = 1e-6;

pub(crate) fn validate(arguments: &Validate, console: &Console) -> Result<ExitCode> {
    refuse_repeats(&arguments.measurements)?;
    let file = CalibrationFile::read(&arguments.calibration)?;
    let in_file = |error: poecal::Error| error.in_file(&arguments.calibration);
    let (calibrated, nominal) = (file.robot().map_err(in_file)?, file.nominal_robot().map_err(in_file)?);
    let subject = Subject {
        calibrated: &calibrated,
        nominal: &nominal,
        base_from_device: file.base_from_device().map_err(in_file)?,
        frame: file.frame(),
        noise: file.noise().map_err(in_file)?,
        refit_frame: arguments.refit_frame,
        refit_tool: arguments.refit_tool,
    };
    // Every row counts, whatever set the files say.
    let options = ReadOptions { ignore_sets: true, ..arguments.columns.options()? };
    let read = measurements::read(&arguments.measurements, &calibrated, &options)?;
    if !arguments.refit_tool {
        file.check_targets(&read.data)?;
    }
    let judgement = judge(&subject, &read.data)?;
    for warning in &read.warnings {
        console.warning(warning);
    }
    let own_mm = file.own_position_rms_mm().max(ROUNDING_MM);
    let rms_mm = judgement.calibrated.position_mm.rms;
    if arguments.json {
        console.data(&report::json(&judgement)?)?;
    } else {
        let calibration = arguments.calibration.display().to_string();
        console.say(&report::judgement(&calibration, &named(arguments, &file), &judgement))?;
    }
    if !arguments.refit_frame && rms_mm > MOVED_DEVICE * own_mm {
        console.warning(format!(
            "the position error is {:.0} times that of the calibration itself ({rms_mm:.2e} mm, {own_mm:.2e} mm): \
             if the measuring device was moved, find its frame anew with --refit-frame",
            rms_mm / own_mm
        ));
    }
    Ok(ExitCode::SUCCESS)
}

/// The measurement files; those that the calibration was made from are marked.
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
