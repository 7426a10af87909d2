//! How far the result can be trusted, and what the data tell.

use super::figures;
use super::html::{Html, Table, count, decimal, figure, quoted, scaled};
use crate::analysis::Direction;
use crate::io::calibration_file::{CalibrationFile, KindWord, LeftOutEntry, RangeEntry, UncertaintyEntry};
use crate::report::plot::escape;
use crate::uncertainty::Attribution;

pub(super) fn sections(page: &mut Html, file: &CalibrationFile) {
    page.section("trust", "How far to trust it");
    if let Some(uncertainty) = &file.uncertainty {
        expected(page, uncertainty);
    }
    cross_validation(page, file);
    coverage(page, file);
    if let Some(uncertainty) = &file.uncertainty {
        parts(page, file, uncertainty);
    }
    page.end_section();
    told(page, file);
}

/// The factor and unit by which a joint's values are shown.
fn unit_of(file: &CalibrationFile, joint: &str) -> (f64, &'static str) {
    let slides = file.joints.iter().any(|it| it.name == joint && it.kind == KindWord::Prismatic);
    if slides { (1e3, " mm") } else { (1f64.to_degrees(), "°") }
}

fn expected(page: &mut Html, found: &UncertaintyEntry) {
    let head = ["configurations", "RMS", "95 % bound, mean", "95 % bound, worst"];
    let mut table = Table::new("Expected errors of predicted positions, mm", 1, &head);
    for (words, set, key) in
        [("as measured", &found.measured, "measured"), ("anywhere within the limits", &found.range, "range")]
    {
        let key = |name: &str| format!("uncertainty.{key}.{name}");
        table.rows.push(vec![
            words.to_owned(),
            figure(set.sigma_position_mm, &key("sigma_position_mm")),
            figure(set.bound95_position_mm, &key("bound95_position_mm")),
            figure(set.worst_bound95_position_mm, &key("worst_bound95_position_mm")),
        ]);
    }
    page.table(&table);
    page.text(&match found.residuals_position {
        Attribution::Robot => format!(
            "{} mm a component of what the fit leaves count as errors of the robot in the figures above: nothing shows that they are noise of \
             measuring. A stated noise (--sigma-position) that explains them, or repeated measurements, would.",
            figure(found.discrepancy_position_mm, "uncertainty.discrepancy_position_mm")
        ),
        Attribution::StatedNoise => {
            "The stated noise explains what the fit leaves, so predictions are better than any single measurement.".to_owned()
        }
        Attribution::Repeats => {
            "What the fit leaves is no more than what repeated measurements scatter by, so predictions are better than any single measurement."
                .to_owned()
        }
    });
    if let Some(drawn) = &found.bootstrap {
        page.text(&format!(
            "Drawing neighbourhoods of rows anew {} times spreads the predictions there by {} mm (RMS); if rows err independently and alike it \
             is {} mm.",
            count(drawn.drawings, "uncertainty.bootstrap.drawings"),
            figure(drawn.sigma_position_mm, "uncertainty.bootstrap.sigma_position_mm"),
            figure(drawn.formal_sigma_position_mm, "uncertainty.bootstrap.formal_sigma_position_mm")
        ));
    }
}

fn cross_validation(page: &mut Html, file: &CalibrationFile) {
    let Some(found) = &file.cross_validation else { return };
    let turned = found.random.rotation_rms_deg.is_some();
    let mut head = vec!["left out", "rows", "position, mm (RMS)"];
    head.extend(turned.then_some("rotation, ° (RMS)"));
    let mut table = Table::new("Fitted rows left out in turn, and how the others predict them", 1, &head);
    let mut add = |entry: &LeftOutEntry, key: &str| {
        let mut cells = vec![
            quoted(&entry.left_out, &format!("{key}.left_out")),
            count(entry.rows, &format!("{key}.rows")),
            figure(entry.position_rms_mm, &format!("{key}.position_rms_mm")),
        ];
        if turned {
            cells.push(
                entry
                    .rotation_rms_deg
                    .map_or_else(|| "–".to_owned(), |it| figure(it, &format!("{key}.rotation_rms_deg"))),
            );
        }
        table.rows.push(cells);
    };
    add(&found.random, "cross_validation.random");
    for (k, entry) in found.blocked.iter().enumerate() {
        add(entry, &format!("cross_validation.blocked.{k}"));
    }
    page.heading("Left out");
    page.text("Blocks that are missed by far more than random rows are parts of the range for which the fit does not speak.");
    page.table(&table);
}

fn coverage(page: &mut Html, file: &CalibrationFile) {
    if file.coverage.is_empty() {
        return;
    }
    page.heading("What was sampled of each joint's range");
    page.plots(
        &figures::coverage(file),
        "Bars: sampled by the fitted rows. Thin lines: the limits of the model.",
    );
    let head = ["joint", "sampled from", "to", "limits from", "to", "share"];
    let mut table = Table::new("Sampled range of each joint", 1, &head);
    for (k, found) in file.coverage.iter().enumerate() {
        let (factor, unit) = unit_of(file, &found.joint);
        let key = |name: &str| format!("coverage.{k}.{name}");
        let cell = |value: f64, name: &str| format!("{}{unit}", scaled(value, &key(name), factor));
        let limit = |value: Option<f64>, name: &str| {
            value.map_or_else(|| "none".to_owned(), |value| cell(value, name))
        };
        let kind = file.joints.iter().find(|joint| joint.name == found.joint).map(|joint| joint.kind);
        let share = kind.and_then(|kind| found.share(kind.into()));
        table.rows.push(vec![
            quoted(&found.joint, &key("joint")),
            cell(found.sampled_min, "sampled_min"),
            cell(found.sampled_max, "sampled_max"),
            limit(found.limit_min, "limit_min"),
            limit(found.limit_max, "limit_max"),
            share.map_or_else(|| "–".to_owned(), |share| format!("{:.0} %", 100.0 * share)),
        ]);
    }
    page.table(&table);
}

/// The map of expected errors: a row a joint, a cell a part of its range.
fn parts(page: &mut Html, file: &CalibrationFile, found: &UncertaintyEntry) {
    let worst = found.parts.iter().map(|part| part.sigma_position_mm).fold(0.0, f64::max);
    let least = found.parts.iter().map(|part| part.sigma_position_mm).fold(f64::INFINITY, f64::min);
    if found.parts.is_empty() {
        return;
    }
    page.heading("Where errors are to be expected");
    page.text(
        "Expected errors of position, mm (RMS), by parts of each joint's range, with the other joints anywhere in theirs. The darker a \
         cell, the larger the error: the palest is the least of the table, the darkest the largest.",
    );
    let most = file
        .joints
        .iter()
        .map(|joint| found.parts.iter().filter(|part| part.joint == joint.name).count())
        .max();
    let names: Vec<String> = (1..=most.unwrap_or(0)).map(|part| format!("part {part}")).collect();
    let head: Vec<&str> = std::iter::once("joint").chain(names.iter().map(String::as_str)).collect();
    let mut table = Table::new("Expected errors by parts of each joint's range, mm (RMS)", 1, &head);
    for joint in &file.joints {
        let (factor, unit) = unit_of(file, &joint.name);
        let cells = found.parts.iter().enumerate().filter(|(_, part)| part.joint == joint.name);
        let cells = cells.map(|(k, part)| map_cell(k, part, (least, worst), (factor, unit)));
        table.rows.push(std::iter::once(escape(&joint.name)).chain(cells).collect());
    }
    page.raw("<div class=\"map\">");
    page.table(&table);
    page.raw("</div>");
}

fn map_cell(k: usize, part: &RangeEntry, (least, worst): (f64, f64), (factor, unit): (f64, &str)) -> String {
    let span = worst - least;
    let level = if span > 0.0 { (10.0 * (part.sigma_position_mm - least) / span).round() } else { 0.0 };
    let sigma = figure(part.sigma_position_mm, &format!("uncertainty.parts.{k}.sigma_position_mm"));
    let [from, to] = [part.from, part.to].map(|end| decimal(end * factor, 0));
    format!("<td class=\"heat h{level:.0}\">{sigma}<small>{from} to {to}{unit}</small></td>")
}

fn told(page: &mut Html, file: &CalibrationFile) {
    let found = &file.identifiability;
    page.section("told", "What the data tell");
    let condition = found.condition.map_or_else(String::new, |condition| {
        format!(" The condition number over these is {}.", figure(condition, "identifiability.condition"))
    });
    page.text(&format!(
        "{} of {} unknowns are determined against the noise.{condition}",
        count(found.rank, "identifiability.rank"),
        count(found.parameters, "identifiability.parameters")
    ));
    let groups = [
        ("Left open by these configurations", "unidentifiable", &found.unidentifiable),
        ("Told, but hardly better than a drawing does", "weak", &found.weak),
        (
            "What no measurement of this kind could tell (it changes no prediction)",
            "structural",
            &found.structural,
        ),
    ];
    for (title, key, directions) in groups {
        if !directions.is_empty() {
            page.heading(title);
            page.list(&items(directions, key));
        }
    }
    observability(page, file);
    page.end_section();
}

fn items(directions: &[Direction], key: &str) -> Vec<String> {
    let item = |(k, direction)| direction_words(direction, &format!("identifiability.{key}.{k}"));
    directions.iter().enumerate().map(item).collect()
}

/// A direction with the keys of its words.
pub(super) fn direction_words(direction: &Direction, key: &str) -> String {
    let times = if direction.directions > 1 {
        format!(" ({} directions)", count(direction.directions, &format!("{key}.directions")))
    } else {
        String::new()
    };
    format!("{}{times}", quoted(&direction.description, &format!("{key}.description")))
}

fn observability(page: &mut Html, file: &CalibrationFile) {
    let found = &file.identifiability.observability;
    let indices = [
        ("O1", "the volume that the rows fill, by their number", "1/m", found.o1, "o1"),
        ("O2", "the inverse of the condition number", "", found.o2, "o2"),
        ("O3", "what is known least", "1/m", found.o3, "o3"),
        ("O4", "how noise is amplified", "1/m", found.o4, "o4"),
        ("O5", "the inverse of the sum of what is left unknown", "1/m", found.o5, "o5"),
    ];
    let mut table = Table::new(
        "Observability indices; larger is better, for comparing sets of configurations of one robot",
        2,
        &["index", "what it is", "value", "unit"],
    );
    for (name, words, unit, value, key) in indices {
        let value = value.map_or_else(
            || "not seen in every direction".to_owned(),
            |value| figure(value, &format!("identifiability.observability.{key}")),
        );
        table.rows.push(vec![name.to_owned(), words.to_owned(), value, unit.to_owned()]);
    }
    page.heading("Observability");
    page.table(&table);
}
