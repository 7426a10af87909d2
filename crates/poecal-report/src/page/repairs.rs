//! Events of the session that were repaired: each with the errors of the rows before and after.

use maud::{Markup, PreEscaped, html};

use super::html::{HtmlTable, count, figure, figure_or, plots, quote_text, section};
use crate::plot::{AxisMark, AxisScale, LinePlot, PlotAxis, PlotLine};
use poecal_calibrate::{Event, EventKind};
use poecal_results::calibration_file::CalibrationFile;

/// Sections of the repairs; empty if there are none.
pub(crate) fn sections(file: &CalibrationFile) -> Markup {
    if file.repairs.is_empty() {
        return Markup::default();
    }
    let mut table = HtmlTable::new(
        "What was repaired",
        2,
        &["what", "from", "row", "mm", "degrees", "cross-validation before", "after"],
    );
    for (k, found) in file.repairs.iter().enumerate() {
        let key = |name: &str| format!("repairs.{k}.{name}");
        let what =
            html! { (words(found.kind)) @if !found.name.is_empty() { " " (quote_text(&found.name, key("name"))) } };
        let cells = [
            what,
            quote_text(&found.from, key("from")),
            count(found.from_row, key("from_row")),
            figure_or(found.size_mm, key("size_mm"), ""),
            figure_or(found.size_deg, key("size_deg"), ""),
            found.error_before_mm.map_or_else(Markup::default, |it| figure(it, key("error_before_mm"))),
            found.error_after_mm.map_or_else(Markup::default, |it| figure(it, key("error_after_mm"))),
        ];
        table.cells(cells);
    }
    let pictures: Vec<Markup> = file.repairs.iter().filter(|it| !it.residuals.is_empty()).map(picture).collect();
    let content = html! {
        p {
            "Something evidently happened during the session. What follows is the calibration of the repaired one, which predicts rows better that are \
             left out. Without the repair: the option " code { "repair" } " off."
        }
        (table)
        (plots(&pictures, "The error of each row by the models before and after the repair, in the order measured."))
    };
    section("repairs", "Repairs", &content)
}

pub(crate) fn words(kind: EventKind) -> &'static str {
    match kind {
        EventKind::Device => "device moved",
        EventKind::Target => "target moved",
        EventKind::Nest => "nest knocked",
        EventKind::Zero => "zero slipped",
        EventKind::Drift => "drift",
        EventKind::Rows => "wrong configurations",
    }
}

fn picture(found: &Event) -> Markup {
    let line = |name: &str, style: usize, at: usize| PlotLine {
        name: name.to_owned(),
        style,
        points: found.residuals.iter().map(|it| [it[0], it[at]]).collect(),
    };
    let is_step = !matches!(found.kind, EventKind::Drift | EventKind::Rows);
    let plot = LinePlot {
        title: format!("{}: errors before and after", words(found.kind)),
        description: "The error of each row by the models before and after the repair; the table has the figures."
            .to_owned(),
        x: PlotAxis::new("row", AxisScale::Count),
        y: PlotAxis::new("error, mm (logarithmic)", AxisScale::Log),
        lines: vec![line("before", 1, 1), line("after", 0, 2)],
        mark: is_step.then(|| AxisMark { at: found.from_row as f64, label: "from here".to_owned() }),
    };
    PreEscaped(plot.svg())
}
