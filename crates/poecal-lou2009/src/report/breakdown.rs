//! What gross errors do to a calibration: a figure, a table and a file.

use std::fmt::Write as _;

use crate::{Breakdown, BreakdownEntry};
use poecal::error::Result;
use poecal::report::plot::{Axis, Line, LinePlot, Scale};

/// The losses in the order of the figure.
const ORDER: [&str; 4] = ["off", "huber", "cauchy", "tukey"];

/// The files of a breakdown, each a name and a text: the figure, and every number of it.
///
/// # Errors
/// [`ErrorKind::Export`](poecal::ErrorKind::Export) if a number cannot be written.
pub fn breakdown_files(found: &Breakdown) -> Result<Vec<(String, String)>> {
    let line = |(style, word): (usize, &&str)| Line {
        name: (*word).to_owned(),
        style,
        points: entries(found, word)
            .map(|entry| [f64::from(entry.share_percent), entry.error_ratio_median])
            .collect(),
    };
    let plot = LinePlot {
        title: "Held-out error by share of gross errors".to_owned(),
        description: format!(
            "Median over {} sessions of the held-out error, as a multiple of that without gross errors, by their share of \
             the rows: least squares (off) and the three losses.",
            found.sessions
        ),
        x: Axis::new("gross errors, % of the rows", Scale::Linear).including(&[0.0, 50.0]),
        y: Axis::new("held-out error, times that without gross errors", Scale::Log).including(&[1.0]),
        lines: ORDER.iter().enumerate().map(line).collect(),
        mark: None,
    };
    Ok(vec![
        ("figure-breakdown.svg".to_owned(), plot.svg()),
        ("results.json".to_owned(), poecal::report::json(found)?),
    ])
}

/// The table of a breakdown, in 80 columns.
#[must_use]
pub fn breakdown_table(found: &Breakdown) -> String {
    let mut out = format!(
        "held-out error by share of gross errors, times that without them\n\
         (median and 95 % of {} sessions of {} rows; seed {})\n\n  share",
        found.sessions, found.rows, found.seed
    );
    // Writing to a String cannot fail.
    for word in ORDER {
        let _ = write!(out, "{word:>17}");
    }
    out.push('\n');
    for entry in entries(found, ORDER[0]) {
        let share = entry.share_percent;
        let _ = write!(out, "{share:>5} %");
        for word in ORDER {
            let cell = entries(found, word).find(|entry| entry.share_percent == share);
            let cell = cell.map_or_else(String::new, |entry| {
                format!("{:.2} {:.2}", entry.error_ratio_median, entry.error_ratio_p95)
            });
            let _ = write!(out, "{cell:>17}");
        }
        out.push('\n');
    }
    out
}

fn entries<'a>(found: &'a Breakdown, word: &str) -> impl Iterator<Item = &'a BreakdownEntry> {
    found.entries.iter().filter(move |entry| entry.robust == word)
}
