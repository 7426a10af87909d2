//! The certificate of a test of ISO 9283: one page of paper.

use maud::{Markup, PreEscaped, html};

use super::super::html::HtmlTable;
use super::super::tested::{self, clusters};
use super::{self as paper, BEFORE, LISTED};
use crate::iso9283::{FURTHER, FigureValue, frame_words, groups};
use poecal_calibrate::Iso9283;
use poecal_results::iso9283::TestResult;
use poecal_results::output::PagePieces;

/// Smaller than a certificate of a calibration, since it has pictures.
const STYLE: &str = "
.tested { font-size: .72rem; line-height: 1.25; }
.tested h1, .tested .title { font-size: 1.5rem; }
.tested h2 { margin: .4rem 0 .15rem; }
.tested figure { margin: 0; }
.tested .plots { grid-template-columns: 1fr 1fr; gap: 0 1.4rem; }
.tested .plots svg { width: 100%; height: auto; max-height: 14rem; }
.tested figcaption { font-size: .7rem; margin: 0; }
.tested td, .tested th { font-size: .72rem; }
.tested .pair { display: grid; grid-template-columns: 2fr 3fr; gap: 0 1.4rem; align-items: start; margin: .4rem 0; }
.tested .hands span { min-height: 3rem; }
";
/// Entries in the order of the certificate: after clause 9 of the standard, the conditions of the test.
const STATED: [(&str, &str); 16] = [
    ("certificate", "Certificate"),
    ("laboratory", "Laboratory"),
    ("customer", "Customer"),
    ("robot", "Robot"),
    ("serial", "Serial number"),
    ("tool", "Tool"),
    ("payload", "Payload"),
    ("speed", "Speed"),
    ("warm_up", "Warm-up"),
    ("temperature", "Temperature"),
    ("instrument", "Instrument"),
    ("instrument_calibrated", "Instrument calibration"),
    ("date", "Date"),
    ("place", "Place"),
    ("operator", "Measured by"),
    ("valid_until", "Valid until"),
];

/// A certificate of a test as a page that is complete in itself, without a script; it prints on one page of A4. `before` is the test before, if there was
/// one.
#[must_use]
pub fn test_certificate_page(test: &TestResult, found: &Iso9283, before: Option<&Iso9283>) -> PagePieces {
    let sheet = sheet(test, found, before, &html! { h1 { "Test certificate, ISO 9283" } });
    paper::page(&tested::title(test), test.poecal_version, &sheet)
}

/// The certificate as the first page of a report's print.
pub(crate) fn first_page(test: &TestResult, found: &Iso9283, before: Option<&Iso9283>) -> Markup {
    html! {
        style { (PreEscaped(BEFORE)) }
        (sheet(test, found, before, &html! { p.title { b { "Test certificate, ISO 9283" } } }))
    }
}

fn sheet(test: &TestResult, found: &Iso9283, before: Option<&Iso9283>, title: &Markup) -> Markup {
    let names = std::iter::once(&test.inputs.calibration).chain(&test.inputs.measurements).chain(&test.reference);
    html! {
        style { (PreEscaped(paper::STYLE)) (PreEscaped(STYLE)) }
        section.attested.tested aria-label="Certificate" {
            div.top { (title) }
            (paper::record_entries(&test.record, &STATED, |_| None))
            h2 { "Result" }
            (largest(test))
            div.pair {
                div { @if !test.limits.is_empty() { (limits(test)) } }
                (tested::by_pose(test))
            }
            (clusters::cube(found, before))
            h2 { "Method" }
            p { (method(test)) }
            @for warning in test.warnings.iter().take(LISTED) { p { "Note: " (warning) "." } }
            h2 { "Files, SHA-256" }
            (paper::files(names, &test.inputs.sha256))
            @if let Some(note) = &test.record.note { p { (note) } }
            (paper::hands("Tested by"))
        }
    }
}

fn limits(test: &TestResult) -> Markup {
    let mut table = HtmlTable::new("Limits", 1, &["Limit of", "at most", "decision"]);
    for (k, limit) in test.limits.iter().take(LISTED).enumerate() {
        let [name, decision, most, ..] = tested::limit_cells(limit, &format!("limits.{k}"));
        table.cells([name, most, decision]);
    }
    html! { (table) }
}

/// The largest figure of each name, and further values beside it.
fn largest(test: &TestResult) -> Markup {
    let groups = groups(test);
    let has = |value: FigureValue| groups.iter().any(|group| group.largest(value).is_some());
    let further: Vec<_> = FURTHER.iter().filter(|it| has(it.3)).collect();
    let heads = ["", "largest", "95\u{a0}% interval", "pose"].into_iter().chain(further.iter().map(|it| it.1));
    let mut table = HtmlTable::new("The largest figure of all poses", 1, &heads.collect::<Vec<_>>());
    for group in &groups {
        let mut cells = tested::largest_cells(group, tested::name(group), "", |it| Some(it.measured));
        cells.extend(further.iter().map(|(.., key, value)| {
            let own = tested::largest_cells(group, Markup::default(), &format!(".{key}"), *value).into_iter().nth(1);
            own.unwrap_or_else(|| html! { "–" })
        }));
        table.cells(cells);
    }
    html! { (table) }
}

fn method(test: &TestResult) -> String {
    let noise = test.noise_mm.map_or_else(String::new, |it| {
        format!(" Noise of the instrument: {} in each coordinate, standard deviation.", tested::with_unit(it, "mm"))
    });
    format!(
        "Pose characteristics after ISO 9283:1998 of {} cycles, {} rows. Frame: {}.{noise} Intervals (95 %) are those of the scatter of cycles; errors that all \
         measurements share, such as the instrument's scale, are in AP and AD and in no interval. Made by poecal {}.",
        test.cycles,
        test.rows,
        frame_words(test),
        test.poecal_version
    )
}
