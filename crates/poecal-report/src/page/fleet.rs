//! The page of a line of robots.

use maud::{Markup, PreEscaped, html};

use super::head;
use super::html::{HtmlTable, decimal, plots, section};
use crate::fleet::{FleetLine, key, step_words};
use crate::plot::{AxisScale, LinePlot, PlotAxis, PlotLine};
use poecal_numerics::text::visible_markup;
use poecal_plan::fleet::{FigureSeries, Interval, moving_average};
use poecal_results::output::PagePieces;
use poecal_results::record::Record;

/// Robots that tables list at most.
const LISTED: usize = 50;
/// Robots that a picture draws at most.
const DRAWN: usize = 200;

/// The page of a line, complete in itself and without a script.
#[must_use]
pub fn fleet_page(line: &FleetLine) -> PagePieces {
    let head = head("A line of robots", &Record::default(), env!("CARGO_PKG_VERSION"));
    let rate = |passed: usize, all: usize| if all == 0 { 0.0 } else { 100.0 * passed as f64 / all as f64 };
    let (robots, passed) = (line.rows.len(), line.first_passed);
    let body = html! {
        a.skip href="#main" { "Skip to the figures" }
        main #main {
            header {
                h1 { "A line of robots" }
                p.made { (robots) " robots and dates · made by poecal " (env!("CARGO_PKG_VERSION")) }
            }
            (section("rate", "First-pass rate", &html! {
                p { (format!("{passed} of {} robots passed at their first measurement ({:.1} %).", line.first, rate(passed, line.first))) }
                @if line.is_few { p { "With fewer than 30 robots no spread, no capability and no step is stated." } }
            }))
            @if let Some(prior) = &line.prior {
                (section("prior", "Prior of the line", &html! { p { (prior.words()) "." } }))
            }
            (failed_table(line))
            (outlying_table(line))
            (steps(line))
            (spreads(line))
            (pictures(line))
            (robots_table(line))
        }
    };
    vec![visible_markup(head).into(), visible_markup(body).into(), "\n</body>\n</html>\n".into()]
}

fn failed_table(line: &FleetLine) -> Markup {
    let all: Vec<_> = line.rows.iter().filter(|row| !row.is_passed()).collect();
    let mut table = HtmlTable::new("Robots that did not pass, and why", 4, &["serial", "date", "verdict", "because"]);
    for row in all.iter().take(LISTED) {
        let because = row.reason.as_deref().unwrap_or_default();
        let because = html! { @for (k, piece) in because.split('`').enumerate() { @if k % 2 == 1 { code { (piece) } } @else { (piece) } } };
        table.row(&[&row.serial, &unbroken_text(&row.date), &verdict(row.verdict.as_deref()), &sentence(&because)]);
    }
    let more = (all.len() > LISTED).then(|| all.len() - LISTED);
    let content = html! { (table) @if let Some(more) = more { p { "… and " (more) " more in fleet.csv" } } };
    if all.is_empty() { Markup::default() } else { section("failed", "Robots that did not pass", &content) }
}

/// A name or date that is not broken.
fn unbroken_text(text: &str) -> Markup {
    html! { span style="white-space:nowrap" { (text) } }
}

/// Words of a cell that are broken where the page is narrow.
fn sentence(words: &Markup) -> Markup {
    html! { div style="white-space:normal;overflow-wrap:anywhere;min-width:14em" { (words) } }
}

fn verdict(word: Option<&str>) -> String {
    word.unwrap_or("refused").replace('_', " ")
}

fn outlying_table(line: &FleetLine) -> Markup {
    if line.outliers.is_empty() {
        return Markup::default();
    }
    // A robot has one row, with the figure of its largest deviation first.
    let mut robots: Vec<(&str, Vec<String>)> = Vec::new();
    for it in &line.outliers {
        let words = format!("{} {:.1}", it.series, it.spreads);
        match robots.iter_mut().find(|robot| robot.0 == it.serial) {
            Some(robot) => robot.1.push(words),
            None => robots.push((&it.serial, vec![words])),
        }
    }
    let mut table = HtmlTable::new(
        "Figures beyond six spreads of the line, each with its distance in spreads",
        2,
        &["robot", "figures"],
    );
    for (serial, figures) in robots.iter().take(LISTED) {
        let row = line.rows.iter().find(|row| key(row) == *serial);
        let link = row.map_or_else(
            || unbroken_text(serial),
            |row| html! { a href={ (row.results) "/report.html" } { (unbroken_text(serial)) } },
        );
        table.row(&[&link, &sentence(&html! { (figures.join(", ")) })]);
    }
    section("outliers", "Robots beyond six spreads of the line", &html! { (table) })
}

fn steps(line: &FleetLine) -> Markup {
    let content = html! {
        ul {
            @for (step, is_station) in &line.steps {
                li {
                    (step_words(step))
                    @if *is_station { ": in the reference arm or in most figures at once, so it is the station's" }
                }
            }
        }
    };
    if line.steps.is_empty() { Markup::default() } else { section("steps", "Steps of the line", &content) }
}

fn spreads(line: &FleetLine) -> Markup {
    if line.figures.is_empty() {
        return Markup::default();
    }
    let has_limits = line.figures.iter().any(|it| it.capability.is_some());
    let names = ["figure", "unit", "robots", "median", "seen", "the line's own", "Cp", "Cpk"];
    let names = if has_limits { &names[..] } else { &names[..6] };
    let mut table = HtmlTable::new("Each figure of the line", 2, names);
    for it in &line.figures {
        let capability = it.capability.as_ref();
        let cells = [
            it.name.clone(),
            it.unit.to_owned(),
            it.spread.count.to_string(),
            decimal(it.spread.center, 4),
            decimal(it.spread.seen, 4),
            decimal(it.spread.own, 4),
            interval(capability.and_then(|it| it.cp)),
            interval(capability.map(|it| it.cpk)),
        ];
        table.cells(cells.into_iter().take(names.len()));
    }
    let content = html! {
        p { "Standard deviation as it is seen, and freed of the measurement's share by the deviations that the calibrations state." }
        (table)
    };
    section("spreads", "Spread of the line", &content)
}

fn interval(of: Option<Interval>) -> String {
    of.map_or_else(String::new, |it| format!("{:.2} ({:.2} to {:.2})", it.value, it.low, it.high))
}

/// Figures of the robots in the order of measurement: errors, noise, offsets, and common effects of joints.
fn pictures(line: &FleetLine) -> Markup {
    let is_drawn = |it: &&FigureSeries| (it.joint.is_none() || it.name.ends_with(".offset")) && it.values.len() > 1;
    let all: Vec<Markup> = line.series.iter().filter(is_drawn).map(picture).collect();
    if all.is_empty() {
        return Markup::default();
    }
    let caption = "Each robot's figure in the order measured, and the moving average by which steps are found.";
    section("figures", "Figures over the robots", &plots(&all, caption))
}

fn picture(series: &FigureSeries) -> Markup {
    let values: Vec<f64> = series.values.iter().map(|it| it.value).collect();
    let step = values.len().div_ceil(DRAWN).max(1);
    let points = |values: Vec<f64>| {
        let all = values.into_iter().enumerate().step_by(step);
        all.map(|(at, value)| [at as f64 + 1.0, value]).collect::<Vec<_>>()
    };
    let average = moving_average(&values);
    let lowest: &[f64] = if series.is_size { &[0.0] } else { &[] };
    let plot = LinePlot {
        title: series.name.clone(),
        description: format!("{} of each robot in the order measured, {}", series.name, series.unit),
        x: PlotAxis::new("robot, in the order measured", AxisScale::Count),
        y: PlotAxis::new(&format!("{}, {}", series.name, series.unit), AxisScale::Linear).with_values(lowest),
        lines: vec![
            PlotLine { name: "robot".to_owned(), style: 0, points: points(values) },
            PlotLine { name: "moving average".to_owned(), style: 1, points: points(average) },
        ],
        mark: None,
    };
    PreEscaped(plot.draw_scattered())
}

fn robots_table(line: &FleetLine) -> Markup {
    let names = ["serial", "date", "verdict", "report", "error (RMS), mm", "noise, mm"];
    let mut table = HtmlTable::new("All robots", 4, &names);
    for row in &line.rows {
        let figure = |value: Option<f64>| value.map_or_else(String::new, |it| decimal(it, 4));
        let report = html! { @if row.verdict.is_some() { a href={ (row.results) "/report.html" } { "report" } } };
        table.row(&[
            &row.serial,
            &unbroken_text(&row.date),
            &verdict(row.verdict.as_deref()),
            &report,
            &figure(row.error_rms),
            &figure(row.noise),
        ]);
    }
    section("robots", "Robots", &html! { (table) })
}
