//! `residuals.csv`: what each measurement leaves, row by row.

use std::fmt::Write as _;

use crate::analysis::Influence;
use crate::calibration::{Calibration, RowError, RowJudgement, row_errors, row_influence};
use crate::estimate::{Estimate, Packed};
use crate::measurement::Dataset;

use super::numbers::push_number;

/// The text of the file: rows in the order of the data, errors of the three models, and the calibrated model's residual (measured
/// less predicted) by component in the device's axes; then what the row meant to the fit.
#[must_use]
pub fn text(data: &Dataset, calibration: &Calibration) -> String {
    let packed = Packed::new(&calibration.nominal, data.all_readings(), data.reading_names().len());
    let rows: Vec<u32> = data.all_rows();
    let of = |estimate: &Estimate| row_errors(data, &packed, &rows, estimate);
    let nominal = of(&calibration.models.nominal);
    let registered = of(&calibration.models.registered);
    let calibrated = of(&calibration.models.calibrated);
    let influences = row_influence(calibration, data, &rows);
    let mut held_out = vec![false; data.len()];
    for &row in &calibration.held_out_rows {
        held_out[row as usize] = true;
    }
    let mut out = String::with_capacity(data.len() * 160);
    out.push_str(
        "file,line,id,set,target,position_nominal[mm],position_registered[mm],position_calibrated[mm],x[mm],y[mm],z[mm],\
         rotation_nominal[deg],rotation_registered[deg],rotation_calibrated[deg],rx[deg],ry[deg],rz[deg],\
         weight,leverage,studentized,suspected\n",
    );
    let files: Vec<String> =
        data.files.iter().map(|path| quoted(&path.display().to_string()).into_owned()).collect();
    for (row, observation) in data.observations.iter().enumerate() {
        let file = files.get(observation.source.file as usize).map_or("", String::as_str);
        let set = if held_out[row] { "held_out" } else { "fit" };
        let id = data.ids.get(row).map_or("", String::as_str);
        let target = data.targets[observation.target].as_deref().unwrap_or("");
        let line = observation.source.line;
        // Writing to a String cannot fail.
        let _ = write!(out, "{file},{line},{},{set},{}", quoted(id), quoted(target));
        let models = [&nominal[row], &registered[row], &calibrated[row]];
        for error in models {
            cell(&mut out, error.position_m.norm() * 1e3);
        }
        for component in &calibrated[row].position_m {
            cell(&mut out, component * 1e3);
        }
        write_rotations(&mut out, models, &calibrated[row]);
        if let Some(judged) = calibration.robustness.rows.get(row) {
            let Influence { leverage, studentized } = influences[row];
            let RowJudgement { weight, suspected } = judged;
            [*weight, leverage, studentized].into_iter().for_each(|number| cell(&mut out, number));
            out.push_str(if *suspected { ",1" } else { ",0" });
        }
        out.push('\n');
    }
    out
}

fn write_rotations(out: &mut String, models: [&RowError; 3], calibrated: &RowError) {
    let Some(components) = calibrated.rotation_rad else {
        out.push_str(",,,,,,");
        return;
    };
    for error in models {
        cell(out, error.rotation_rad.map_or(f64::NAN, |w| w.norm().to_degrees()));
    }
    for component in &components {
        cell(out, component.to_degrees());
    }
}

fn cell(out: &mut String, number: f64) {
    out.push(',');
    push_number(out, number);
}

/// A CSV cell, quoted where it must be.
pub(super) fn quoted(text: &str) -> std::borrow::Cow<'_, str> {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\"")).into()
    } else {
        text.into()
    }
}
