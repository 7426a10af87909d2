//! The suspected rows in a calibration's table.

use std::fmt::Write as _;

use super::table::{line, number, number_or_dash};
use crate::io::calibration_file::{CalibrationFile, OutlierSet};
use crate::text::visible;

/// Rows that are named.
const WORST: usize = 5;

/// How many rows are suspected, the worst of them, and how the fit was made; nothing if there is nothing to say.
pub(super) fn suspected(out: &mut String, file: &CalibrationFile) {
    let robust = &file.robust;
    let fit = match robust.loss {
        Some(loss) => format!("fitted by the {} loss", loss.word()),
        None => "fitted by least squares".to_owned(),
    };
    let count = robust.suspected_fit + robust.suspected_held_out;
    if count == 0 {
        if robust.loss.is_some() {
            line(out, "outliers", &format!("none suspected; {fit}"));
            out.push('\n');
        }
        return;
    }
    let rows = if count == 1 { "row" } else { "rows" };
    let sets = format!("{} fitted, {} held out", robust.suspected_fit, robust.suspected_held_out);
    line(out, "outliers", &format!("{count} {rows} suspected ({sets}); {fit}"));
    // Writing to a String cannot fail.
    let _ = writeln!(out, "{:14}{:>12}{:>12}{:>9}  file:line", "", "off by, mm", "deg", "weight");
    for outlier in file.outliers.iter().take(WORST) {
        let held_out = if outlier.set == OutlierSet::HeldOut { " (held out)" } else { "" };
        let _ = writeln!(
            out,
            "{:14}{:>12}{:>12}{:>9.3}  {}:{}{held_out}",
            "",
            number(outlier.residual_mm),
            number_or_dash(outlier.residual_deg),
            outlier.weight,
            visible(&outlier.file),
            outlier.row
        );
    }
    out.push('\n');
}
