//! Effect of gross errors on a calibration: a figure, a table and a file.

use crate::{Breakdown, BreakdownEntry};
use poecal_numerics::error::Result;
use poecal_report::plot::{AxisScale, LinePlot, PlotAxis, PlotLine};
use poecal_report::table::row;

/// Widths of the shares and of each loss.
const WIDTHS: [usize; 2] = [7, 17];
/// The losses in the order of the figure.
const ORDER: [&str; 4] = ["off", "huber", "cauchy", "tukey"];

/// The files of a breakdown, each a name and a text: the figure, and every number of it.
///
/// # Errors
/// [`ErrorKind::Export`](poecal_numerics::error::ErrorKind::Export) if a number cannot be written.
pub fn breakdown_files(found: &Breakdown) -> Result<Vec<(String, String)>> {
    let line = |(style, word): (usize, &&str)| PlotLine {
        name: (*word).to_owned(),
        style,
        points: entries(found, word).map(|entry| [f64::from(entry.share_percent), entry.error_ratio_median]).collect(),
    };
    let plot = LinePlot {
        title: "Held-out error by share of gross errors".to_owned(),
        description: format!(
            "Median over {} sessions of the held-out error, as a multiple of that without gross errors, by their share of \
             the rows: least squares (off) and the three losses.",
            found.sessions
        ),
        x: PlotAxis::new("gross errors, % of the rows", AxisScale::Linear).with_values(&[0.0, 50.0]),
        y: PlotAxis::new("held-out error, times that without gross errors", AxisScale::Log).with_values(&[1.0]),
        lines: ORDER.iter().enumerate().map(line).collect(),
        mark: None,
    };
    Ok(vec![("figure-breakdown.svg".to_owned(), plot.svg()), ("results.json".to_owned(), poecal_report::json(found)?)])
}

/// The table of a breakdown, in 80 columns.
#[must_use]
pub fn breakdown_table(found: &Breakdown) -> String {
    let mut out = format!(
        "held-out error by share of gross errors, times that without them\n\
         (median and 95 % of {} sessions of {} rows; seed {})\n\n",
        found.sessions, found.rows, found.seed
    );
    row(&mut out, "  share", WIDTHS, ORDER);
    for entry in entries(found, ORDER[0]) {
        let share = entry.share_percent;
        let cells = ORDER.map(|word| {
            let cell = entries(found, word).find(|entry| entry.share_percent == share);
            cell.map_or_else(String::new, |entry| {
                format!("{:.2} {:.2}", entry.error_ratio_median, entry.error_ratio_p95)
            })
        });
        row(&mut out, &format!("{share:>5} %"), WIDTHS, cells);
    }
    out
}

fn entries<'a>(found: &'a Breakdown, word: &str) -> impl Iterator<Item = &'a BreakdownEntry> {
    found.entries.iter().filter(move |entry| entry.robust == word)
}
