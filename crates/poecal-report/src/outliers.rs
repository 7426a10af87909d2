//! The suspected rows in a calibration's table.

use std::fmt::Write as _;

use super::table::{INDENT, line, number_or_dash};
use poecal_model::measurement::Quantity;
use poecal_numerics::text::escape_invisible;
use poecal_results::calibration_file::{CalibrationFile, OutlierSet};

/// Rows that are named.
const WORST: usize = 5;

/// Number of suspected rows, the worst of them, and the loss of the fit; empty without suspected rows and loss.
pub(crate) fn describe_suspects(out: &mut String, file: &CalibrationFile) {
    let robust = &file.robust;
    let fit = match robust.loss {
        Some(loss) => format!("fitted by the {} loss", loss.word()),
        None => "fitted by least squares".to_owned(),
    };
    let count = robust.suspected.training + robust.suspected.held_out;
    if count == 0 {
        if robust.loss.is_some() {
            line(out, "outliers", &format!("none suspected; {fit}"));
            out.push('\n');
        }
        return;
    }
    let rows = if count == 1 { "row" } else { "rows" };
    let sets = format!("{} fitted, {} held out", robust.suspected.training, robust.suspected.held_out);
    line(out, "outliers", &format!("{count} {rows} suspected ({sets}); {fit}"));
    // Writing to a String cannot fail.
    let worst = || file.outliers.iter().take(WORST);
    let measured: Vec<Quantity> = Quantity::ALL
        .into_iter()
        .filter(|quantity| worst().any(|outlier| outlier.residual.get(*quantity).is_some()))
        .collect();
    let head = |quantity: &Quantity| format!("{}, {}", quantity.name(), quantity.unit().symbol());
    let head: Vec<String> = measured.iter().map(head).collect();
    cells(out, "off by", &head);
    let _ = writeln!(out, "{:>9}  file:line", "weight");
    for outlier in worst() {
        let held_out = if outlier.set == OutlierSet::HeldOut { " (held out)" } else { "" };
        let off_by = |quantity: &Quantity| number_or_dash(outlier.residual.get(*quantity));
        cells(out, "", &measured.iter().map(off_by).collect::<Vec<_>>());
        let (weight, place) = (outlier.weight, escape_invisible(&outlier.file));
        let _ = writeln!(out, "{weight:>9.3}  {place}:{}{held_out}", outlier.row);
    }
    out.push('\n');
}

/// A label and the first cells of a row.
fn cells(out: &mut String, label: &str, cells: &[String]) {
    // Writing to a String cannot fail.
    let _ = write!(out, "{label:<INDENT$}");
    for cell in cells {
        let _ = write!(out, "{cell:>15}");
    }
}
