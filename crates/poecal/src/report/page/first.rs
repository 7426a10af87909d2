//! The first screen: verdict, what to look at, errors on rows that were not fitted, one picture; the same words as on the terminal.

use maud::{Markup, Render, html};

use super::advice::told;
use super::certificate::{limits, stated};
use super::corners;
use super::devices::devices;
use super::figures;
use super::html::{HtmlTable, count, facts, figure, figure_or, list, path, plots, quoted};
use super::lead::{kinds_words, sign, spaced};
use super::trust::direction_words;
use crate::analysis::Direction;
use crate::calibration::{Event, Improvements, Level, ModelAccuracy, NoiseSource, SetAccuracy};
use crate::io::calibration_file::CalibrationFile;
use crate::io::residuals::Residuals;
use crate::measurement::{Device, Quantity};
use crate::report::found::found_words;
use crate::report::summary::{
    ModelRow, Place, Point, SEE_ROBUST, delivered, expected, has_terms, leading, look_at,
};
use crate::report::table::{STATISTICS, further_words, joints_words, models};
use crate::unit::Unit;

/// A quantity's errors as a caption: `Position error on …, mm`.
pub(super) fn error_words(quantity: Quantity, of: &str) -> String {
    let unit = match quantity.unit() {
        Unit::Metre => ", mm",
        Unit::Radian => ", degrees",
        Unit::One | Unit::Second => "",
    };
    let of = if of.is_empty() { String::new() } else { format!(" {of}") };
    capital(&format!("{} error{of}{unit}", quantity.name()))
}

/// Words with a capital letter.
pub(super) fn capital(words: &str) -> String {
    let (first, rest) = words.split_at(words.len().min(1));
    format!("{}{rest}", first.to_uppercase())
}

pub(super) fn screen(file: &CalibrationFile, residuals: &Residuals) -> Markup {
    let held_out = file.accuracy.held_out.as_ref();
    let (of, key) = match held_out {
        Some(_) => ("rows held out", "accuracy.held_out.count"),
        None => ("the fitted rows, since none was held out", "accuracy.training.count"),
    };
    let (set, mut rows) = leading(file);
    rows.retain(|(.., key)| key.starts_with("accuracy"));
    let rest = without_suspected(file, &rows);
    let on = format!("on {of}");
    let tables = set.calibrated.iter().flat_map(|(quantity, _)| {
        let words = error_words(quantity, &on);
        let all = lead_table(&words, &rows, quantity, set.improvement.as_ref());
        let rest = rest.as_ref().map(|(suspected, rows)| {
            lead_table(&format!("{words}, without {suspected} suspected"), rows, quantity, None)
        });
        std::iter::once(all).chain(rest)
    });
    let tables: Vec<HtmlTable> = corners::table(&rows, &on).into_iter().chain(tables).collect();
    let caption = html! { (count(set.count, key)) " " (of) ". Registered: your model, with only tool and device located." };
    html! {
        header {
            h1 { "Calibration of " (quoted(&file.robot.name, "robot.name")) }
            p.made { (kinds(file)) " · made by poecal " (quoted(&file.poecal_version, "poecal_version")) }
            div.theme hidden role="group" aria-label="Colours" {}
        }
        (stated(&file.record))
        @if let Some(found) = &file.acceptance { (limits(found)) }
        (verdict(file))
        div.first {
            div {
                (corners::before_after(set, &rows, &on).unwrap_or_else(|| before_after(set, &rows, &on)))
                @for table in &tables { (table) }
                @if corners::are_all(set) {
                    p.note {
                        "Position and rotation are those of the pose that fits the corners of a picture, which is uncertain along the ray: the corners "
                        "judge."
                    }
                }
                @if let (None, Some(found)) = (held_out, &file.cross_validation) {
                    @if let Some((quantity, key, rms)) = found.random.rms.leading_key() {
                        p.note {
                            "Cross-validation: " (figure(rms, format_args!("cross_validation.random.{key}"))) " " (sign(quantity.unit()))
                            " (RMS) on rows that were not fitted."
                        }
                    }
                }
                p.note {
                    b { "Before" } ": your model, with only tool and device located. " b { "After" } ": the joint axes are corrected too. "
                    @if has_terms(file) { b { "Corrected" } ": with them what the joints do beyond geometry. " }
                    "The gain of the calibration is the difference."
                }
                (facts(&the_facts(file, residuals)))
            }
            (plots(&[figures::distributions(file, residuals)], caption))
        }
        (contents(file))
    }
}

/// The mean error of each model, from before the calibration to after it.
fn before_after(set: &SetAccuracy, rows: &[ModelRow<'_>], on: &str) -> Markup {
    let Some((quantity, _)) = set.calibrated.leading() else { return Markup::default() };
    let steps = rows.iter().filter_map(|(name, model, key)| {
        let mean = figure(model.get(quantity)?.mean, format_args!("{key}.{}.mean", quantity.key()));
        Some(html! { li { b { (mean) (spaced(quantity.unit())) } " " span { (name) } } })
    });
    let steps: Vec<Markup> = steps.collect();
    html! {
        p.steps-title { "Mean " (quantity.name()) " error " (on) }
        ol.steps { @for step in &steps { (step) } }
    }
}

/// The same models without the suspected rows, and how many these are; nothing without suspected rows.
fn without_suspected<'a>(
    file: &'a CalibrationFile,
    rows: &[ModelRow<'a>],
) -> Option<(usize, Vec<ModelRow<'a>>)> {
    let robust = &file.robust;
    let (set, suspected, key) = match file.accuracy.held_out {
        Some(_) => (&robust.held_out_without_suspected, robust.suspected_held_out, "held_out"),
        None => (&robust.training_without_suspected, robust.suspected_fit, "training"),
    };
    let set = set.as_ref()?;
    let own = rows.iter().filter_map(|(name, _, path)| {
        let word = path.rsplit('.').next()?;
        let (_, model) = models(set).into_iter().find(|(own, _)| *own == word)?;
        Some((name.clone(), model(set)?, format!("robust.{key}_without_suspected.{word}")))
    });
    Some((suspected, own.collect()))
}

/// Errors before and after, of the rows held out or, if there are none, of those fitted; of the former also how many times smaller they are.
fn lead_table(
    caption: &str,
    rows: &[ModelRow<'_>],
    quantity: Quantity,
    gain: Option<&Improvements>,
) -> HtmlTable {
    let heads = ["", "mean", "RMS", "95 %", "max", "smaller by"];
    let mut table = HtmlTable::new(caption, 1, &heads[..if gain.is_some() { 6 } else { 5 }]);
    for (name, model, key) in rows {
        let cells = STATISTICS.map(|(_, statistic, value)| {
            figure_or(
                model.get(quantity).map(value),
                format_args!("{key}.{}.{statistic}", quantity.key()),
                "",
            )
        });
        let gain = gain.map(|gain| smaller(gain, key, quantity));
        table.cells(std::iter::once(name.render()).chain(cells).chain(gain));
    }
    table
}

/// How many times smaller the errors of a model are than the registered model's, with the interval.
fn smaller(gain: &Improvements, key: &str, quantity: Quantity) -> Markup {
    let word = key.rsplit('.').next().unwrap_or_default();
    let of = match word {
        "calibrated" => gain.calibrated.get(quantity),
        "corrected" => gain.corrected.as_ref().and_then(|it| it.get(quantity)),
        _ => None,
    };
    let Some(found) = of else { return Markup::default() };
    let key = |name: &str| format!("accuracy.held_out.improvement.{word}.{}.{name}", quantity.key());
    html! {
        "× " (factor(found.factor, &key("factor"))) small { "(" (factor(found.from, &key("from"))) " to " (factor(found.to, &key("to"))) ")" }
    }
}

/// A factor with two or three digits.
fn factor(value: f64, key: &str) -> Markup {
    let decimals = if value < 10.0 { 1 } else { 0 };
    html! { span data-key=(key) { (format!("{value:.decimals$}")) } }
}

/// How many joints of which kind, and from where to where.
fn kinds(file: &CalibrationFile) -> Markup {
    html! {
        (joints_words(file.joints.iter().map(|joint| joint.kind))) " joints, from " (quoted(&file.robot.base_link, "robot.base_link"))
        " to " (quoted(&file.robot.tip_link, "robot.tip_link"))
    }
}

fn verdict(file: &CalibrationFile) -> Markup {
    let (class, words, reasons) = match &file.verdict {
        Some(verdict) => (verdict.level.word(), verdict_words(verdict.level), verdict.reasons.as_slice()),
        None => ("unknown", "No verdict: the calibration was written by an earlier version", [].as_slice()),
    };
    // What speaks for the best verdict is what the expected error says.
    let is_good = file.verdict.as_ref().is_some_and(|verdict| verdict.level == Level::Good);
    let reasons = reasons.iter().enumerate().filter(|_| !is_good);
    let reasons: Vec<Markup> =
        reasons.map(|(k, reason)| told(reason, format_args!("verdict.reasons.{k}"))).collect();
    let points: Vec<Markup> = look_at(file).iter().filter_map(|point| point_words(file, point)).collect();
    html! {
        section class={ "verdict " (class) } aria-labelledby="verdict-title" {
            h2 #verdict-title { span.sign aria-hidden="true" {} (words) }
            @if let Some(found) = expected(file) {
                p {
                    "Expected error of the " (delivered(file)) " model: "
                    (figure(found.error_mm, "verdict.expected_error_mm")) " mm (RMS), 95 % below "
                    (figure(found.bound_mm, "verdict.bound95_mm")) " mm"
                    @if let Some((sigma, key)) = found.anywhere { "; " (figure(sigma, key)) " mm (RMS) anywhere within the limits" }
                    "."
                }
            }
            (list(&reasons))
        }
        @if !file.repairs.is_empty() {
            section.doubts aria-labelledby="repaired-title" { h2 #repaired-title { "Repaired" } (list(&repaired(file))) }
        }
        @if !points.is_empty() {
            section.doubts aria-labelledby="doubts-title" { h2 #doubts-title { "Look at" } (list(&points)) }
        }
    }
}

/// What was repaired, in words, with what that gains.
fn repaired(file: &CalibrationFile) -> Vec<Markup> {
    let one = |(k, found): (usize, &Event)| {
        let key = |name: &str| format!("repairs.{k}.{name}");
        let gain = found.error_before_mm.zip(found.error_after_mm);
        html! {
            (told(&found.statement, key("statement")))
            @if let Some((before, after)) = gain {
                "; cross-validation " (figure(after, key("error_after_mm"))) " mm (RMS) instead of " (figure(before, key("error_before_mm")))
            }
        }
    };
    file.repairs.iter().enumerate().map(one).collect()
}

/// A point with the keys of what it quotes; nothing of reasons, which stand above.
fn point_words(file: &CalibrationFile, point: &Point) -> Option<Markup> {
    let direction = |degree: &str, list: &[Direction], name: &str, k: usize| {
        let words = direction_words(list.get(k)?, &format!("identifiability.{name}.{k}"));
        Some(html! { (degree) ": " (words) })
    };
    let known = &file.identifiability;
    match point.place {
        Place::Reason => None,
        Place::Suspicion(k) => Some(told(&point.text, format_args!("suspicions.{k}.statement"))),
        Place::Diagnosis(k) => Some(told(&point.text, format_args!("diagnosis.{k}.statement"))),
        Place::Warning(k) => Some(told(&point.text, format_args!("warnings.{k}"))),
        Place::Suspects => Some(html! { a href="#suspects" { (point.text.replace(SEE_ROBUST, "")) } }),
        Place::Joint(k) => {
            let joint = file.corrections.get(k)?;
            let words = quoted(joint.suspicious.as_deref()?, format_args!("corrections.{k}.suspicious"));
            Some(html! { (quoted(&joint.joint, format_args!("corrections.{k}.joint"))) ": " (words) })
        }
        Place::Open(k) => direction("undetermined", &known.unidentifiable, "unidentifiable", k),
        Place::Weak(k) => direction("weakly determined", &known.weak, "weak", k),
    }
}

fn verdict_words(level: Level) -> &'static str {
    match level {
        Level::Good => "Good to use anywhere within the limits",
        Level::InsideSampledRange => "Use it inside the sampled range only",
        Level::DoNotUse => "Do not use this calibration",
    }
}

/// Errors of the models of a set.
pub(super) fn error_table(caption: &str, set: &SetAccuracy, key: &str, quantity: Quantity) -> HtmlTable {
    let models: Vec<_> = models(set).iter().map(|(name, model)| (*name, model(set))).collect();
    models_table(caption, &models, &format!("{key}."), quantity)
}

/// Errors of some models, by the statistics of each.
pub(super) fn models_table(
    caption: &str,
    models: &[(&str, Option<&ModelAccuracy>)],
    key: &str,
    quantity: Quantity,
) -> HtmlTable {
    let heads: Vec<&str> = std::iter::once("").chain(models.iter().map(|(name, _)| *name)).collect();
    let mut table = HtmlTable::new(caption, 1, &heads);
    for (label, statistic, value) in STATISTICS {
        let cells = models.iter().map(|(name, model)| {
            let found = model.and_then(|model| model.get(quantity)).map(value);
            figure_or(found, format_args!("{key}{name}.{}.{statistic}", quantity.key()), "")
        });
        table.cells(std::iter::once(label.render()).chain(cells));
    }
    table
}

fn the_facts(file: &CalibrationFile, residuals: &Residuals) -> Vec<(&'static str, Markup)> {
    let files = html! {
        @for (k, name) in file.inputs.measurements.iter().enumerate() {
            @if k > 0 { br; } (path(name, format_args!("inputs.measurements.{k}")))
        }
    };
    let rows = html! {
        (kinds_words(residuals)) @if devices(file) == [Device::Pair] { " between two configurations" } @if residuals.targets.len() > 1 { " of " (residuals.targets.len()) " targets" } ": "
        (count(file.accuracy.training.count, "accuracy.training.count")) " fitted, "
        @if let Some(set) = &file.accuracy.held_out { (count(set.count, "accuracy.held_out.count")) } @else { "none" }
        " held out"
    };
    let mut all =
        vec![("Model", path(&file.inputs.model, "inputs.model")), ("Measurements", files), ("Rows", rows)];
    all.extend(corners::fact(file).map(|corners| ("Corners", corners)));
    let found = found_words(file);
    if !found.is_empty() {
        all.push((
            "Found",
            html! { @for (k, words) in found.iter().enumerate() { @if k > 0 { br; } (words) } },
        ));
    }
    all.push(("Noise", noise(file)));
    all
}

fn noise(file: &CalibrationFile) -> Markup {
    let noise = &file.noise;
    let source = match noise.source {
        NoiseSource::Rows => return html! { "as each row states it" },
        NoiseSource::Exact => return html! { "none: the residual is rounding error only" },
        NoiseSource::Given => "as stated",
        NoiseSource::Estimated => "estimated from the fit",
    };
    html! {
        @for (k, (quantity, key, sigma)) in noise.sigma.keys().enumerate() {
            @if k > 0 { ", " }
            (figure(sigma, format_args!("noise.{key}"))) (spaced(quantity.unit())) (further_words(quantity))
        }
        @if noise.sigma.iter().any(|(quantity, _)| quantity.components() > 1) { " each component" }
        ", " (source)
    }
}

fn contents(file: &CalibrationFile) -> Markup {
    let repeated = file.repeatability.as_ref().map(|_| ("repeatability", "Repeatability"));
    let corrected = file.corrected.as_ref().map(|_| ("corrected", "What the joints do"));
    let gain = file.compensation.as_ref().map(|_| ("compensation", "Corrected programs"));
    let repairs = (!file.repairs.is_empty()).then_some(("repairs", "Repairs"));
    let sections =
        repairs.into_iter().chain([("view", "In 3D"), ("joints", "Joints")]).chain(corrected).chain(gain);
    let pictures = file.pictures.as_ref().map(|_| ("pictures", "Pictures"));
    let rows = [("errors", "Errors of the rows"), ("suspects", "Suspected rows")];
    let rows = pictures.into_iter().chain(rows);
    let rest = [("trust", "How far to trust it"), ("told", "Unknowns"), ("method", "Method and inputs")];
    html! {
        nav aria-label="Contents" {
            @for (id, title) in sections.chain(rows).chain(repeated).chain(rest) { a href={ "#" (id) } { (title) } " " }
        }
    }
}
