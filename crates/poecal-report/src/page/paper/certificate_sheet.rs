//! The certificate: one page of paper that says who, what, the result, its limits, and how far to trust it.

use std::fmt::Write as _;

use maud::{Markup, PreEscaped, html};

use super::{self as paper, BEFORE, LISTED};
use crate::acceptance::format_limit;
use crate::summary::{LeadingRows, delivered_name, expected_summary, judged_on, why_larger};
use crate::table::number;
use poecal_calibrate::{Acceptance, AcceptedLimit, DeviceFrameKnowledge, Level};
use poecal_fit::analysis::JointCoverage;
use poecal_model::measurement::Quantity;
use poecal_model::robot::JointKind;
use poecal_numerics::unit::Unit;
use poecal_results::calibration_file::{CalibrationFile, JointEntry};
use poecal_results::output::PagePieces;
use poecal_results::record::Record;

/// Joints whose ranges are listed at most.
const MOST_JOINTS: usize = 12;
/// Coverage factor of the expanded uncertainty.
const COVERAGE: f64 = 2.0;
/// Entries of a certificate, in the order of its table; a missing one is a blank line to write on.
const STATED: [(&str, &str); 14] = [
    ("certificate", "Certificate"),
    ("laboratory", "Laboratory"),
    ("customer", "Customer"),
    ("robot", "Robot"),
    ("serial", "Serial number"),
    ("tool", "Tool"),
    ("payload", "Payload"),
    ("instrument", "Instrument"),
    ("instrument_calibrated", "Instrument calibration"),
    ("date", "Date"),
    ("place", "Place"),
    ("temperature", "Temperature"),
    ("operator", "Measured by"),
    ("valid_until", "Valid until"),
];

/// Parts of a certificate beside the calibration.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CertificateExtras {
    /// SHA-256 of the calibration's file, if it is known.
    pub sha256: Option<String>,
    /// A picture for its head: its media type and its bytes.
    pub logo: Option<(&'static str, Vec<u8>)>,
}

/// A certificate of a calibration as a page that is complete in itself, without a script; it prints on one page of A4.
#[must_use]
pub fn certificate_page(file: &CalibrationFile, record: &Record, attest: &CertificateExtras) -> PagePieces {
    let title = format!("Calibration certificate of {}", file.robot.name);
    let sheet = sheet(file, record, attest, &html! { h1 { "Calibration certificate" } });
    paper::page(&title, &file.poecal_version, &sheet)
}

/// The certificate as the first page of a report's print.
pub(crate) fn first_page(file: &CalibrationFile) -> Markup {
    html! {
        style { (PreEscaped(BEFORE)) }
        (sheet(file, &file.record, &CertificateExtras::default(), &html! { p.title { b { "Calibration certificate" } } }))
    }
}

fn sheet(file: &CalibrationFile, record: &Record, attest: &CertificateExtras, title: &Markup) -> Markup {
    let robot = |key: &str| (key == "robot").then(|| file.robot.name.clone());
    html! {
        style { (PreEscaped(paper::STYLE)) }
        section.attested aria-label="Certificate" {
            div.top {
                (title)
                @if let Some((kind, bytes)) = &attest.logo { img src=(data_uri(kind, bytes)) alt="Logo"; }
            }
            (paper::record_entries(record, &STATED, robot))
            h2 { "Result" }
            (result(file))
            @if let Some(found) = &file.acceptance { (limits(found)) }
            h2 { "Where it is valid" }
            p { (validity_sentence(file)) }
            p { (ranges(file)) }
            @for found in file.suspicions.iter().take(LISTED) { p { "Not explained: " (found.statement) } }
            h2 { "Method" }
            p { (method(file)) }
            h2 { "Files, SHA-256" }
            @if let Some(hash) = &attest.sha256 { p { "calibration.json " code { (hash) } } }
            (paper::files(std::iter::once(&file.inputs.model).chain(&file.inputs.measurements), &file.inputs.sha256))
            @if let Some(note) = &record.note { p { (note) } }
            (paper::hands("Calibrated by"))
        }
    }
}

/// Errors before and after, and the uncertainty.
fn result(file: &CalibrationFile) -> Markup {
    let LeadingRows { set, models, without, .. } = LeadingRows::from_calibration(file);
    let lead = set.calibrated.leading_value().map(|(quantity, _)| quantity);
    let unit = match lead.map(Quantity::unit) {
        Some(Unit::Radian) => "°",
        Some(Unit::One | Unit::Second) => "",
        Some(Unit::Metre) | None => " mm",
    };
    let of = |key: &str| {
        let model = models.iter().find(|(.., path)| path.ends_with(key))?.1;
        lead.and_then(|quantity| model.get(quantity)).map(|it| it.rms)
    };
    let after = of(delivered_name(file));
    let on = judged_on(file);
    let count = if file.accuracy.held_out.is_some() {
        format!("{} rows held out of the fit", set.count)
    } else {
        format!("the {} fitted rows{without}, since none was held out", set.count)
    };
    let name = lead.map_or("position", Quantity::name);
    html! {
        div.result {
            @if let Some(before) = of("registered") { div { b { (number(before)) (unit) } "before, on " (on) ": nominal axes, tool and device located" } }
            @if let Some(after) = after { div { b { (number(after)) (unit) } "after, on " (on) ": the " (delivered_name(file)) " model" } }
            @if let Some(found) = expected_summary(file) {
                div { b { (number(found.error_mm)) " mm" } "expected of predictions (RMS), 95 % below " (number(found.bound_mm)) " mm" }
                div { b { (number(COVERAGE * found.error_mm / 3f64.sqrt())) " mm" } "expanded uncertainty of a coordinate, k = 2" }
            }
        }
        p {
            "Before and after: measured " (name) " errors (RMS) on " (count) ". Expected: the RMS error of predicted tip positions in the configurations measured, by the uncertainty of the fit and "
            "the error of the model. Expanded uncertainty of a coordinate: k = 2 times expected / √3. Errors that all measurements share, such as the \
             instrument's scale, are not included."
            @if let Some(why) = why_larger(file) { " " (why) }
        }
    }
}

fn limits(found: &Acceptance) -> Markup {
    html! {
        table {
            thead { tr { th { "Limit" } th { "found" } th { "one-sided 95 % bounds" } th { "decision" } } }
            tbody {
                @for limit in found.limits.iter().take(LISTED) {
                    tr {
                        td { (limit.quantity) " " (limit.statistic.words()) " at most " (format_limit(limit.limit)) " " (limit.unit) }
                        td { (number(limit.found)) " " (limit.unit) }
                        td { (describe_bounds(limit)) }
                        td { b { (limit.decision.words()) } }
                    }
                }
            }
        }
        @if found.limits.len() > LISTED { p { "and " (found.limits.len() - LISTED) " more in the report" } }
    }
}

/// The bounds of what a limit is for; a lower one of zero says nothing.
fn describe_bounds(limit: &AcceptedLimit) -> String {
    let unit = &limit.unit;
    match limit.to {
        Some(to) if limit.from > 0.0 => format!("{} to {} {unit}", number(limit.from), number(to)),
        Some(to) => format!("at most {} {unit}", number(to)),
        None if limit.from > 0.0 => format!("{} to not shown", number(limit.from)),
        None => "not shown".to_owned(),
    }
}

fn validity_sentence(file: &CalibrationFile) -> &'static str {
    match file.verdict.as_ref().map(|verdict| verdict.level) {
        Some(Level::Good) => "Anywhere within the limits of the joints.",
        Some(Level::InsideSampledRange) => "Inside the range of the joints that was measured, and not beyond it.",
        Some(Level::MeasuredConfigurations) => "In configurations like those that were measured, and in no others.",
        Some(Level::Located) => "For the positions of targets and devices: the axes of the joints were held.",
        Some(Level::DoNotUse) => "Nowhere: this calibration is not to be used (see the report).",
        None => "Not judged: the calibration was written by an earlier version.",
    }
}

/// The measured range of each joint, and the error to expect inside it.
fn ranges(file: &CalibrationFile) -> String {
    let range = |(joint, found): (&JointEntry, &JointCoverage)| {
        let (factor, unit) = match joint.kind {
            JointKind::Revolute => (1f64.to_degrees(), "°"),
            JointKind::Prismatic => (1e3, " mm"),
        };
        format!("{} {:.0} to {:.0}{unit}", joint.name, factor * found.sampled_min, factor * found.sampled_max)
    };
    let all: Vec<String> = file.joints.iter().zip(&file.coverage).take(MOST_JOINTS).map(range).collect();
    let more = if file.coverage.len() > MOST_JOINTS { " …" } else { "" };
    let inside = expected_summary(file)
        .and_then(|it| it.inside_mm)
        .map(|it| format!(" Expected anywhere inside these ranges: {} mm (RMS).", number(it)));
    format!("Measured ranges: {}{more}.{}", all.join(", "), inside.unwrap_or_default())
}

fn method(file: &CalibrationFile) -> String {
    let terms = if delivered_name(file) == "corrected" { ", and what the joints do beyond geometry" } else { "" };
    let place = match file.frame() {
        DeviceFrameKnowledge::Unknown => "the device's place is fitted too",
        DeviceFrameKnowledge::Base => "the device measures in the robot's base",
    };
    format!(
        "Product of exponentials: joint axes, tool{terms} fitted to {} rows by least squares; {place}. Errors are those of held-out rows where there \
         are any; limits are decided with 95 % confidence. Made by poecal {}.",
        file.accuracy.training.count, file.poecal_version
    )
}

/// Bytes as the address of a picture.
fn data_uri(kind: &str, bytes: &[u8]) -> String {
    let mut out = format!("data:{kind},");
    for byte in bytes {
        // Writing to a String cannot fail.
        let _ = write!(out, "%{byte:02X}");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_calibrate::{CalibrationOptions, calibrate};
    use poecal_model::simulate::{SessionKind, Simulation, elbow};
    use poecal_results::calibration_file::Inputs;

    #[test]
    fn what_is_missing_is_a_blank_line_and_what_is_stated_is_text() {
        let made = Simulation::default().run(&elbow(), SessionKind::POINT).unwrap();
        let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default()).unwrap();
        let file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
        let record = Record::from_pairs([("serial", "<b>4711</b>"), ("valid_until", "2027-11-28")]).unwrap();
        let attest = CertificateExtras { sha256: Some("ab".repeat(32)), logo: Some(("image/png", vec![0x89, 0x50])) };
        let page = certificate_page(&file, &record, &attest).concat();
        for words in
            ["&lt;b&gt;4711&lt;/b&gt;", "2027-11-28", "data:image/png,%89%50", "<dt>Customer</dt><dd></dd>", "k = 2"]
        {
            assert!(page.contains(words), "{words}");
        }
        assert!(!page.contains("<script"));
    }
}
