//! The errors before and after, on rows that were not fitted, and the measured quantities.

use maud::{Markup, Render, html};

use super::devices::devices;
use super::html::{HtmlTable, capital, count, facts, figure, figure_or, path, plots, section as titled};
use super::leading_error::{kinds_words, sign, spaced_unit};
use super::{corners, figures};
use crate::fitted_cameras::found_words;
use crate::summary::{LeadingRows, ModelRow, cross_validated, delivered_name, has_terms, none_held_out};
use crate::table::{STATISTICS, further_words, models};
use poecal_calibrate::{Improvements, ModelAccuracy, NoiseSource, SetAccuracy};
use poecal_model::measurement::{Device, Quantity};
use poecal_numerics::unit::Unit;
use poecal_results::calibration_file::CalibrationFile;
use poecal_results::residuals::Residuals;

/// A quantity's errors as a caption: `Position error on …, mm`.
pub(crate) fn error_words(quantity: Quantity, of: &str) -> String {
    let unit = match quantity.unit() {
        Unit::Metre => ", mm",
        Unit::Radian => ", degrees",
        Unit::One | Unit::Second => "",
    };
    let of = if of.is_empty() { String::new() } else { format!(" {of}") };
    capital(&format!("{} error{of}{unit}", quantity.name()))
}

/// Errors by each model of the rows that were held out, or else of those fitted, and the measured quantities.
pub(crate) fn section(file: &CalibrationFile, residuals: &Residuals) -> Markup {
    let held_out = file.accuracy.held_out.as_ref();
    let (all, of, key) = match held_out {
        Some(set) => (set, "rows held out", "accuracy.held_out.count"),
        None => (&file.accuracy.training, "the fitted rows, since none was held out", "accuracy.training.count"),
    };
    let LeadingRows { set, models: rows, without, beside } = LeadingRows::from_calibration(file);
    let on = match held_out {
        Some(_) => format!("on {of}"),
        None => format!("on the fitted rows{without}, since none was held out"),
    };
    let tables = set.calibrated.iter().flat_map(|(quantity, _)| {
        let all = lead_table(&error_words(quantity, &on), &rows, quantity, set.improvement.as_ref());
        let beside = beside.as_ref().map(|(other, rows)| {
            let words = error_words(quantity, &format!("on {of}"));
            lead_table(&format!("{words}, {other}"), rows, quantity, None)
        });
        std::iter::once(all).chain(beside)
    });
    let tables: Vec<HtmlTable> = corners::table(&rows, &on).into_iter().chain(tables).collect();
    let caption =
        html! { (count(all.count, key)) " " (of) ". Registered: your model, with only tool and device located." };
    let content = html! {
        div.first {
            div {
                @for table in &tables { (table) }
                @if corners::are_all(set) {
                    p.note {
                        "Position and rotation are those of the pose that fits the corners of a picture, which is uncertain along the ray: the corners "
                        "judge."
                    }
                }
                @if file.accuracy.few_configurations.is_some() { p.note { (capital(&none_held_out(file))) "." } }
                @if let (None, Some(found)) = (held_out, cross_validated(file)) {
                    p.note { "Cross-validation: " (figure(found.rms, found.key)) " " (sign(found.quantity.unit())) " (RMS) on rows that were not fitted." }
                }
                p.note {
                    b { "Before" } ": your model, with only tool and device located. " b { "After" } ": the " (delivered_name(file)) " model, with corrected joint axes"
                    @if has_terms(file) { " and what the joints do beyond geometry; " b { "calibrated" } " is its geometry alone, which a URDF can hold" }
                    ". The gain of the calibration is the difference."
                }
                (facts(&the_facts(file, residuals)))
            }
            (plots(&[figures::distributions(file, residuals)], caption))
        }
    };
    titled("before-after", "Errors before and after", &content)
}

/// Errors before and after, of the rows held out or else of those fitted; for the former also their ratio.
fn lead_table(caption: &str, rows: &[ModelRow<'_>], quantity: Quantity, gain: Option<&Improvements>) -> HtmlTable {
    let heads: Vec<&str> = std::iter::once("").chain(rows.iter().map(|(name, ..)| name.as_str())).collect();
    let mut table = HtmlTable::new(caption, 1, &heads);
    for (label, statistic, value) in STATISTICS {
        let cells = rows.iter().map(|(_, model, key)| {
            let key = format_args!("{key}.{}.{statistic}", quantity.key());
            figure_or(model.get(quantity).map(value), key, "")
        });
        table.cells(std::iter::once(label.render()).chain(cells));
    }
    if let Some(gain) = gain {
        let cells = rows.iter().map(|(.., key)| gain_markup(gain, key, quantity));
        table.cells(std::iter::once("smaller by".render()).chain(cells));
    }
    table
}

/// Ratio of the registered model's errors to a model's, with the interval.
fn gain_markup(gain: &Improvements, key: &str, quantity: Quantity) -> Markup {
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

/// Errors of the models of a set.
pub(crate) fn error_table(caption: &str, set: &SetAccuracy, key: &str, quantity: Quantity) -> HtmlTable {
    let models: Vec<_> = models(set).iter().map(|(name, model)| (*name, model(set))).collect();
    models_table(caption, &models, &format!("{key}."), quantity)
}

/// Errors of some models, by the statistics of each.
pub(crate) fn models_table(
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
    let mut all = vec![("Model", path(&file.inputs.model, "inputs.model")), ("Measurements", files), ("Rows", rows)];
    all.extend(corners::fact(file).map(|corners| ("Corners", corners)));
    let found = found_words(file);
    if !found.is_empty() {
        all.push(("Found", html! { @for (k, words) in found.iter().enumerate() { @if k > 0 { br; } (words) } }));
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
        @for (k, (quantity, sigma)) in noise.sigma.iter().enumerate() {
            @if k > 0 { ", " }
            (figure(sigma, format_args!("noise.sigma.{}", quantity.key()))) (spaced_unit(quantity.unit())) (further_words(quantity))
        }
        @if noise.sigma.iter().any(|(quantity, _)| quantity.components() > 1) { " each component" }
        ", " (source)
    }
}
