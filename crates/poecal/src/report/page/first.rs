//! The first screen: verdict, what to look at, errors on rows that were not fitted, one picture; the same words as on the terminal.

use super::figures;
use super::html::{Html, Table, count, figure, path, quoted};
use super::trust::direction_words;
use crate::analysis::Direction;
use crate::calibration::{Level, ModelAccuracy, NoiseSource, SetAccuracy, Statistic};
use crate::io::calibration_file::{CalibrationFile, FrameWord, KindWord};
use crate::io::residuals::Residuals;
use crate::report::plot::escape;
use crate::report::summary::{Place, Point, expected_words, look_at};
use crate::report::table::STATISTICS;

/// A model: its word, and how to take it from a set.
type Model = (&'static str, fn(&SetAccuracy) -> &ModelAccuracy);

const MODELS: [Model; 3] = [
    ("nominal", |set| &set.nominal),
    ("registered", |set| &set.registered),
    ("calibrated", |set| &set.calibrated),
];

/// Names of the statistics in the file.
const STATISTIC_KEYS: [&str; 4] = ["mean", "rms", "p95", "max"];

pub(super) fn screen(page: &mut Html, file: &CalibrationFile, residuals: &Residuals) {
    page.raw("<header>");
    page.raw(&format!(
        "<h1>Calibration of {}</h1>\n<p class=\"made\">{} · made by poecal {}</p>",
        quoted(&file.robot.name, "robot.name"),
        kinds(file),
        quoted(&file.poecal_version, "poecal_version")
    ));
    page.raw("<div class=\"theme\" hidden role=\"group\" aria-label=\"Colours\"></div>\n</header>");
    verdict(page, file);
    page.raw("<div class=\"first\">\n<div>");
    let held_out = file.accuracy.held_out.as_ref();
    let of = if held_out.is_some() { "rows held out" } else { "the fitted rows, since none was held out" };
    page.table(&lead_table(&format!("Position error on {of}, mm"), file, "position_mm", |model| {
        Some(model.position_mm)
    }));
    let set = held_out.unwrap_or(&file.accuracy.training);
    if set.calibrated.rotation_deg.is_some() {
        let caption = format!("Rotation error on {of}, degrees");
        page.table(&lead_table(&caption, file, "rotation_deg", |model| model.rotation_deg));
    }
    if let (None, Some(found)) = (held_out, &file.cross_validation) {
        let rms = figure(found.random.position_rms_mm, "cross_validation.random.position_rms_mm");
        page.note(&format!("Cross-validation: {rms} mm (RMS) on rows that were not fitted."));
    }
    page.note(
        "<b>As drawn</b>: axes of the model, tool and measuring device fitted. <b>Calibrated</b>: the axes fitted too. The gain of the \
         calibration is the difference.",
    );
    facts(page, file, residuals);
    page.raw("</div>");
    let key = if held_out.is_some() { "accuracy.held_out.count" } else { "accuracy.training.count" };
    page.plots(
        &[figures::distributions(residuals, held_out.is_some())],
        &format!("{} {of}. Nominal: the model as delivered, registered: as drawn.", count(set.count, key)),
    );
    page.raw("</div>");
    contents(page, file);
}

/// Errors before and after, of the rows held out or, if there are none, of those fitted.
fn lead_table(
    caption: &str,
    file: &CalibrationFile,
    quantity: &str,
    of: fn(&ModelAccuracy) -> Option<Statistic>,
) -> Table {
    let (set, key, rest, rest_key, suspected) = match &file.accuracy.held_out {
        Some(set) => (
            set,
            "accuracy.held_out",
            &file.robust.held_out_without_suspected,
            "robust.held_out_without_suspected",
            file.robust.suspected_held_out,
        ),
        None => (
            &file.accuracy.training,
            "accuracy.training",
            &file.robust.training_without_suspected,
            "robust.training_without_suspected",
            file.robust.suspected_fit,
        ),
    };
    let drawn = match file.measurement_frame.known {
        FrameWord::Unknown => "as drawn, tool and device fitted",
        FrameWord::Base => "as drawn, tool fitted",
    };
    let mut rows = vec![
        (drawn.to_owned(), &set.registered, format!("{key}.registered")),
        ("calibrated".to_owned(), &set.calibrated, format!("{key}.calibrated")),
    ];
    if let Some(rest) = rest {
        let name = format!("calibrated, without {suspected} suspected");
        rows.push((name, &rest.calibrated, format!("{rest_key}.calibrated")));
    }
    let mut table = Table::new(caption, 1, &["", "mean", "RMS", "95 %", "max"]);
    for (name, model, key) in rows {
        let cells = STATISTICS.iter().zip(STATISTIC_KEYS).map(|((_, value), statistic)| {
            of(model)
                .map_or_else(String::new, |it| figure(value(&it), &format!("{key}.{quantity}.{statistic}")))
        });
        table.rows.push(std::iter::once(name).chain(cells).collect());
    }
    table
}

/// How many joints of which kind, and from where to where.
fn kinds(file: &CalibrationFile) -> String {
    let sliding = file.joints.iter().filter(|joint| joint.kind == KindWord::Prismatic).count();
    let words = [(file.joints.len() - sliding, "revolute"), (sliding, "prismatic")];
    let words: Vec<String> =
        words.iter().filter(|(count, _)| *count > 0).map(|(count, word)| format!("{count} {word}")).collect();
    format!(
        "{} joints, from {} to {}",
        words.join(", "),
        quoted(&file.robot.base_link, "robot.base_link"),
        quoted(&file.robot.tip_link, "robot.tip_link")
    )
}

fn verdict(page: &mut Html, file: &CalibrationFile) {
    let (class, words, reasons) = match &file.verdict {
        Some(verdict) => (verdict.level.word(), verdict_words(verdict.level), verdict.reasons.as_slice()),
        None => ("unknown", "No verdict: the calibration was written by an earlier version", [].as_slice()),
    };
    page.raw(&format!("<section class=\"verdict {class}\" aria-labelledby=\"verdict-title\">\n<h2 id=\"verdict-title\"><span class=\"sign\" aria-hidden=\"true\"></span>{words}</h2>"));
    if let Some(expected) = expected_words(file, figure) {
        page.text(&format!("E{}.", expected.trim_start_matches('e')));
    }
    // What speaks for the best verdict is what the line above says.
    let is_good = file.verdict.as_ref().is_some_and(|verdict| verdict.level == Level::Good);
    let reasons = reasons.iter().enumerate().filter(|_| !is_good);
    let reasons: Vec<String> =
        reasons.map(|(k, reason)| quoted(reason, &format!("verdict.reasons.{k}"))).collect();
    if !reasons.is_empty() {
        page.list(&reasons);
    }
    page.raw("</section>");
    let points: Vec<String> = look_at(file).iter().filter_map(|point| point_words(file, point)).collect();
    if !points.is_empty() {
        page.raw("<section class=\"doubts\" aria-labelledby=\"doubts-title\">\n<h2 id=\"doubts-title\">Look at</h2>");
        page.list(&points);
        page.raw("</section>");
    }
}

/// A point with the keys of what it quotes; nothing of reasons, which stand above.
fn point_words(file: &CalibrationFile, point: &Point) -> Option<String> {
    let direction = |degree: &str, list: &[Direction], name: &str, k: usize| {
        let found = list.get(k)?;
        Some(format!("{degree}: {}", direction_words(found, &format!("identifiability.{name}.{k}"))))
    };
    let known = &file.identifiability;
    match point.place {
        Place::Reason => None,
        Place::Diagnosis(k) => Some(quoted(&point.text, &format!("diagnosis.{k}.statement"))),
        Place::Warning(k) => Some(quoted(&point.text, &format!("warnings.{k}"))),
        Place::Suspects => Some(format!("<a href=\"#suspects\">{}</a>", escape(&point.text))),
        Place::Joint(k) => {
            let joint = file.corrections.get(k)?;
            let words = quoted(joint.suspicious.as_deref()?, &format!("corrections.{k}.suspicious"));
            Some(format!("{}: {words}", quoted(&joint.joint, &format!("corrections.{k}.joint"))))
        }
        Place::Open(k) => direction("unknown", &known.unidentifiable, "unidentifiable", k),
        Place::Weak(k) => direction("weak", &known.weak, "weak", k),
    }
}

fn verdict_words(level: Level) -> &'static str {
    match level {
        Level::Good => "Good to use anywhere within the limits",
        Level::InsideSampledRange => "Use it inside the sampled range only",
        Level::DoNotUse => "Do not use this calibration",
    }
}

/// Errors of position of the three models.
pub(super) fn position_table(caption: &str, set: &SetAccuracy, key: &str) -> Table {
    error_table(caption, set, key, "position_mm", |model| Some(model.position_mm))
}

/// Errors of rotation, where orientation was measured.
pub(super) fn rotation_table(caption: &str, set: &SetAccuracy, key: &str) -> Option<Table> {
    set.calibrated.rotation_deg?;
    Some(error_table(caption, set, key, "rotation_deg", |model| model.rotation_deg))
}

fn error_table(
    caption: &str,
    set: &SetAccuracy,
    key: &str,
    quantity: &str,
    of: fn(&ModelAccuracy) -> Option<Statistic>,
) -> Table {
    let mut table = Table::new(caption, 1, &["", "nominal", "registered", "calibrated"]);
    for ((label, value), statistic) in STATISTICS.iter().zip(STATISTIC_KEYS) {
        let cells = MODELS.iter().map(|(name, model)| {
            of(model(set)).map_or_else(String::new, |it| {
                figure(value(&it), &format!("{key}.{name}.{quantity}.{statistic}"))
            })
        });
        table.rows.push(std::iter::once((*label).to_owned()).chain(cells).collect());
    }
    table
}

fn facts(page: &mut Html, file: &CalibrationFile, residuals: &Residuals) {
    let files = file.inputs.measurements.iter().enumerate();
    let files: Vec<String> = files.map(|(k, name)| path(name, &format!("inputs.measurements.{k}"))).collect();
    let orientations = residuals.rows.iter().filter(|row| row.rotation_deg.is_some()).count();
    let kinds = match (orientations, residuals.rows.len() - orientations) {
        (poses, 0) => format!("{poses} poses"),
        (0, points) => format!("{points} points"),
        (poses, points) => format!("{poses} poses and {points} points"),
    };
    let held_out = file.accuracy.held_out.as_ref();
    let held_out = held_out.map_or("none".to_owned(), |set| count(set.count, "accuracy.held_out.count"));
    let targets = if residuals.targets.len() > 1 {
        format!(" of {} targets", residuals.targets.len())
    } else {
        String::new()
    };
    let mut facts = vec![
        ("Model", path(&file.inputs.model, "inputs.model")),
        ("Measurements", files.join("<br>")),
        (
            "Rows",
            format!(
                "{kinds}{targets}: {} fitted, {held_out} held out",
                count(file.accuracy.training.count, "accuracy.training.count")
            ),
        ),
        ("Noise", noise(file)),
    ];
    if let Some(uncertainty) = &file.uncertainty {
        let measured =
            figure(uncertainty.measured.sigma_position_mm, "uncertainty.measured.sigma_position_mm");
        let range = figure(uncertainty.range.sigma_position_mm, "uncertainty.range.sigma_position_mm");
        facts.push((
            "Expected error",
            format!(
                "{measured} mm (RMS) at the measured configurations, {range} mm anywhere within the limits"
            ),
        ));
    }
    page.facts(&facts);
}

fn noise(file: &CalibrationFile) -> String {
    let source = match file.noise.source {
        NoiseSource::Rows => return "as each row states it".to_owned(),
        NoiseSource::Exact => return "none: the fit leaves nothing but rounding".to_owned(),
        NoiseSource::Given => "as given",
        NoiseSource::Estimated => "estimated from the fit",
    };
    let position = figure(file.noise.sigma_position_mm, "noise.sigma_position_mm");
    let rotation = file.noise.sigma_rotation_deg;
    let rotation = rotation
        .map_or_else(String::new, |sigma| format!(", {}°", figure(sigma, "noise.sigma_rotation_deg")));
    format!("{position} mm{rotation} each component, {source}")
}

fn contents(page: &mut Html, file: &CalibrationFile) {
    let repeated = file.repeatability.as_ref().map(|_| ("repeatability", "Repeatability"));
    let sections = [
        ("view", "In 3D"),
        ("joints", "Joints"),
        ("errors", "Errors of the rows"),
        ("suspects", "Suspected rows"),
    ];
    let rest =
        [("trust", "How far to trust it"), ("told", "What the data tell"), ("method", "Method and inputs")];
    let links = sections.into_iter().chain(repeated).chain(rest);
    let links: Vec<String> =
        links.map(|(id, title)| format!("<a href=\"#{id}\">{}</a>", escape(title))).collect();
    page.raw(&format!("<nav aria-label=\"Contents\">{}</nav>", links.join(" ")));
}
