//! Expected errors over the joint ranges.

use maud::{Markup, html};

use super::html::{HtmlTable, decimal, figure};
use crate::shade;
use poecal_model::robot::JointKind;
use poecal_results::calibration_file::{CalibrationFile, RangeEntry, UncertaintyEntry};

/// The factor and unit by which a joint's values are shown.
pub(crate) fn unit_of(file: &CalibrationFile, joint: &str) -> (f64, &'static str) {
    let slides = file.joints.iter().any(|it| it.name == joint && it.kind == JointKind::Prismatic);
    if slides { (1e3, " mm") } else { (1f64.to_degrees(), "°") }
}

/// Ratio of the smallest to the largest expected error above which all parts of the ranges count as equal.
const ALIKE: f64 = 0.7;

/// Expected errors over the joint ranges: a map, or a sentence if they hardly differ.
pub(crate) fn parts(file: &CalibrationFile, found: &UncertaintyEntry, key: &str) -> Markup {
    let order =
        |a: &(usize, &RangeEntry), b: &(usize, &RangeEntry)| a.1.sigma_position_mm.total_cmp(&b.1.sigma_position_mm);
    let all = || found.parts.iter().enumerate();
    let figure = |(k, part): (usize, &RangeEntry)| {
        figure(part.sigma_position_mm, format_args!("{key}.parts.{k}.sigma_position_mm"))
    };
    match all().min_by(order).zip(all().max_by(order)) {
        Some((least, most)) if least.1.sigma_position_mm >= ALIKE * most.1.sigma_position_mm => html! {
            h3 { "Expected error over the joint ranges" }
            p {
                "The expected error of position hardly depends on where a joint is: " (figure(least)) " to " (figure(most)) " mm (RMS) in each part of each \
                 joint's range, with the other joints anywhere in theirs."
            }
        },
        _ => map_of_parts(file, found, key),
    }
}

/// The map of expected errors: one row for each joint, one cell for each part of its range.
fn map_of_parts(file: &CalibrationFile, found: &UncertaintyEntry, key: &str) -> Markup {
    let worst = found.parts.iter().map(|part| part.sigma_position_mm).fold(0.0, f64::max);
    let of = |joint: &str| {
        let joint = joint.to_owned();
        found.parts.iter().enumerate().filter(move |(_, part)| part.joint == joint)
    };
    let most = file.joints.iter().map(|joint| of(&joint.name).count()).max();
    let names: Vec<String> = (1..=most.unwrap_or(0)).map(|part| format!("part {part}")).collect();
    let head: Vec<&str> = std::iter::once("joint").chain(names.iter().map(String::as_str)).collect();
    let mut table = HtmlTable::new("Expected errors by parts of each joint's range, mm (RMS)", 1, &head);
    for joint in &file.joints {
        let unit = unit_of(file, &joint.name);
        table.push_marked(&html! {
            tr {
                th scope="row" { (joint.name) }
                @for (k, part) in of(&joint.name) { (map_cell((k, key), part, worst, unit)) }
            }
        });
    }
    html! {
        h3 { "Expected error over the joint ranges" }
        p {
            "Expected errors of position, mm (RMS), by parts of each joint's range, with the other joints anywhere in theirs. The colour grows \
             with the error, from none at zero to the full one at the largest of the table."
        }
        div.map { (table) }
    }
}

fn map_cell((k, key): (usize, &str), part: &RangeEntry, worst: f64, (factor, unit): (f64, &str)) -> Markup {
    let [from, to] = [part.from, part.to].map(|end| decimal(end * factor, 0));
    html! {
        td.heat style=(shade::style(part.sigma_position_mm, worst)) {
            (figure(part.sigma_position_mm, format_args!("{key}.parts.{k}.sigma_position_mm")))
            small { (from) " to " (to) (unit) }
        }
    }
}
