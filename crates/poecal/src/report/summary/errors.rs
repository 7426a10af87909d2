//! The errors that count: of rows that were not fitted, before and after.

use std::fmt::Write as _;

use super::super::table::{line, number};
use crate::calibration::{DeviceFrameKnowledge, ModelAccuracy, SetAccuracy, Statistic};
use crate::io::calibration_file::CalibrationFile;

/// Width of the labels.
const LABEL: usize = 36;

/// Mean, RMS, 95 % and maximum of the errors of the rows held out, or if there are none, of those fitted.
pub(super) fn table(out: &mut String, file: &CalibrationFile) {
    let held_out = file.accuracy.held_out.as_ref();
    let (set, rest, suspected) = match held_out {
        Some(set) => (set, file.robust.held_out_without_suspected.as_ref(), file.robust.suspected_held_out),
        None => (
            &file.accuracy.training,
            file.robust.training_without_suspected.as_ref(),
            file.robust.suspected_fit,
        ),
    };
    let name = if held_out.is_some() { "held out" } else { "fitted" };
    let nominal = match file.measurement_frame.known {
        DeviceFrameKnowledge::Unknown => "nominal, tool and device fitted",
        DeviceFrameKnowledge::Base => "nominal, tool fitted",
    };
    let without = format!("calibrated, without {suspected} suspected");
    let mut rows: Vec<(&str, &ModelAccuracy)> =
        vec![(nominal, &set.registered), ("calibrated", &set.calibrated)];
    rows.extend(rest.map(|rest| (without.as_str(), &rest.calibrated)));
    let mut block = |title: &str, of: fn(&ModelAccuracy) -> Option<Statistic>| {
        head(out, &format!("{name} ({}), {title}", set.count));
        rows.iter().for_each(|(label, model)| row(out, label, of(model)));
    };
    block("position in mm", |model| Some(model.position_mm));
    if turned(set) {
        block("rotation in deg", |model| model.rotation_deg);
    }
    if held_out.is_none() {
        line(out, "", "no row was held out: these errors are of fitted rows");
        if let Some(found) = &file.cross_validation {
            let rms = number(found.random.position_rms_mm);
            line(out, "", &format!("cross-validation: {rms} mm (RMS) on rows that were not fitted"));
        }
    }
}

fn turned(set: &SetAccuracy) -> bool {
    set.calibrated.rotation_deg.is_some()
}

// Writing to a String cannot fail.
fn head(out: &mut String, title: &str) {
    let _ = writeln!(out, "{title:<LABEL$}{:>11}{:>11}{:>11}{:>11}", "mean", "RMS", "95 %", "max");
}

fn row(out: &mut String, label: &str, statistic: Option<Statistic>) {
    let _ = write!(out, "{:<LABEL$}", format!("  {label}"));
    let figures = statistic.map(|it| [it.mean, it.rms, it.p95, it.max].map(number));
    for cell in figures.unwrap_or_else(|| ["-"; 4].map(str::to_owned)) {
        let _ = write!(out, "{cell:>11}");
    }
    out.push('\n');
}
