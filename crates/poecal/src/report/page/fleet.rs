//! The page of a line of robots.

use maud::{Markup, PreEscaped, html};

use super::head;
use crate::io::output::Page;
use crate::io::record::Record;
use crate::report::fleet::Line;
use crate::report::plot::{Axis, Line as PlotLine, LinePlot, Scale};
use crate::text::visible_markup;

/// Robots that tables list at most.
const LISTED: usize = 50;
/// Robots that a picture draws at most.
const DRAWN: usize = 400;

/// The page of a line, complete in itself and without a script.
#[must_use]
pub fn fleet_page(line: &Line) -> Page {
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
            section {
                h2 { "First-pass rate" }
                p { (format!("{passed} of {} robots passed at their first measurement ({:.1} %).", line.first, rate(passed, line.first))) }
                @if line.is_few { p { "With fewer than 30 robots no spread, no capability and no step is stated." } }
            }
            @if let Some(prior) = &line.prior {
                section { h2 { "Prior of the line" } p { (prior.words()) "." } }
            }
            (failed(line))
            (outlying(line))
            (steps(line))
            (spreads(line))
            (pictures(line))
            (robots_table(line))
        }
    };
    vec![visible_markup(head).into(), visible_markup(body).into(), "\n</body>\n</html>\n".into()]
}

fn failed(line: &Line) -> Markup {
    let all: Vec<_> = line.rows.iter().filter(|row| !row.is_passed()).collect();
    html! {
        @if !all.is_empty() {
            section {
                h2 { "Robots that did not pass" }
                table {
                    thead { tr { th { "serial" } th { "date" } th { "verdict" } th { "because" } } }
                    tbody {
                        @for row in all.iter().take(LISTED) {
                            tr {
                                td { (row.serial) } td { (row.date) } td { (row.verdict.as_deref().unwrap_or("refused")) }
                                td { (row.reason.as_deref().unwrap_or_default()) }
                            }
                        }
                    }
                }
                @if all.len() > LISTED { p { "… and " (all.len() - LISTED) " more in fleet.csv" } }
            }
        }
    }
}

fn outlying(line: &Line) -> Markup {
    html! {
        @if !line.outliers.is_empty() {
            section {
                h2 { "Robots beyond six spreads of the line" }
                table {
                    thead { tr { th { "serial" } th { "figure" } th { "joint" } th { "spreads" } } }
                    tbody {
                        @for it in line.outliers.iter().take(LISTED) {
                            tr { td { (it.serial) } td { (it.series) } td { (it.joint.as_deref().unwrap_or("")) } td { (format!("{:.1}", it.spreads)) } }
                        }
                    }
                }
            }
        }
    }
}

fn steps(line: &Line) -> Markup {
    html! {
        @if !line.steps.is_empty() {
            section {
                h2 { "Steps of the line" }
                ul {
                    @for (step, is_station) in &line.steps {
                        li {
                            (step.series) " since " (step.since) " by " (format!("{:+.4}", step.size))
                            @if *is_station { ": in the reference arm or in all figures at once, so it is the station's" }
                        }
                    }
                }
            }
        }
    }
}

fn spreads(line: &Line) -> Markup {
    html! {
        @if !line.figures.is_empty() {
            section {
                h2 { "Spread of the line" }
                p { "Standard deviation as it is seen, and freed of the measurement's share by the deviations that the calibrations state." }
                table {
                    thead { tr { th { "figure" } th { "unit" } th { "robots" } th { "median" } th { "seen" } th { "the line's own" } th { "Cp" } th { "Cpk" } } }
                    tbody {
                        @for it in &line.figures {
                            tr {
                                td { (it.name) } td { (it.unit) } td { (it.spread.count) }
                                td { (format!("{:.4}", it.spread.center)) } td { (format!("{:.4}", it.spread.seen)) } td { (format!("{:.4}", it.spread.own)) }
                                td { (interval(it.capability.as_ref().and_then(|c| c.cp))) } td { (interval(it.capability.as_ref().map(|c| c.cpk))) }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn interval(of: Option<crate::fleet::Interval>) -> String {
    of.map_or_else(String::new, |it| format!("{:.2} ({:.2} to {:.2})", it.value, it.low, it.high))
}

/// The errors of the robots, in the order measured.
fn pictures(line: &Line) -> Markup {
    let errors: Vec<f64> = line.rows.iter().filter_map(|row| row.error_rms).collect();
    if errors.len() < 2 {
        return html! {};
    }
    let step = errors.len().div_ceil(DRAWN).max(1);
    let points = errors.iter().enumerate().step_by(step).map(|(at, value)| [at as f64 + 1.0, *value]);
    let plot = LinePlot {
        title: "Error of each robot".to_owned(),
        description: "Error (RMS) of each robot in the order measured, millimetres".to_owned(),
        x: Axis::new("robot, in the order measured", Scale::Linear),
        y: Axis::new("error (RMS), mm", Scale::Linear).including(&[0.0]),
        lines: vec![PlotLine { name: "error".to_owned(), style: 0, points: points.collect() }],
        mark: None,
    };
    html! { section { h2 { "Errors" } (PreEscaped(plot.svg())) } }
}

fn robots_table(line: &Line) -> Markup {
    html! {
        section {
            h2 { "Robots" }
            table {
                thead { tr { th { "serial" } th { "date" } th { "verdict" } th { "error (RMS)" } th { "noise" } th { "report" } } }
                tbody {
                    @for row in &line.rows {
                        tr {
                            td { (row.serial) } td { (row.date) } td { (row.verdict.as_deref().unwrap_or("refused")) }
                            td { (row.error_rms.map_or_else(String::new, |it| format!("{it:.4}"))) }
                            td { (row.noise.map_or_else(String::new, |it| format!("{it:.4}"))) }
                            td { @if row.verdict.is_some() { a href={ (row.results) "/report.html" } { "report" } } }
                        }
                    }
                }
            }
        }
    }
}
