//! The page of a check: validity of a calibration for measurements that it did not use.

use maud::{Markup, PreEscaped, html};

use super::certificate::{self, limits, record_markup};
use super::errors::{error_words, models_table};
use super::html::{HtmlTable, capital, count, facts, figure, list, plots, quote_text, section};
use super::leading_error::{sign, spaced_unit};
use super::{head, joins, method};
use crate::judgement::{before_factor, confirmed_words, judged_models, refitted_parts};
use crate::plot::{AxisScale, LinePlot, PlotAxis, PlotLine};
use poecal_calibrate::Level;
use poecal_model::measurement::Quantity;
use poecal_numerics::text::visible_markup;
use poecal_results::output::PagePieces;
use poecal_results::validation::{HistoryEntry, JudgedRows, Validation, VerdictError};

/// Largest rows that the table lists.
const LISTED: usize = 10;
/// Rows that the picture draws at most.
const DRAWN: usize = 200;

/// The page of a check, complete in itself and without a script. `earlier` are the checks before it, of the same calibration.
///
/// ```
/// use poecal_calibrate::{CalibrationOptions, calibrate};
/// use poecal_results::calibration_file::{CalibrationFile, Inputs};
/// use poecal_results::validation::{JudgedRows, Validation, ValidationInputs};
/// use poecal_model::simulate::{SessionKind, Simulation, elbow};
/// let made = Simulation { count: 60, ..Simulation::default() }.run(&elbow(), SessionKind::POINT)?;
/// let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
/// let judgement = file.judge(&made.data, false, false)?;
/// let found = Validation::new(&file, judgement, ValidationInputs::default());
/// let rows = JudgedRows { data: &made.data, robot: &made.nominal, rows: &found.judgement.rows };
/// let page = poecal_report::validation_page(&found, &rows, &[]).concat();
/// assert!(page.starts_with("<!DOCTYPE html>") && page.contains("The calibration holds"));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[must_use]
pub fn validation_page(found: &Validation, rows: &JudgedRows<'_>, earlier: &[HistoryEntry]) -> PagePieces {
    let title = format!("Check of the calibration of {}", found.robot);
    let head = head(&title, &found.record, found.poecal_version);
    let body = html! {
        a.skip href="#main" { "Skip to the verdict" }
        main #main {
            header {
                h1 { "Check of the calibration of " (quote_text(&found.robot, "robot")) }
                p.made { (count(found.judgement.count, "count")) " measurements · made by poecal " (quote_text(found.poecal_version, "poecal_version")) }
            }
            (record_markup(&found.record))
            @if let Some(acceptance) = &found.judgement.acceptance { (limits(acceptance)) }
            (verdict(found))
            div.first {
                div { (errors(found)) (facts(&the_facts(found))) }
                (plots(&[picture(rows)], "Each row's error beside the bound below which it lies with 95 % probability, in the order read."))
            }
            (largest_errors(rows))
            (checks(found, earlier))
            (inputs(found))
            (signature(found))
        }
    };
    vec![visible_markup(head).into(), visible_markup(body).into(), "\n</body>\n</html>\n".into()]
}

fn verdict(found: &Validation) -> Markup {
    let class = found.verdict.level.map_or("unknown", Level::word);
    let words = capital(confirmed_words(found.verdict.level));
    let reasons = found.verdict.reasons.iter().enumerate();
    let reasons: Vec<Markup> = reasons.map(|(k, text)| quote_text(text, format_args!("verdict.reasons.{k}"))).collect();
    let mut doubts = Vec::new();
    if let Some(moved) = found.judgement.moved_device.filter(|it| it.refitted) {
        doubts.push(html! {
            "The device stands " (figure(moved.shift_mm, "moved_device.shift_mm")) " mm and " (figure(moved.turn_deg, "moved_device.turn_deg"))
            "° from where the calibration has it; its frame was refitted to these measurements"
        });
    }
    let fitted = if found.fitted.is_empty() { None } else { found.warnings().into_iter().next() };
    doubts.extend(fitted.map(|text| html! { (text) }));
    doubts.extend(found.doubt.as_ref().map(|text| quote_text(text, "doubt")));
    html! {
        section class={ "verdict " (class) } aria-labelledby="verdict-title" {
            h2 #verdict-title { span.sign aria-hidden="true" {} (words) }
            @for (quantity, error) in found.verdict.errors.iter() { (one_figure(found, quantity, &error)) }
            (list(&reasons))
        }
        @if !doubts.is_empty() {
            section.doubts aria-labelledby="doubts-title" { h2 #doubts-title { "Look at" } (list(&doubts)) }
        }
    }
}

/// The error of the delivered model beside the expected one.
fn one_figure(found: &Validation, quantity: Quantity, error: &VerdictError) -> Markup {
    let key = |name: &str| format!("verdict.{}.{name}", quantity.key());
    let unit = spaced_unit(quantity.unit());
    html! {
        p {
            "Error of the " (found.verdict.model.word()) " model, " (quantity.name()) ": " (figure(error.rms, key("rms"))) (unit) " (RMS)"
            @if let Some(expected) = error.expected_rms { ", expected " (figure(expected, key("expected_rms"))) (unit) " with measurement noise" }
            @if let Some(share) = error.inside_bound95 {
                "; " span data-key=(key("inside_bound95")) data-factor="100" { (format!("{:.1}", 100.0 * share)) } " % of the errors are inside their 95 % bounds"
            }
            "."
        }
    }
}

fn errors(found: &Validation) -> Markup {
    let own = &found.judgement;
    let models: Vec<_> = judged_models(own).into_iter().map(|(name, model)| (name, Some(model))).collect();
    let tables = own
        .calibrated
        .iter()
        .map(|(quantity, _)| models_table(&error_words(quantity, "on these measurements"), &models, "", quantity));
    html! { @for table in tables { (table) } }
}

fn the_facts(found: &Validation) -> Vec<(&'static str, Markup)> {
    let parts = refitted_parts(&found.judgement);
    let refitted = if parts.is_empty() { "nothing".to_owned() } else { parts + ", to these measurements" };
    let delivered = found.judgement.delivered_model();
    let inside = match delivered.in_sampled_range {
        None => html! { "no row lies inside it" },
        Some(some) => html! { (some.count) " of " (found.judgement.count) " rows lie inside it" },
    };
    let gain = found.judgement.improvement.map(|gain| {
        let key = |name: &str| format!("improvement.{name}");
        html! {
            (before_factor(gain.gain())) "the error of the nominal model is " (figure(gain.factor, key("factor"))) " times this one's ("
            (figure(gain.from, key("from"))) " to " (figure(gain.to, key("to"))) " with 95 % confidence), device frame and targets fitted for both"
        }
    });
    let facts = [("Refitted", html! { (refitted) }), ("Sampled range", inside)];
    facts.into_iter().chain(gain.map(|gain| ("Gain", gain))).collect()
}

/// Quantity of the picture and the list: the first that was measured.
fn leading_quantity(rows: &JudgedRows<'_>) -> Option<Quantity> {
    rows.measured_quantities().into_iter().next()
}

/// Error and bound of a row, as people read them.
fn row_of(rows: &JudgedRows<'_>, k: usize, quantity: Quantity) -> Option<(f64, Option<f64>)> {
    let found = rows.rows.get(k)?.errors.get(quantity)?;
    let shown = |value: f64| quantity.unit().in_shown_unit(value);
    Some((shown(found.length), found.promised.map(|it| shown(it.bound))))
}

fn picture(rows: &JudgedRows<'_>) -> Markup {
    let Some(quantity) = leading_quantity(rows) else { return Markup::default() };
    let step = rows.rows.len().div_ceil(DRAWN).max(1);
    let all = (0..rows.rows.len()).step_by(step);
    let own: Vec<(f64, (f64, Option<f64>))> =
        all.filter_map(|k| Some((k as f64 + 1.0, row_of(rows, k, quantity)?))).collect();
    let line = |name: &str, style: usize, points: Vec<[f64; 2]>| PlotLine { name: name.to_owned(), style, points };
    let errors = own.iter().map(|(k, (error, _))| [*k, *error]).collect();
    let bounds = own.iter().filter_map(|(k, (_, bound))| Some([*k, (*bound)?])).collect();
    let lines = [line("error", 0, errors), line("95 % bound", 2, bounds)];
    let unit = sign(quantity.unit());
    let plot = LinePlot {
        title: format!("The {} error by row", quantity.name()),
        description: "The error of each row and its bound; the table of errors has the figures.".to_owned(),
        x: PlotAxis::new("row", AxisScale::Count),
        y: PlotAxis::new(&format!("{} error, {unit}", quantity.name()), AxisScale::Linear).with_values(&[0.0]),
        lines: lines.into_iter().filter(|line| !line.points.is_empty()).collect(),
        mark: None,
    };
    PreEscaped(plot.svg())
}

/// The rows of the largest errors.
fn largest_errors(rows: &JudgedRows<'_>) -> Markup {
    let Some(quantity) = leading_quantity(rows) else { return Markup::default() };
    let mut all: Vec<(usize, f64, Option<f64>)> = (0..rows.rows.len())
        .filter_map(|k| row_of(rows, k, quantity).map(|(error, bound)| (k, error, bound)))
        .collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all.truncate(LISTED);
    let unit = sign(quantity.unit());
    let has_targets = rows.data.targets.len() > 1;
    let (error, bound) = (format!("error, {unit}"), format!("95 % bound, {unit}"));
    let heads: &[&str] = if has_targets { &["row", "target", &error, &bound] } else { &["row", &error, &bound] };
    let caption = format!("The {} rows of the largest errors", all.len());
    let mut table = HtmlTable::new(&caption, heads.len() - 2, heads);
    for (k, error, bound) in all {
        let observation = rows.data.observations.get(k);
        let name = rows.data.ids.get(k).filter(|id| !id.is_empty()).cloned().unwrap_or_else(|| {
            let source = observation.map(|it| (it.source.file as usize, it.source.line));
            let named = source.and_then(|(file, line)| Some((rows.data.files.get(file)?, line)));
            named.map_or_else(String::new, |(path, line)| format!("{}:{line}", path.display()))
        });
        let target = observation.and_then(|it| rows.data.targets.get(it.target)?.as_deref()).unwrap_or("");
        let shown = |value: f64| crate::table::number(value);
        let target = has_targets.then(|| target.to_owned());
        let numbers = [shown(error), bound.map_or_else(|| "–".to_owned(), shown)];
        table.cells(std::iter::once(name).chain(target).chain(numbers));
    }
    section("largest", "The largest errors", &html! { (table) })
}

/// The checks before this one, and this one.
fn checks(found: &Validation, earlier: &[HistoryEntry]) -> Markup {
    let Some((quantity, own)) = found.verdict.errors.leading_value() else { return Markup::default() };
    if earlier.is_empty() {
        return Markup::default();
    }
    let unit = sign(quantity.unit());
    let heads = ["checked", "verdict", "model", "rows", &format!("error (RMS), {unit}"), &format!("expected, {unit}")];
    let mut table = HtmlTable::new("The checks of this calibration", 3, &heads);
    let mut row = |time: &str, level: Option<Level>, model: &str, count: usize, error: Option<VerdictError>| {
        let shown = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), crate::table::number);
        let words = level.map_or("no bounds to test", Level::words);
        let error = error.unwrap_or_default();
        let (rms, expected) = (shown(Some(error.rms)), shown(error.expected_rms));
        table.cells([time.to_owned(), words.to_owned(), model.to_owned(), count.to_string(), rms, expected]);
    };
    for one in earlier {
        let error = one.verdict.errors.get(quantity);
        row(&one.time, one.verdict.level, one.verdict.model.word(), one.count, error);
    }
    let own_model = found.verdict.model.word();
    row("this one", found.verdict.level, own_model, found.judgement.count, Some(own));
    section("checks", "Checks of this calibration", &html! { (table) })
}

fn inputs(found: &Validation) -> Markup {
    let inputs = &found.inputs;
    let own = (&inputs.calibration, "inputs.calibration", "calibration");
    let table = method::files(Some(own), &inputs.measurements, &inputs.sha256, (&inputs.files, &[]));
    let content = html! {
        (table)
        (joins::sections(&inputs.joins))
        @if let Some(command) = &inputs.command {
            details {
                summary { "How to make it again" }
                pre tabindex="0" { code { (quote_text(command, "inputs.command")) } }
            }
        }
    };
    section("method", "Inputs", &content)
}

fn signature(found: &Validation) -> Markup {
    let names: Vec<&String> = std::iter::once(&found.inputs.calibration).chain(&found.inputs.measurements).collect();
    let of = html! { (found.robot) @if let Some(serial) = &found.record.serial { ", serial number " (serial) } };
    certificate::hands(
        ("Robot", of),
        &found.record,
        found.judgement.acceptance.as_ref().map(certificate::title_of),
        (&names, &found.inputs.sha256),
        ("Checked by", found.poecal_version),
    )
}
