//! Joint effects beyond geometry: the terms of the corrected model, and each joint's error over its range.

use maud::{Markup, PreEscaped, html};

use super::html::{HtmlTable, decimal, figure, list, plots, quote_text, scaled_figure, section};
use crate::plot::{AxisScale, Band, LinePlot, PlotAxis, PlotLine};
use crate::summary::has_terms;
use poecal_calibrate::TermGroup;
use poecal_model::robot::JointKind;
use poecal_results::calibration_file::{CalibrationFile, CorrectedEntry, EffectEntry, JointErrorsEntry};

/// Most sizes of those that were tried.
const TRIED: usize = 12;

pub(crate) fn sections(file: &CalibrationFile) -> Markup {
    let Some(found) = &file.corrected else { return Markup::default() };
    let content = if has_terms(file) {
        html! {
            p {
                "Gears, bearings and links give under weight, encoders and gears err within a turn. The corrected model fits such terms \
                 together with the axes; the calibrated one, which a URDF can carry, is geometry alone."
            }
            (effects(found))
            (plots(&errors(file, found), "Error of each joint that explains most of the residuals in a part of its range: by the \
                calibrated model, by the corrected one, and what the joint's own terms say, less their mean, which is no error: its offset. The band is one \
                standard deviation to each side."))
            @if !found.indistinguishable.is_empty() {
                h3 { "Not distinguishable" }
                (list(&found.indistinguishable.iter().enumerate().map(|(k, words)| quote_text(words, format_args!("corrected.indistinguishable.{k}"))).collect::<Vec<_>>()))
            }
        }
    } else {
        html! { p { "The corrected model is the calibrated one: " (found.reason.words()) "." } }
    };
    section("corrected", "What the joints do", &content)
}

fn effects(found: &CorrectedEntry) -> Markup {
    let head = ["joint", "what it does", "±, mrad or mm", "determined, %", "at the target, mm (RMS)"];
    let mut table = HtmlTable::new("What the terms do in the fitted configurations", 2, &head);
    let mut faint = 0;
    for (k, it) in found.effects.iter().enumerate() {
        if !it.found {
            faint += 1;
            continue;
        }
        let EffectEntry { joint, words, sigma, determined_share, effect_mm, .. } = it;
        table.row(&[
            &quote_text(joint, format_args!("corrected.effects.{k}.joint")),
            &quote_text(words, format_args!("corrected.effects.{k}.words")),
            &figure(*sigma, format_args!("corrected.effects.{k}.sigma")),
            &scaled_figure(*determined_share, format_args!("corrected.effects.{k}.determined_share"), 100.0),
            &figure(*effect_mm, format_args!("corrected.effects.{k}.effect_mm")),
        ]);
    }
    if faint == found.effects.len() {
        return html! { p { "All " (faint) " effects are too small to distinguish from noise." } };
    }
    html! {
        div.wide { (table) }
        @if faint > 0 { p { (faint) " further effect" (if faint == 1 { " is" } else { "s are" }) " too small to distinguish from noise." } }
    }
}

/// Mean of a joint's terms over its rows.
fn mean_of_terms(found: &JointErrorsEntry) -> f64 {
    let rows: usize = found.parts.iter().map(|part| part.rows).sum();
    let sum: f64 = found.parts.iter().map(|part| part.rows as f64 * part.terms).sum();
    sum / rows.max(1) as f64
}

/// Each joint's error over its range.
fn errors(file: &CalibrationFile, found: &CorrectedEntry) -> Vec<Markup> {
    let plot = |it: &JointErrorsEntry| {
        let slides = file.joints.iter().any(|joint| joint.name == it.joint && joint.kind == JointKind::Prismatic);
        let (factor, unit, of) = if slides { (1e3, "mm", "mm") } else { (1f64.to_degrees(), "degrees", "mrad") };
        let points = |value: &dyn Fn(usize) -> f64| -> Vec<[f64; 2]> {
            let at = |k: usize| factor * 0.5 * (it.parts[k].from + it.parts[k].to);
            (0..it.parts.len()).map(|k| [at(k), value(k)]).collect()
        };
        let line = |name: &str, style: usize, points| PlotLine { name: name.to_owned(), style, points };
        let part = |k: usize| &it.parts[k];
        let mean = mean_of_terms(it);
        let terms = points(&|k| part(k).terms - mean);
        let ends = terms.iter().zip(&it.parts);
        let band = ends.map(|(&[at, value], part)| [at, value - part.sigma, value + part.sigma]);
        let band = Band { style: 1, points: band.collect() };
        let lines = vec![
            line("calibrated", 3, points(&|k| part(k).calibrated)),
            line("corrected", 0, points(&|k| part(k).corrected)),
            line("its terms ±", 1, terms),
        ];
        let plot = LinePlot {
            title: it.joint.clone(),
            description:
                "The joint's error over its range by the calibrated and by the corrected model, and by its own terms."
                    .to_owned(),
            x: PlotAxis::new(&format!("{} of the joint", unit), AxisScale::Linear),
            y: PlotAxis::new(&format!("error, {of}"), AxisScale::Linear).with_values(&[0.0]),
            lines,
            mark: None,
        };
        PreEscaped(plot.banded(&band))
    };
    found.joint_errors.iter().filter(|it| it.parts.len() > 1).map(plot).collect()
}

/// The sizes of the terms that were tried, the best first.
pub(crate) fn tried_sizes_table(file: &CalibrationFile) -> Markup {
    let Some(found) = file.corrected.as_deref().filter(|it| !it.tried.is_empty()) else {
        return Markup::default();
    };
    let is_tried = |name: &&str| found.tried.iter().any(|it| it.sizes.get(*name).is_some_and(|size| *size > 0.0));
    let groups: Vec<TermGroup> = TermGroup::ALL.into_iter().filter(|group| is_tried(&group.name())).collect();
    let names: Vec<&str> = groups.iter().map(|group| group.name()).collect();
    let heads: Vec<String> =
        groups.iter().map(|group| format!("{}, {}", group.name(), group.row().symbols[1])).collect();
    let head: Vec<&str> =
        std::iter::once("left out, of geometry's error").chain(heads.iter().map(String::as_str)).collect();
    let mut table = HtmlTable::new(
        "Prior sizes that were tried: error of the parts left out, over that of geometry alone",
        0,
        &head,
    );
    let mut order: Vec<usize> = (0..found.tried.len()).collect();
    order.sort_by(|&a, &b| found.tried[a].score.total_cmp(&found.tried[b].score));
    for k in order.into_iter().take(TRIED) {
        let it = &found.tried[k];
        let size = |name: &&str| it.sizes.get(*name).map_or_else(|| "–".to_owned(), |size| decimal(1e3 * size, 2));
        let first = figure(it.left_out, format_args!("corrected.tried.{k}.left_out"));
        let cells = names.iter().map(size).map(|text| html! { (text) });
        table.cells(std::iter::once(first).chain(cells));
    }
    html! {
        h3 { "Sizes of the terms" }
        p { (found.tried.len()) " sizes were tried. Chosen: " (found.reason.words()) ". The best:" }
        (table)
    }
}
