//! `poecal check`: interpretation of files.

use std::collections::BTreeMap;
use std::path::Path;

use poecal_calibrate::DeviceFrameKnowledge;
use poecal_fit::forensics::{DiagnosisOptions, diagnose};
use poecal_import as measurements;
use poecal_import::MeasurementFile;
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_report as report;
use poecal_results::model::Model;

use crate::DONE;
use crate::args::CheckArgs;
use crate::console::Console;
use crate::style::{label_paragraph, printable_path};

pub(crate) fn check(arguments: &CheckArgs, console: &Console) -> Result<u8> {
    let options = arguments.reading.options();
    let Some(path) = &arguments.model else {
        return ErrorKind::Option
            .refuse("found no model, expected `poecal check MODEL FILES…`, or settings that name it");
    };
    let model = Model::read(path, &arguments.chain.selection(options.as_ref().ok())?);
    if let (Some(choices), true) = (model.as_ref().err().and_then(Error::choices), arguments.json) {
        console.data(&report::json(&BTreeMap::from([("choices", choices)]))?)?;
    }
    let model = model?;
    let options = model.reads(options?);
    let measurements = if arguments.measurements.is_empty() {
        None
    } else {
        Some(measurements::read(&arguments.measurements, &model.robot, &options)?)
    };
    let found = measurements.as_ref().map_or_else(Vec::new, |file| {
        let device_free = arguments.device_frame == DeviceFrameKnowledge::Unknown;
        let options = DiagnosisOptions { device_free, ..DiagnosisOptions::default() };
        diagnose(&model.robot, &file.data, &file.data.all_rows(), &options)
    });
    let check = report::Check::new(&model, measurements.as_ref(), &found);
    let next = measurements.as_ref().map_or_else(String::new, |file| next(arguments, path, file));
    console.json_or_table(arguments.json, || report::json(&check), || check.text() + &next)?;
    Ok(DONE)
}

/// The command that makes one table from joined files.
fn next(arguments: &CheckArgs, model: &Path, file: &MeasurementFile) -> String {
    if file.join.is_none() {
        return String::new();
    }
    let files: Vec<String> = arguments.measurements.iter().map(|path| printable_path(path)).collect();
    label_paragraph(
        "next",
        &format!(
            "poecal import {} {} --out session.csv writes one table, and how it was made",
            printable_path(model),
            files.join(" ")
        ),
    )
}
