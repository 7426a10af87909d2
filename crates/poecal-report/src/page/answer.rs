//! The first screen: one answer in one colour, errors before and after, and the domain in which it holds; the robot; points of attention. The words
//! are those of the terminal.

use maud::{Markup, html};

use super::advice::{sentence_markup, told_words};
use super::certificate::{limits_table, record_markup, title_of};
use super::html::{figure, list, quote_text};
use super::joints;
use super::leading_error::spaced_unit;
use crate::summary::{
    LeadingRows, ModelRow, PointSource, ReviewPoint, SEE_ROBUST, expected_summary, judged_on, look_at, reasons,
    why_larger,
};
use crate::table::joints_words;
use poecal_calibrate::{Decision, Event, Level};
use poecal_numerics::unit::Unit;
use poecal_results::calibration_file::CalibrationFile;
use poecal_results::shapes::Shapes;

pub(crate) fn screen(file: &CalibrationFile, shapes: &Shapes) -> Markup {
    html! {
        header {
            h1 { "Calibration of " (quote_text(&file.robot.name, "robot.name")) }
            p.made { (kinds(file)) " · made by poecal " (quote_text(&file.poecal_version, "poecal_version")) }
            div.theme hidden role="group" aria-label="Colours" {}
        }
        (record_markup(&file.record))
        (answer(file))
        (joints::view(file, shapes))
        (look(file))
        (contents(file))
    }
}

/// Number of joints of each kind, and the ends of the chain.
fn kinds(file: &CalibrationFile) -> Markup {
    html! {
        (joints_words(file.joints.iter().map(|joint| joint.kind))) " joints, from " (quote_text(&file.robot.base_link, "robot.base_link"))
        " to " (quote_text(&file.robot.tip_link, "robot.tip_link"))
    }
}

fn answer(file: &CalibrationFile) -> Markup {
    let (class, title) = colour(file);
    html! {
        section class={ "verdict " (class) } aria-labelledby="verdict-title" {
            h2 #verdict-title { span.sign aria-hidden="true" {} (title) }
            (before_after(file))
            div.holds { (holds(file)) }
            @if let Some(text) = file.verdict.as_ref().and_then(|it| it.confirmed.as_ref()) {
                p.note { "Confirmed: " (sentence_markup(text, "verdict.confirmed")) "." }
            }
            @if let Some(found) = &file.acceptance { (limits_table(found)) }
        }
    }
}

/// The one colour and its title: of the limits if some were set, unless the calibration is not to be used at all.
fn colour(file: &CalibrationFile) -> (&'static str, String) {
    let level = file.verdict.as_ref().map(|verdict| verdict.level);
    match (&file.acceptance, level) {
        (Some(found), level) if level != Some(Level::DoNotUse) || found.decision == Decision::Fail => {
            (found.decision.word(), title_of(found).to_owned())
        }
        (_, Some(level)) => (level.word(), format!("Verdict: {}", level.words())),
        (_, None) => ("unknown", "No verdict: the calibration was written by an earlier version".to_owned()),
    }
}

/// The errors before and after on the same rows, and the expected error, all RMS and in one unit.
fn before_after(file: &CalibrationFile) -> Markup {
    let leading = LeadingRows::from_calibration(file);
    let (Some([before, after]), set) = (leading.ends(), leading.set) else { return Markup::default() };
    let has_length = set.calibrated.leading_value().is_some_and(|(quantity, _)| quantity.unit() == Unit::Metre);
    let measured = |(_, model, key): &ModelRow<'_>| {
        if let Some(pixels) = model.of_pictures(set.count) {
            return html! { (figure(pixels.rms_mm, format_args!("{key}.pixels.rms_mm"))) " mm" };
        }
        let leading = model.leading_value();
        html! { @if let Some((quantity, error)) = leading {
            (figure(error.rms, format_args!("{key}.{}.rms", quantity.key()))) (spaced_unit(quantity.unit()))
        } }
    };
    let on = judged_on(file);
    let corners = if set.calibrated.of_pictures(set.count).is_some() { ", at the board" } else { "" };
    html! {
        ol.steps {
            li { b { (measured(before)) } " " span { "before, on " (on) ": " (before.0) (corners) } }
            li { b { (measured(after)) } " " span { "after, on " (on) ": " (after.0) " model" (corners) } }
            @if let Some(found) = expected_summary(file).filter(|_| has_length) {
                li {
                    b { (figure(found.error_mm, "verdict.expected_error_mm")) " mm" } " "
                    span { "expected near measured configurations; 95\u{a0}% below " (figure(found.bound_mm, "verdict.bound95_mm")) "\u{a0}mm" }
                }
                @if let Some(inside) = found.inside_mm {
                    li {
                        b { (figure(inside, "verdict.sampled_range_error_mm")) " mm" } " "
                        span {
                            "expected anywhere inside the sampled range"
                            @if let Some(nominal) = found.nominal_mm { " (your model: " (figure(nominal, "verdict.nominal_error_mm")) "\u{a0}mm)" }
                        }
                    }
                }
            }
        }
        @if let Some(why) = why_larger(file) { p.note { (why) } }
    }
}

/// The domain in which it holds, in a sentence.
fn holds(file: &CalibrationFile) -> Markup {
    let first = reasons(file).into_iter().next();
    let why = html! { @if let Some(text) = &first { ": " (reason(file, text)) } };
    match file.verdict.as_ref().map(|verdict| verdict.level) {
        Some(Level::Good) => html! {
            "It holds " b { "anywhere within the limits" } " of the joints"
            @if let Some((sigma, key)) = expected_summary(file).and_then(|it| it.anywhere) { ", with " (figure(sigma, key)) " mm (RMS) expected there" }
            "."
        },
        Some(Level::InsideSampledRange) => {
            html! { "It holds " b { "inside the sampled range" } ", not beyond" (why) "." }
        }
        Some(Level::MeasuredConfigurations) => {
            html! { "It holds " b { "in configurations like those measured" } ", not in others" (why) "." }
        }
        Some(Level::Located) => {
            html! { "It holds " b { "for the positions of targets and devices" } (why) "." }
        }
        Some(Level::DoNotUse) => html! { "It holds " b { "nowhere" } (why) "." },
        None => html! { "Calibrate again to see where it holds." },
    }
}

/// A reason of the verdict, with its key if it is one of the file's own sentences.
fn reason(file: &CalibrationFile, text: &str) -> Markup {
    let stated = file.verdict.as_ref().map_or(&[][..], |verdict| &verdict.reasons);
    match stated.iter().position(|own| own == text) {
        Some(k) => sentence_markup(text, format_args!("verdict.reasons.{k}")),
        None => told_words(text),
    }
}

/// Repairs, and points of attention.
fn look(file: &CalibrationFile) -> Markup {
    let points: Vec<Markup> = look_at(file).iter().filter_map(|point| point_words(file, point)).collect();
    html! {
        @if !file.repairs.is_empty() {
            section.doubts aria-labelledby="repaired-title" { h2 #repaired-title { "Repaired" } (list(&repair_sentences(file))) }
        }
        @if !points.is_empty() {
            section.doubts aria-labelledby="doubts-title" { h2 #doubts-title { "Look at" } (list(&points)) }
        }
    }
}

/// Repairs in words, with their gain.
fn repair_sentences(file: &CalibrationFile) -> Vec<Markup> {
    let one = |(k, found): (usize, &Event)| {
        let key = |name: &str| format!("repairs.{k}.{name}");
        let gain = found.error_before_mm.zip(found.error_after_mm);
        html! {
            (sentence_markup(&found.statement, key("statement")))
            @if let Some((before, after)) = gain {
                "; cross-validation " (figure(after, key("error_after_mm"))) " mm (RMS) instead of " (figure(before, key("error_before_mm")))
            }
        }
    };
    file.repairs.iter().enumerate().map(one).collect()
}

/// A point of attention with the keys of its quotations.
fn point_words(file: &CalibrationFile, point: &ReviewPoint) -> Option<Markup> {
    match point.place {
        PointSource::Reason => Some(reason(file, &point.text)),
        PointSource::Suspicion(k) => Some(sentence_markup(&point.text, format_args!("suspicions.{k}.statement"))),
        PointSource::Diagnosis(k) => Some(sentence_markup(&point.text, format_args!("diagnosis.{k}.statement"))),
        PointSource::Warning(k) => Some(sentence_markup(&point.text, format_args!("warnings.{k}"))),
        PointSource::Suspects => Some(html! { a href="#suspects" { (point.text.replace(SEE_ROBUST, "")) } }),
        PointSource::Joint(k) => {
            let joint = file.corrections.get(k)?;
            let words = quote_text(joint.suspicious.as_deref()?, format_args!("corrections.{k}.suspicious"));
            Some(html! { (quote_text(&joint.joint, format_args!("corrections.{k}.joint"))) ": " (words) })
        }
        PointSource::HardlyKnown => Some(told_words(&point.text)),
    }
}

fn contents(file: &CalibrationFile) -> Markup {
    let all = [
        (true, "before-after", "Errors"),
        (!file.repairs.is_empty(), "repairs", "Repairs"),
        (true, "joints", "Joints"),
        (file.corrected.is_some(), "corrected", "What the joints do"),
        (file.compensation.is_some(), "compensation", "Corrected programs"),
        (file.pictures.is_some(), "pictures", "Pictures"),
        (true, "errors", "Errors of the rows"),
        (true, "suspects", "Suspected rows"),
        (file.repeatability.is_some(), "repeatability", "Repeatability"),
        (true, "trust", "How far to trust it"),
        (true, "method", "Method and inputs"),
        (true, "metrologist", "For the metrologist"),
    ];
    html! {
        nav aria-label="Contents" {
            @for (_, id, title) in all.into_iter().filter(|(has, ..)| *has) { a href={ "#" (id) } { (title) } " " }
        }
    }
}
