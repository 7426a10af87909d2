//! `poecal validate`: a calibration judged by measurements that it did not see.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use poecal::calibration::{Judgement, KeptPart, Promise, Subject, judge};
use poecal::io::calibration_file::CalibrationFile;
use poecal::io::measurements::{self, ReadOptions};
use poecal::{Result, report};

use super::files::{actual, refuse_repeats};
use crate::args::Validate;
use crate::console::Console;

/// A device frame that fits leaves errors of the calibration's own size; beyond this many times it, the device was moved.
const MOVED_DEVICE: f64 = 20.0;
/// Share of errors inside their 95 % bound below which the promise is broken.
const BROKEN: f64 = 0.75;
/// What a calibration of exact data leaves is rounding, below a nanometre.
const ROUNDING_MM: f64 = 1e-6;

pub(crate) fn validate(arguments: &Validate, console: &Console) -> Result<ExitCode> {
    refuse_repeats(&arguments.measurements)?;
    let file = CalibrationFile::read(&arguments.calibration)?;
    let in_file = |error: poecal::Error| error.in_file(&arguments.calibration);
    let (calibrated, nominal) = (file.robot().map_err(in_file)?, file.nominal_robot().map_err(in_file)?);
    // Every row counts, whatever set the files say.
    let options = ReadOptions { ignore_sets: true, ..arguments.columns.options()? };
    let read = measurements::read(&arguments.measurements, &calibrated, &options)?;
    if !arguments.refit_tool {
        file.check_targets(&read.data)?;
    }
    let noise = file.noise().map_err(in_file)?;
    // A calibration without uncertainty, or of other targets, promises nothing.
    let stated = file.uncertainty.is_some() && !arguments.refit_tool;
    let names: Vec<Option<&str>> = read.data.targets.iter().map(Option::as_deref).collect();
    let found = if stated { Some(file.uncertainty(&names).map_err(in_file)?) } else { None };
    let promise = found.as_ref().map(|(uncertainty, targets)| Promise {
        uncertainty,
        targets,
        noise,
        noise_is_stated: file.noise_is_stated(),
        coverage: &file.coverage,
    });
    let subject = Subject {
        calibrated: &calibrated,
        nominal: &nominal,
        base_from_device: file.base_from_device().map_err(in_file)?,
        frame: file.frame(),
        noise,
        refit_frame: arguments.refit_frame,
        refit_tool: arguments.refit_tool,
        promise,
    };
    let judgement = judge(&subject, &read.data)?;
    for warning in &read.warnings {
        console.warning(warning);
    }
    if arguments.json {
        console.data(&report::json(&judgement)?)?;
    } else {
        let calibration = arguments.calibration.display().to_string();
        console.say(&report::judgement(&calibration, &named(arguments, &file), &judgement))?;
    }
    warn(arguments, &file, &judgement, console);
    Ok(ExitCode::SUCCESS)
}

/// Tells of errors that the calibration does not explain.
fn warn(arguments: &Validate, file: &CalibrationFile, judgement: &Judgement, console: &Console) {
    let own_mm = file.own_position_rms_mm().max(ROUNDING_MM);
    let rms_mm = judgement.calibrated.position_mm.rms;
    let kept = judgement.promised.filter(|_| rms_mm > ROUNDING_MM);
    // Where most errors are as promised, single rows are wrong, and not the device.
    let mostly = kept.is_some_and(|it| it.position_mm.inside_bound95 > 0.5);
    if !arguments.refit_frame && !mostly && rms_mm > MOVED_DEVICE * own_mm {
        console.warning(format!(
            "the position error is {:.0} times that of the calibration itself ({rms_mm:.2e} mm, {own_mm:.2e} mm): \
             if the measuring device was moved, find its frame anew with --refit-frame",
            rms_mm / own_mm
        ));
    } else if mostly && rms_mm > MOVED_DEVICE * own_mm {
        console.warning(format!(
            "most errors are as promised, the largest is {:.2} mm: some measurements are grossly wrong",
            judgement.calibrated.position_mm.max
        ));
    } else if let Some(kept) = kept.filter(|it| it.least_inside() < BROKEN) {
        let share = |part: KeptPart| 100.0 * (1.0 - part.inside_bound95);
        let position = format!("{:.0} % of the position errors", share(kept.position_mm));
        let rotation =
            kept.rotation_deg.map(|part| format!(" and {:.0} % of the rotation errors", share(part)));
        console.warning(format!(
            "{position}{} exceed their 95 % bound: the robot, its tool or the measuring device is not as it was calibrated, it is used \
             outside the sampled range, or orientations are written in another form",
            rotation.unwrap_or_default()
        ));
    }
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
