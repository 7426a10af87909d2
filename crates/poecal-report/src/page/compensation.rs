//! The gain of corrected programs: a map of the tip's error without correction.

use maud::{Markup, PreEscaped, html};

use super::advice::told_words;
use super::html::{HtmlTable, capital, count, decimal, figure, figure_or, fold_table, plots, quote_text, section};
use crate::plot::{HeatCell, HeatMap};
use crate::summary::uncertainty;
use crate::table::number;
use poecal_calibrate::DeviceFrameKnowledge;
use poecal_results::calibration_file::{CalibrationFile, CompensationEntry, WorkspaceCellEntry};

/// Largest displacement (mm) of a map in micrometres.
const SMALL: f64 = 0.1;

pub(crate) fn sections(file: &CalibrationFile) -> Markup {
    let Some(found) = file.compensation.as_deref() else { return Markup::default() };
    let about = match &found.about {
        Some(name) => html! { "the axis of " (quote_text(name, "compensation.about")) },
        None => html! { "the z axis of the base" },
    };
    let caption = html! {
        "The workspace by distance from " (about) " and by height: each cell is a ring about this axis. Its colour shows the median distance by \
         which the tip misses its target: the stronger the colour, the farther. A cell without colour has no configuration."
    };
    let content = html! {
        p.gain { (gain(file, found)) }
        p {
            "The nominal and the calibrated robot are compared in " (count(found.all.configurations, "compensation.configurations"))
            " configurations, spread evenly over the measured range of each joint. "
            @if file.measurement_frame.known == DeviceFrameKnowledge::Base { "The tool of the nominal robot is" }
            @else { "Tool and base of the nominal robot are" }
            " fitted first, as if they had been taught on the real one. What remains is the error of the joints."
        }
        @if let Some(expected) = expected_map(found) {
            div.pair {
                (plots(&[map(found)], caption))
                (plots(&[expected], "The same cells: the error to expect of corrected programs (RMS)."))
            }
            div.pair { (joints(found)) (exceptions(found)) }
        } @else {
            div.pair { (plots(&[map(found)], caption)) div.tables { (joints(found)) (exceptions(found)) } }
        }
        (fold_table("The map as numbers", &table(found)))
    };
    section("compensation", "What corrected programs gain", &content)
}

/// The gain in a sentence.
pub(crate) fn gain(file: &CalibrationFile, found: &CompensationEntry) -> Markup {
    let here = file.verdict.as_ref().and_then(|it| it.sampled_range_error_mm);
    // Files of earlier versions state the error in the measured configurations alone.
    let expected = here.map(|it| (it, "verdict.sampled_range_error_mm".to_owned())).or_else(|| {
        let (own, key) = uncertainty(file)?;
        Some((own.measured.sigma_position_mm, format!("{key}.measured.sigma_position_mm")))
    });
    html! {
        @if let Some(doubt) = file.gain_doubt() { (told_words(&capital(&doubt))) ". " }
        "A program made for the nominal robot, with its frames taught on this robot, misses its targets by " (figure(found.all.position_mm.median, "compensation.position_mm.median")) " mm (median), and by up to "
        (figure(found.all.position_mm.max, "compensation.position_mm.max")) " mm, within the measured part of the workspace. "
        @if let Some((sigma, key)) = expected {
            "After correction with this calibration, an error of " (figure(sigma, key)) " mm (RMS) is expected."
        } @else {
            "After correction with this calibration, the error of the calibration itself remains."
        }
    }
}

/// Errors of uncorrected programs.
fn map(found: &CompensationEntry) -> Markup {
    let value = |it: &WorkspaceCellEntry| Some(it.displaced.position_mm.median);
    let axis = axis_words(found);
    let worst = found
        .cells
        .iter()
        .max_by(|one, other| one.displaced.position_mm.max.total_cmp(&other.displaced.position_mm.max));
    let description = format!(
        "A map over distance from {axis} and height along it: the median distance between nominal and actual tip in each cell. The largest \
         is at {}. The table below has all figures.",
        worst.map_or_else(String::new, |it| describe_cell(found, it))
    );
    heat_map(
        found,
        found.all.position_mm.max < SMALL,
        value,
        ("Error of an uncorrected program", description, "(median)"),
    )
}

/// Expected errors of corrected programs; `None` for a file that does not state them.
fn expected_map(found: &CompensationEntry) -> Option<Markup> {
    let value = |it: &WorkspaceCellEntry| it.sigma_position_mm;
    let worst =
        found.cells.iter().filter_map(|it| Some((it, value(it)?))).max_by(|one, other| one.1.total_cmp(&other.1));
    let (place, sigma) = worst?;
    let description = format!(
        "A map over distance from {} and height along it: the expected error of predicted positions in each cell. The largest, {} mm, is at {}. \
         The table below has all figures.",
        axis_words(found),
        number(sigma),
        place_words(found, place)
    );
    Some(heat_map(found, sigma < SMALL, value, ("Expected error of a corrected program", description, "(RMS)")))
}

fn axis_words(found: &CompensationEntry) -> &'static str {
    if found.about.is_some() { "the axis" } else { "the base's z axis" }
}

/// A map of the cells that have a value, millimetres, with title, description and the name of the value.
fn heat_map(
    found: &CompensationEntry,
    is_small: bool,
    value: impl Fn(&WorkspaceCellEntry) -> Option<f64>,
    (title, description, what): (&str, String, &str),
) -> Markup {
    let (factor, unit) = if is_small { (1e3, "µm") } else { (1.0, "mm") };
    let step = |value: f64| (value / found.cell_m).round() as i64;
    let cell = |it: &WorkspaceCellEntry| {
        Some(HeatCell {
            at: [step(it.radius_m), step(it.height_m)],
            value: factor * value(it)?,
            arrow: None,
            told: describe_cell(found, it),
        })
    };
    let map = HeatMap {
        title: title.to_owned(),
        description,
        axes: [format!("distance from {}, m", axis_words(found)), "height above the base, m".to_owned()],
        cell: found.cell_m,
        downwards: false,
        values: format!("{unit} {what}"),
        arrows: String::new(),
        cells: found.cells.iter().filter_map(cell).collect(),
    };
    PreEscaped(map.svg())
}

/// A cell in words.
fn describe_cell(found: &CompensationEntry, it: &WorkspaceCellEntry) -> String {
    let own = &it.displaced;
    let configurations = if own.configurations == 1 {
        "1 configuration".to_owned()
    } else {
        format!("{} configurations", own.configurations)
    };
    let expected = it.sigma_position_mm.map(|sigma| format!(", corrected {} mm (RMS) expected", number(sigma)));
    format!(
        "{}: median {} mm, at most {} mm and {}°{} ({configurations})",
        place_words(found, it),
        number(own.position_mm.median),
        number(own.position_mm.max),
        number(own.rotation_deg.max),
        expected.unwrap_or_default()
    )
}

/// The position of a cell in words.
fn place_words(found: &CompensationEntry, it: &WorkspaceCellEntry) -> String {
    let to = |from: f64| format!("{} to {} m", metres(found, from), metres(found, from + found.cell_m));
    format!("distance {}, height {}", to(it.radius_m), to(it.height_m))
}

/// A coordinate at an edge of a cell.
fn metres(found: &CompensationEntry, value: f64) -> String {
    decimal(value, (-found.cell_m.log10().floor()).clamp(0.0, 9.0) as usize)
}

fn joints(found: &CompensationEntry) -> Markup {
    if found.joints.is_empty() {
        return html! { p.note { "Corrections of the joints are not listed: an arm with fewer than six joints cannot correct every displacement." } };
    }
    let mut table = HtmlTable::new(
        "Corrections of the joints; the largest are near singularities",
        1,
        &["joint", "median", "largest", "unit"],
    );
    for (k, it) in found.joints.iter().enumerate() {
        let key = |name: &str| format!("compensation.joints.{k}.{name}");
        let unit = if it.unit == "deg" { "°" } else { &it.unit };
        table.row(&[
            &quote_text(&it.reading, key("reading")),
            &figure(it.change.median, key("median")),
            &figure(it.change.max, key("max")),
            &unit,
        ]);
    }
    html! { (table) }
}

/// Configurations that are not corrected like the others.
fn exceptions(found: &CompensationEntry) -> Markup {
    let mut table = HtmlTable::new("Configurations that were compared", 1, &["configurations", "number"]);
    let mut row = |words: &str, value: usize, key: &str| {
        table.row(&[&words, &count(value, format_args!("compensation.{key}"))]);
    };
    row("all", found.all.configurations, "configurations");
    row(
        "need no correction: the error is within what is expected of the calibration",
        found.within_expected_error,
        "within_expected_error",
    );
    if !found.joints.is_empty() {
        row("corrected values beyond a joint's limits", found.beyond_limits, "beyond_limits");
        row(
            "not corrected: near a singularity, where the arm would have to bend another way",
            found.not_correctable,
            "not_correctable",
        );
    }
    html! { (table) }
}

fn table(found: &CompensationEntry) -> HtmlTable {
    let head = [
        "distance from, m",
        "height from, m",
        "configurations",
        "median, mm",
        "largest, mm",
        "median, °",
        "largest, °",
        "corrected, expected, mm",
    ];
    let caption = format!(
        "Displacement of the uncorrected tip by distance and height, in cells of {} m",
        metres(found, found.cell_m)
    );
    let mut table = HtmlTable::new(&caption, 0, &head);
    for (k, it) in found.cells.iter().enumerate() {
        let key = |name: &str| format!("compensation.cells.{k}.{name}");
        let own = &it.displaced;
        table.cells([
            html! { (metres(found, it.radius_m)) },
            html! { (metres(found, it.height_m)) },
            count(own.configurations, key("configurations")),
            figure(own.position_mm.median, key("position_mm.median")),
            figure(own.position_mm.max, key("position_mm.max")),
            figure(own.rotation_deg.median, key("rotation_deg.median")),
            figure(own.rotation_deg.max, key("rotation_deg.max")),
            figure_or(it.sigma_position_mm, key("sigma_position_mm"), "–"),
        ]);
    }
    table
}
