//! The suspected rows in a calibration's table.

use std::fmt::Write as _;

use super::table::{line, number};
use crate::calibration::Calibration;
use crate::io::calibration_file::{OutlierEntry, OutlierSet};
use crate::measurement::Dataset;
use crate::text::visible;

/// Rows that are named.
const WORST: usize = 5;

/// How many rows are suspected, the worst of them, and the errors without them; nothing if there is none.
pub(super) fn suspected(calibration: &Calibration, data: &Dataset) -> String {
    let mut out = String::new();
    let robustness = &calibration.robustness;
    let count = robustness.suspects().count();
    let fit = match robustness.loss {
        Some(loss) => format!("fitted by the {} loss", loss.word()),
        None => "fitted by least squares".to_owned(),
    };
    if count == 0 {
        if robustness.loss.is_some() {
            line(&mut out, "outliers", &format!("none suspected; {fit}"));
            out.push('\n');
        }
        return out;
    }
    let suspected = |rows: &[u32]| rows.len() - robustness.rest(rows).len();
    let of_fit = suspected(&calibration.fit_rows);
    let words = format!("{count} rows suspected ({of_fit} fitted, {} held out); {fit}", count - of_fit);
    line(&mut out, "outliers", &words);
    for (name, rest) in [("training", &robustness.training_rest), ("held out", &robustness.held_out_rest)] {
        if let Some(rest) = rest {
            let rotation = rest.calibrated.rotation_deg;
            let rotation = rotation.map_or_else(String::new, |turn| format!(", {} deg", number(turn.rms)));
            let rms = number(rest.calibrated.position_mm.rms);
            let words = format!("{name} without them ({}): calibrated RMS {rms} mm{rotation}", rest.count);
            line(&mut out, "", &words);
        }
    }
    // Writing to a String cannot fail.
    let _ = writeln!(out, "{:14}{:>12}{:>12}{:>9}  file:line", "", "off by, mm", "deg", "weight");
    for outlier in OutlierEntry::of(calibration, data).iter().take(WORST) {
        let held_out = if outlier.set == OutlierSet::HeldOut { " (held out)" } else { "" };
        let _ = writeln!(
            out,
            "{:14}{:>12}{:>12}{:>9.3}  {}:{}{held_out}",
            "",
            number(outlier.residual_mm),
            outlier.residual_deg.map_or_else(|| "-".to_owned(), number),
            outlier.weight,
            visible(&outlier.file),
            outlier.row
        );
    }
    out.push('\n');
    out
}
