//! Trust in the result, and the unknowns that the data determine.

use maud::{Markup, html};

use super::figures;
use super::html::{HtmlTable, count, figure, figure_or, fold_table, list, plots, quote_text, scaled_figure, section};
use super::leading_error::{sign, spaced_unit};
use super::ranges::{self, unit_of};
use crate::shade;
use crate::summary::{cross_validated, delivered_name, has_terms, uncertainty};
use poecal_calibrate::NoiseSource;
use poecal_fit::analysis::Direction;
use poecal_fit::uncertainty::Attribution;
use poecal_model::measurement::Quantity;
use poecal_results::calibration_file::{
    CalibrationFile, CorrelatedEntry, CrossValidationEntry, LeftOutEntry, UncertaintyEntry,
};

pub(crate) fn sections(file: &CalibrationFile) -> Markup {
    let content = html! {
        @if let Some((found, key)) = uncertainty(file) { (expected_table(file, found, key)) }
        (cross_validation(file))
        @if !file.coverage.is_empty() { (coverage(file)) }
        @if let Some((found, key)) = uncertainty(file).filter(|(it, _)| !it.parts.is_empty()) { (ranges::parts(file, found, key)) }
        (determined_markup(file))
    };
    section("trust", "How far to trust it", &content)
}

fn expected_table(file: &CalibrationFile, found: &UncertaintyEntry, of: &str) -> Markup {
    let head = ["configurations", "RMS", "95 % bound, mean", "95 % bound, worst"];
    let title = format!("Expected errors of positions that the {} model predicts, mm", delivered_name(file));
    let mut table = HtmlTable::new(&title, 1, &head);
    for (words, set, key) in
        [("measured", &found.measured, "measured"), ("anywhere within the limits", &found.range, "range")]
    {
        let figure = |value, name| figure(value, format_args!("{of}.{key}.{name}"));
        table.row(&[
            &words,
            &figure(set.sigma_position_mm, "sigma_position_mm"),
            &figure(set.bound95_position_mm, "bound95_position_mm"),
            &figure(set.worst_bound95_position_mm, "worst_bound95_position_mm"),
        ]);
    }
    let leading = file.accuracy.training.calibrated.leading_value().map(|(quantity, _)| quantity);
    let source = leading.and_then(|leading| Some((leading, *found.residuals.get(&leading)?)));
    html! {
        (table)
        @if let Some((leading, source)) = source { p {
            @match source {
                Attribution::Robot => {
                    (figure_or(found.discrepancy.get(leading), format_args!("{of}.model_error.{}", leading.key()), "–"))
                    (spaced_unit(leading.unit()))
                    " per component: the error of the model, by residuals and cross-validation. "
                    @if matches!(file.noise.source, NoiseSource::Given | NoiseSource::Rows) {
                        "The stated noise explains a small part of the residuals only; the rest counts as robot error."
                    } @else {
                        "Neither a stated noise nor repeated measurements explain the residuals, so all of them count as robot error. State \
                         the noise (--sigma-position) or repeat measurements to separate the two."
                    }
                }
                Attribution::StatedNoise => {
                    "The stated noise explains the residuals, so predictions are better than any single measurement."
                }
                Attribution::Repeats => {
                    "The residuals are no larger than the scatter of repeated measurements, so predictions are better than any single \
                     measurement."
                }
            }
        } }
        @if let Some(drawn) = &found.bootstrap {
            p {
                "Block bootstrap, " (count(drawn.drawings, format_args!("{of}.bootstrap.drawings")))
                " samples: predictions scatter by "
                (figure(drawn.sigma_position_mm, format_args!("{of}.bootstrap.sigma_position_mm")))
                " mm (RMS). The covariance, for independent and equally noisy rows, predicts "
                (figure(drawn.formal_sigma_position_mm, format_args!("{of}.bootstrap.formal_sigma_position_mm"))) " mm."
            }
        }
    }
}

/// Cross-validation of the delivered model, and of geometry alone by its blocks.
fn cross_validation(file: &CalibrationFile) -> Markup {
    let corrected = cross_validated(file).filter(|_| has_terms(file));
    html! {
        @if corrected.is_some() || file.cross_validation.is_some() { h3 { "Cross-validation" } }
        @if let Some(found) = &corrected {
            p {
                "The corrected model predicts fitted rows in parts of the range that were left out of its fits to " (figure(found.rms, &found.key)) " "
                (sign(found.quantity.unit())) " (RMS)."
            }
        }
        @if let Some(found) = &file.cross_validation {
            @if has_terms(file) {
                details { summary { "Cross-validation of the calibrated model, geometry alone" } (blocks(found)) }
            } @else { (blocks(found)) }
        }
    }
}

fn blocks(found: &CrossValidationEntry) -> Markup {
    let blocks = found.blocked.iter().enumerate();
    let worst = blocks.max_by(|(_, a), (_, b)| a.rms.lead().total_cmp(&b.rms.lead()));
    let measured: Vec<(Quantity, String)> =
        found.random.rms.iter().map(|(quantity, _)| (quantity, format!("rms.{}", quantity.key()))).collect();
    let rms = |(quantity, _): &(Quantity, String)| format!("{}, {} (RMS)", quantity.name(), sign(quantity.unit()));
    let errors: Vec<String> = measured.iter().map(rms).collect();
    let head: Vec<&str> = ["rows predicted", "rows"].into_iter().chain(errors.iter().map(String::as_str)).collect();
    let mut table = HtmlTable::new("Fitted rows, predicted by calibrated models of the others", 1, &head);
    let mut add = |entry: &LeftOutEntry, key: &str| {
        let mut cells = vec![
            quote_text(&entry.left_out, format_args!("{key}.left_out")),
            count(entry.rows, format_args!("{key}.rows")),
        ];
        let errors = measured.iter().map(|(quantity, own)| (entry.rms.get(*quantity), own));
        cells.extend(errors.map(|(rms, own)| figure_or(rms, format_args!("{key}.{own}"), "–")));
        table.cells(cells);
    };
    add(&found.random, "cross_validation.random");
    if let Some(outside) = &found.outside {
        add(outside, "cross_validation.outside");
    }
    for (k, entry) in found.blocked.iter().enumerate() {
        add(entry, &format!("cross_validation.blocked.{k}"));
    }
    html! {
        p {
            "Fitted rows, predicted by fits of the others: "
            @for (k, (quantity, own)) in measured.iter().enumerate() {
                @if k > 0 { ", " }
                (figure_or(found.random.rms.get(*quantity), format_args!("cross_validation.random.{own}"), "–")) (spaced_unit(quantity.unit()))
            }
            " (RMS) where random rows were left out"
            @if let Some((k, worst)) = worst {
                "; worst where " (quote_text(&worst.left_out, format_args!("cross_validation.blocked.{k}.left_out"))) " was left out: "
                @for (at, (quantity, own)) in measured.iter().enumerate() {
                    @if at > 0 { ", " }
                    (figure_or(worst.rms.get(*quantity), format_args!("cross_validation.blocked.{k}.{own}"), "–")) (spaced_unit(quantity.unit()))
                }
            }
            ". Where a block is much worse than random rows, do not trust the model in that part of the range."
        }
        (fold_table("All blocks", &table))
    }
}

fn coverage(file: &CalibrationFile) -> Markup {
    let head = ["joint", "sampled from", "to", "limits from", "to", "share"];
    let mut table = HtmlTable::new("Sampled range of each joint", 1, &head);
    let mut is_of_a_turn = false;
    for (k, found) in file.coverage.iter().enumerate() {
        let (factor, unit) = unit_of(file, &found.joint);
        let end = |value: Option<f64>, name: &str| match value {
            Some(value) => {
                html! { (scaled_figure(value, format_args!("coverage.{k}.{name}"), factor)) (unit) }
            }
            None => html! { "none" },
        };
        let kind = file.joints.iter().find(|joint| joint.name == found.joint).map(|joint| joint.kind);
        let share = kind.and_then(|kind| found.share(kind));
        is_of_a_turn |= kind.is_some_and(|kind| found.is_of_a_turn(kind));
        table.row(&[
            &quote_text(&found.joint, format_args!("coverage.{k}.joint")),
            &end(Some(found.sampled_min), "sampled_min"),
            &end(Some(found.sampled_max), "sampled_max"),
            &end(found.limit_min, "limit_min"),
            &end(found.limit_max, "limit_max"),
            &share.map_or_else(|| "–".to_owned(), |share| format!("{:.0} %", 100.0 * share)),
        ]);
    }
    html! {
        h3 { "Sampled part of each joint's range" }
        (plots(&figures::coverage(file), "Bars: sampled by the fitted rows. Thin lines: the limits of the model."))
        (fold_table("The ranges as numbers", &table))
        @if is_of_a_turn { p { "Share: of one turn where the limits span more." } }
    }
}

/// Number of determined unknowns, and the undetermined or weakly determined ones.
fn determined_markup(file: &CalibrationFile) -> Markup {
    let found = &file.identifiability;
    let groups = [
        ("Undetermined by these configurations", "unidentifiable", &found.unidentifiable),
        ("Weakly determined, little better than nominal", "weak", &found.weak),
    ];
    html! {
        h3 { "Unknowns" }
        p {
            (count(found.rank, "identifiability.rank")) " of " (count(found.parameters, "identifiability.parameters"))
            " unknowns are determined"
            @if found.weakly_determined() > 0 { ", " (found.weakly_determined()) " of them weakly" }
            "."
        }
        @for (title, key, directions) in groups {
            @if !directions.is_empty() { p { (title) ":" } (list(&items(directions, key))) }
        }
    }
}

/// Unknowns that no measurement of this kind determines, the observability of the others, and those that are determined only together.
pub(crate) fn for_the_metrologist(file: &CalibrationFile) -> Markup {
    let found = &file.identifiability;
    html! {
        @if !found.structural.is_empty() {
            h3 { "Not observable, without effect on predictions" }
            (list(&items(&found.structural, "structural")))
        }
        (observability(file))
        (common_directions(file))
        (correlations(file))
        (shares(file))
    }
}

fn items(directions: &[Direction], key: &str) -> Vec<Markup> {
    let item = |(k, direction)| direction_words(direction, &format!("identifiability.{key}.{k}"));
    directions.iter().enumerate().map(item).collect()
}

/// Combinations of several joints that are determined only together.
fn common_directions(file: &CalibrationFile) -> Markup {
    let items = file.common.iter().enumerate();
    let items = items.map(|(k, it)| quote_text(&it.words, format_args!("common.{k}.words")));
    let items: Vec<Markup> = items.collect();
    html! {
        @if !items.is_empty() {
            h3 { "Known only together" }
            p {
                "These joints can change together with little effect on what was measured, so the standard deviations of each are large. One \
                 standard deviation of each such direction:"
            }
            (list(&items))
        }
    }
}

/// Share of the measurements in the information on each axis, beside the tolerance.
fn shares(file: &CalibrationFile) -> Markup {
    let mut table = HtmlTable::new(
        "What limits the uncertainty of each axis: the measurements' share of its variance, from 0 to 1; the rest is the tolerance's. A small share \
         beside a small ± does not mean that the axis was not measured",
        1,
        &["joint", "direction", "place"],
    );
    for (k, found) in file.corrections.iter().enumerate() {
        table.row(&[
            &quote_text(&found.joint, format_args!("corrections.{k}.joint")),
            &figure_or(found.tilt_from_data, format_args!("corrections.{k}.tilt_from_data"), "–"),
            &figure_or(found.shift_from_data, format_args!("corrections.{k}.shift_from_data"), "–"),
        ]);
    }
    let has_any = file.corrections.iter().any(|it| it.tilt_from_data.or(it.shift_from_data).is_some());
    html! { @if has_any { h3 { "Shares of the measurements" } (table) } }
}

/// A direction with the keys of its words.
fn direction_words(direction: &Direction, key: &str) -> Markup {
    html! {
        (quote_text(&direction.description, format_args!("{key}.description")))
        @if direction.directions > 1 { " (" (count(direction.directions, format_args!("{key}.directions"))) " unknowns)" }
    }
}

/// Blocks that are determined only together: a map, and the strongest pairs.
fn correlations(file: &CalibrationFile) -> Markup {
    let Some(found) = file.uncertainty.as_ref().and_then(|it| it.correlations.as_ref()) else {
        return Markup::default();
    };
    let head: Vec<&str> = std::iter::once("").chain(found.blocks.iter().map(String::as_str)).collect();
    let mut map = HtmlTable::new("Largest correlation between the unknowns of two blocks", 1, &head);
    for (i, (block, row)) in found.blocks.iter().zip(&found.largest).enumerate() {
        map.push_marked(&html! {
            tr {
                th scope="row" { (quote_text(block, format_args!("uncertainty.correlations.blocks.{i}"))) }
                @for (j, value) in row.iter().enumerate() {
                    td.heat style=(shade::style(*value, 1.0)) {
                        (figure(*value, format_args!("uncertainty.correlations.largest.{i}.{j}")))
                    }
                }
                @for _ in row.len()..found.blocks.len() { td {} }
            }
        });
    }
    let pair = |(k, pair): (usize, &CorrelatedEntry)| {
        let key = format!("uncertainty.correlations.pairs.{k}");
        let [one, other] = &pair.unknowns;
        html! {
            (quote_text(one, format_args!("{key}.unknowns.0"))) " and " (quote_text(other, format_args!("{key}.unknowns.1"))) ": "
            (figure(pair.correlation, format_args!("{key}.correlation")))
        }
    };
    let pairs: Vec<Markup> = found.pairs.iter().enumerate().map(pair).collect();
    html! {
        h3 { "Correlations" }
        p {
            @if found.strong == 0 { "No pair of unknowns is correlated by 0.95 or more." }
            @else {
                (count(found.strong, "uncertainty.correlations.strong"))
                " pairs of unknowns are correlated by 0.95 or more: the rows determine their sum or difference much better than each of them."
                @if found.strong > pairs.len() { " The strongest:" }
            }
        }
        (list(&pairs))
        div.map { (map) }
    }
}

fn observability(file: &CalibrationFile) -> Markup {
    let found = &file.identifiability.observability;
    let indices = [
        ("O1", "geometric mean of the singular values, over the root of the number of rows", "1/m", found.o1, "o1"),
        ("O2", "inverse of the condition number", "", found.o2, "o2"),
        ("O3", "smallest singular value", "1/m", found.o3, "o3"),
        ("O4", "noise amplification", "1/m", found.o4, "o4"),
        ("O5", "inverse of the sum of the inverse singular values", "1/m", found.o5, "o5"),
    ];
    let mut table = HtmlTable::new(
        "Observability indices; larger is better, for comparing sets of configurations of one robot",
        2,
        &["index", "meaning", "value", "unit"],
    );
    for (name, words, unit, value, key) in indices {
        let key = format_args!("identifiability.observability.{key}");
        table.row(&[&name, &words, &figure_or(value, key, "zero: a direction is not observed"), &unit]);
    }
    html! {
        h3 { "Observability" }
        @if let Some(condition) = file.identifiability.condition {
            p { "The condition number over the determined unknowns is " (figure(condition, "identifiability.condition")) "." }
        }
        (table)
    }
}
