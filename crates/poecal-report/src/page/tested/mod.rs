//! The page of a test of ISO 9283.

pub(crate) mod clusters;

use maud::{Markup, PreEscaped, html};

use super::html::{HtmlTable, count, facts, figure, list, quote_text, section};
use super::{certificate, head, joins, method, paper};
use crate::acceptance::format_limit;
use crate::iso9283::{FURTHER, FigureGroup, FigureValue, frame_words, groups};
use crate::table::number;
use poecal_calibrate::Iso9283;
use poecal_numerics::text::visible_markup;
use poecal_results::iso9283::{BoundsEntry, FigureEntry, FigureLimitEntry, TestResult};
use poecal_results::output::PagePieces;

/// Labels of further values, below that of their figure.
const FURTHER_STYLE: &str = ".further { display: block; padding-left: 1rem; font-weight: 400; }";

/// The page of a test, complete in itself and without a script; its print begins with the certificate. `before` is the test before, if there was one.
#[must_use]
pub fn test_page(test: &TestResult, found: &Iso9283, before: Option<&Iso9283>) -> PagePieces {
    let title = title(test);
    let head = head(&title, &test.record, test.poecal_version);
    let body = html! {
        a.skip href="#main" { "Skip to the figures" }
        style { (PreEscaped(FURTHER_STYLE)) }
        main #main {
            (paper::first_page_of_test(test, found, before))
            header {
                h1 { (title) }
                p.made { (count(test.rows, "rows")) " measurements · made by poecal " (quote_text(test.poecal_version, "poecal_version")) }
            }
            (certificate::record_markup(&test.record))
            @if let Some(decision) = test.decision { (certificate::decided(decision, test.limits.len(), &limits(test))) }
            (section("figures", "Figures", &html! { (largest(test)) (facts(&conditions(test))) }))
            @if !test.warnings.is_empty() { (doubts(test)) }
            (section("accuracy", "Accuracy", &clusters::cube(found, before)))
            (section("scatter", "Repeatability", &clusters::scatter(found, before)))
            (section("poses", "All figures", &all(test)))
            (inputs(test))
            (signature(test))
        }
    };
    vec![visible_markup(head).into(), visible_markup(body).into(), "\n</body>\n</html>\n".into()]
}

/// Title of a page about a test.
pub(crate) fn title(test: &TestResult) -> String {
    let robot = test.record.robot.as_ref().map_or_else(String::new, |name| format!(" of {name}"));
    format!("Test{robot} by ISO 9283")
}

/// A unit behind a number.
fn behind(unit: &str) -> &'static str {
    if unit == "deg" { "°" } else { " mm" }
}

/// The largest figure of each name with its interval, and further values below it.
fn largest(test: &TestResult) -> Markup {
    let mut table =
        HtmlTable::new("The largest figure of all poses", 1, &["", "largest", "95\u{a0}% interval", "pose"]);
    for group in groups(test) {
        table.cells(largest_cells(&group, name(&group), "", |it| Some(it.measured)));
        for (_, words, key, value) in FURTHER {
            let cells = largest_cells(&group, html! { span.further { (words) } }, &format!(".{key}"), value);
            if !cells.is_empty() {
                table.cells(cells);
            }
        }
    }
    html! { (table) }
}

/// Symbol, words and clause of a figure.
pub(crate) fn name(group: &FigureGroup<'_>) -> Markup {
    html! { b { (group.name.symbol()) } " " (group.name.words()) " (" (group.name.clause()) ")" }
}

/// Label, value, interval and pose of the largest of a value; none if no figure has it.
pub(crate) fn largest_cells(group: &FigureGroup<'_>, label: Markup, key: &str, value: FigureValue) -> Vec<Markup> {
    let Some((at, entry, value)) = group.largest(value) else { return Vec::new() };
    let (key, unit) = (format!("figures.{at}{key}"), behind(entry.unit));
    let found = html! { (figure(value.found, format_args!("{key}.found"))) (unit) };
    vec![label, found, interval(&value, &key, unit), html! { (group.place(entry)) }]
}

/// AP and RP of positions at each pose.
pub(crate) fn by_pose(test: &TestResult) -> Markup {
    let is_of = |it: &FigureEntry, name: &str| it.figure == name && it.unit == "mm";
    let all = || test.figures.iter().enumerate();
    let heads = ["pose", "AP, mm", "95\u{a0}% interval", "RP, mm", "95\u{a0}% interval"];
    let mut table = HtmlTable::new("Accuracy and repeatability of position at each pose", 1, &heads);
    for (_, accuracy) in all().filter(|it| is_of(it.1, "AP")) {
        let mut cells = vec![html! { (accuracy.pose) }];
        for (at, it) in all().filter(|it| it.1.pose == accuracy.pose && (is_of(it.1, "AP") || is_of(it.1, "RP"))) {
            cells.push(figure(it.measured.found, format_args!("figures.{at}.found")));
            cells.push(interval(&it.measured, &format!("figures.{at}"), ""));
        }
        table.cells(cells);
    }
    html! { (table) }
}

fn interval(value: &BoundsEntry, key: &str, unit: &str) -> Markup {
    html! { (figure(value.from, format_args!("{key}.from"))) " to " (figure(value.to, format_args!("{key}.to"))) (unit) }
}

/// Conditions on which the figures depend.
fn conditions(test: &TestResult) -> Vec<(&'static str, Markup)> {
    let mut all = vec![
        (
            "Cycles",
            html! { (count(test.cycles, "cycles")) @if test.cycles < 30 { ", fewer than the 30 of the standard" } },
        ),
        ("Frame", html! { (frame_words(test)) }),
    ];
    all.extend(test.noise_mm.map(|noise| {
        ("Noise", html! { (figure(noise, "noise_mm")) " mm, standard deviation of the instrument in each coordinate" })
    }));
    all
}

/// Each limit with the largest figure.
fn limits(test: &TestResult) -> Markup {
    let mut table =
        HtmlTable::new("Figures and their limits", 1, &["", "decision", "limit", "found", "95\u{a0}% interval"]);
    for (k, limit) in test.limits.iter().enumerate() {
        table.cells(limit_cells(limit, &format!("limits.{k}")));
    }
    html! {
        (table)
        p.note {
            "PASS: the interval of every pose ends within the limit. FAIL: that of one pose begins above it. NOT SHOWN: the limit is between both; measure \
             more cycles."
        }
    }
}

/// Figure, decision, limit, value and interval.
pub(crate) fn limit_cells(limit: &FigureLimitEntry, key: &str) -> [Markup; 5] {
    let unit = behind(limit.unit);
    [
        html! { (limit.figure) },
        html! { b class={ "decision " (limit.decision.word()) } { (limit.decision.words()) } },
        html! { span data-key={ (key) ".limit" } { (format_limit(limit.limit)) } (unit) },
        html! { b { (figure(limit.worst.found, format_args!("{key}.found"))) (unit) } },
        interval(&limit.worst, key, unit),
    ]
}

fn doubts(test: &TestResult) -> Markup {
    let all: Vec<Markup> =
        test.warnings.iter().enumerate().map(|(k, text)| quote_text(text, format_args!("warnings.{k}"))).collect();
    html! { section.doubts aria-labelledby="doubts-title" { h2 #doubts-title { "Look at" } (list(&all)) } }
}

/// All figures of all poses.
fn all(test: &TestResult) -> Markup {
    let further: Vec<_> = FURTHER.iter().filter(|of| test.figures.iter().any(|it| of.3(it).is_some())).collect();
    let heads = ["figure", "pose", "cycles", "found", "from", "to"].into_iter().chain(further.iter().map(|it| it.1));
    let mut table = HtmlTable::new("Figures with their 95\u{a0}% intervals", 2, &heads.collect::<Vec<_>>());
    for (at, it) in test.figures.iter().enumerate() {
        let unit = behind(it.unit);
        let key = |name: &str| format!("figures.{at}.{name}");
        let mut cells = vec![html! { (it.figure) }, html! { (it.pose) }, count(it.cycles, key("cycles"))];
        let own = [(it.measured.found, "found"), (it.measured.from, "from"), (it.measured.to, "to")];
        cells.extend(own.map(|(value, name)| html! { (figure(value, key(name))) (unit) }));
        cells.extend(further.iter().map(|(_, _, name, value)| match value(it) {
            None => html! { "–" },
            Some(value) => html! { (figure(value.found, format_args!("figures.{at}.{name}.found"))) (unit) },
        }));
        table.cells(cells);
    }
    html! { (table) }
}

fn inputs(test: &TestResult) -> Markup {
    let inputs = &test.inputs;
    let own = (!inputs.calibration.is_empty()).then_some((&inputs.calibration, "inputs.calibration", "robot"));
    let content = html! {
        (method::files(own, &[inputs.measurements.as_slice(), &test.reference].concat(), &inputs.sha256, (&inputs.files, &[])))
        (joins::sections(&inputs.joins))
        @if let Some(command) = &inputs.command {
            details { summary { "How to make it again" } pre tabindex="0" { code { (quote_text(command, "inputs.command")) } } }
        }
    };
    section("method", "Inputs", &content)
}

fn signature(test: &TestResult) -> Markup {
    let inputs = &test.inputs;
    let names: Vec<&String> =
        std::iter::once(&inputs.calibration).filter(|it| !it.is_empty()).chain(&inputs.measurements).collect();
    let robot = test.record.robot.as_deref().unwrap_or("–");
    let of = html! { (robot) @if let Some(serial) = &test.record.serial { ", serial number " (serial) } };
    let title = test.decision.map(|it| certificate::decision_title(it, test.limits.len()));
    certificate::hands(("Robot", of), &test.record, title, (&names, &inputs.sha256), ("Tested by", test.poecal_version))
}

/// A length or angle with its unit.
pub(crate) fn with_unit(value: f64, unit: &str) -> String {
    let sign = if value < 0.0 { "−" } else { "" };
    format!("{sign}{}{}", number(value.abs()), behind(unit))
}
