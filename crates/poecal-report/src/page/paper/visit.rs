//! The page of a visit: the robot as it was calibrated and as it is now, signed, on one page of paper.

use maud::{Markup, PreEscaped, html};

use super::super::html::{HtmlTable, code_markup, decimal};
use super::{self as paper, LISTED};
use crate::summary::{LeadingRows, delivered_name, expected_summary, judged_on};
use crate::table::number;
use crate::track::TrackReport;
use crate::track_entries::{SightEntry, sampled_range};
use poecal_model::measurement::Quantity;
use poecal_model::robot::JointKind;
use poecal_numerics::text::escape_invisible;
use poecal_results::calibration_file::CalibrationFile;
use poecal_results::output::PagePieces;
use poecal_results::record::Record;

/// Joints that are listed at most.
const MOST_JOINTS: usize = 12;
/// Letters of a sentence that are printed at most.
const LONGEST: usize = 320;
/// Smaller than a certificate, since it has two tables.
const STYLE: &str = "
.visit { font-size: .72rem; line-height: 1.25; }
.visit h1 { font-size: 1.5rem; }
.visit h2 { margin: .5rem 0 .15rem; }
.visit .hands span { min-height: 3.2rem; }
";
/// Entries on the robot and its cell; a missing one is a blank line to write on.
const STATED: [(&str, &str); 8] = [
    ("certificate", "Certificate"),
    ("customer", "Customer"),
    ("robot", "Robot"),
    ("serial", "Serial number"),
    ("tool", "Tool"),
    ("payload", "Payload"),
    ("place", "Place"),
    ("laboratory", "Laboratory"),
];
/// Entries on both sessions.
const SESSION: [(&str, &str); 5] = [
    ("date", "Date"),
    ("operator", "Measured by"),
    ("instrument", "Instrument"),
    ("instrument_calibrated", "Instrument calibration"),
    ("temperature", "Temperature"),
];

/// The page of a visit, complete in itself and without a script; it prints on one page of A4. `time` is when it is made, `2026-11-29T…`: its day is
/// that of a visit whose record states none.
///
/// ```
/// use poecal_calibrate::{CalibrationOptions, calibrate};
/// use poecal_results::calibration_file::{CalibrationFile, Inputs};
/// use poecal_model::simulate::{SessionKind, Simulation, elbow};
/// use poecal_results::track::{TrackOptions, track};
/// use poecal_results::validation::ValidationInputs;
/// let made = Simulation { count: 60, ..Simulation::default() }.run(&elbow(), SessionKind::POINT)?;
/// let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
/// let found = track(&file, &made.data, None, &TrackOptions::default())?;
/// let told = poecal_report::TrackReport::new(&found, &file.robot.name, ValidationInputs::default());
/// let page = poecal_report::visit_page(&told, &file, Some("2026-11-29T10:20:30Z")).concat();
/// assert!(page.contains("unchanged within") && page.contains("2026-11-29"));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[must_use]
pub fn visit_page(told: &TrackReport, file: &CalibrationFile, time: Option<&str>) -> PagePieces {
    let day = time.and_then(|time| time.split('T').next());
    let title = format!("Visit of {}", file.robot.name);
    // Entries on the robot are the calibration's, those on the day are the visit's own.
    let robot = file.record.clone().override_with(&told.record);
    let instead = |key: &str| (key == "robot").then(|| file.robot.name.clone());
    let sheet = html! {
        style { (PreEscaped(paper::STYLE)) (PreEscaped(STYLE)) }
        section.attested.visit aria-label="Visit" {
            div.top { h1 { "Check of a calibrated robot" } }
            (paper::record_entries(&robot, &STATED, instead))
            h2 { "Result" }
            p.found { b { (told.state_words()) } "by " (told.judged_words()) }
            (then_and_now(told, file, day))
            h2 { "Joints" }
            (joints(told, file))
            h2 { "To do" }
            p { (code_markup(&told.to_do())) }
            @for note in told.notes.iter().take(LISTED) { p { "Note: " (code_markup(&shorten_sentence(note))) } }
            h2 { "Files, SHA-256" }
            (paper::files(std::iter::once(&told.inputs.calibration).chain(&told.inputs.measurements), &told.inputs.sha256))
            @if let Some(note) = &told.record.note { p { (shorten_sentence(note)) } }
            (paper::hands("Checked by"))
        }
    };
    paper::page(&title, told.poecal_version, &sheet)
}

/// The calibration beside the visit.
fn then_and_now(told: &TrackReport, file: &CalibrationFile, day: Option<&str>) -> Markup {
    let mut table = HtmlTable::new("The robot when it was calibrated, and in this visit", 3, &["", "then", "now"]);
    let text =
        |record: &Record, key: &str| record.entries().into_iter().find(|it| it.0 == key).map(|it| it.2.to_owned());
    for (key, label) in SESSION {
        let today = day.filter(|_| key == "date").map(str::to_owned);
        let now = text(&told.record, key).or(today);
        table.cells([label.to_owned(), text(&file.record, key).unwrap_or_default(), now.unwrap_or_default()]);
    }
    let leading = LeadingRows::from_calibration(file);
    let (set, then) = (leading.set, leading.models.last());
    let then = then.and_then(|(_, model, _)| model.get(Quantity::Position));
    let then = then.map(|it| format!("{} mm (RMS), on {} {}", number(it.rms), set.count, judged_on(file)));
    let now = format!("{} mm (RMS), on {} rows", number(told.error_mm), told.rows);
    table.cells([format!("Error of the {} model", delivered_name(file)), then.unwrap_or_else(|| "–".to_owned()), now]);
    if let Some(found) = expected_summary(file) {
        let words = format!("{} mm (RMS), 95 % below {} mm", number(found.error_mm), number(found.bound_mm));
        table.cells(["Expected error".to_owned(), words, String::new()]);
    }
    let left = told.left_words().unwrap_or_default();
    let change = format!("{:.3} mm (RMS){left}; noise {:.3} mm a coordinate", told.change_mm, told.noise_mm);
    table.cells(["Change of measured places".to_owned(), "–".to_owned(), change]);
    let level = file.verdict.as_ref().map_or("not judged", |it| it.level.words());
    table.cells(["Level".to_owned(), level.to_owned(), told.level_words(level)]);
    table.cells(["Measuring device".to_owned(), "–".to_owned(), told.device_words().to_owned()]);
    table.cells(["Tool".to_owned(), "–".to_owned(), told.tool_words().to_owned()]);
    html! { (table) }
}

/// Each joint with its measured ranges, and the shift of its zero.
fn joints(told: &TrackReport, file: &CalibrationFile) -> Markup {
    let heads = ["joint", "measured then", "measured now", "smallest visible shift (95 %)", "shift of its zero"];
    let mut table = HtmlTable::new("Measured ranges, and shifts of zeros since the calibration", 1, &heads);
    for joint in told.joints.iter().take(MOST_JOINTS) {
        let then = file.coverage.iter().find(|it| it.joint == joint.joint);
        let slides = file.joints.iter().any(|it| it.name == joint.joint && it.kind == JointKind::Prismatic);
        let then = then.map(|it| range(sampled_range(it, slides), joint.unit));
        let now = joint.sampled.map(|it| range(it, joint.unit));
        let none = || "–".to_owned();
        table.cells([
            escape_invisible(&joint.joint).into_owned(),
            then.unwrap_or_else(none),
            now.unwrap_or_else(none),
            joint.smallest.map_or_else(|| "not visible".to_owned(), |it| format!("{it:.3} {}", joint.unit)),
            shift_words(joint).unwrap_or_else(none),
        ]);
    }
    let more = told.joints.len().saturating_sub(MOST_JOINTS);
    html! {
        (table)
        p {
            "Shift ± standard deviation, beside the result above."
            @if more > 0 { " " (more) " more joints by " code { "poecal track" } "." }
            @for it in told.invisible.iter().take(LISTED) { " " (escape_invisible(&it.joint)) ": " (it.words) "." }
        }
    }
}

fn range([from, to]: [f64; 2], unit: &str) -> String {
    format!("{from:.0} to {to:.0} {unit}").replace('-', "−")
}

/// The shift of a joint's zero as found.
fn shift_words(joint: &SightEntry) -> Option<String> {
    let (shift, sigma) = joint.shift.zip(joint.sigma_shift)?;
    let value = decimal(shift, 3);
    let sign = if shift > 0.0 && value.contains(|c| ('1'..='9').contains(&c)) { "+" } else { "" };
    Some(format!("{sign}{value} ± {} {}", decimal(sigma, 3), joint.unit))
}

/// A sentence, cut where it would take a part of the page.
fn shorten_sentence(text: &str) -> String {
    let mut out: String = text.chars().take(LONGEST).collect();
    if out.len() < text.len() {
        out.push('…');
    }
    out
}
