//! The first screen: robot, data, verdict, errors on rows that were not fitted, one picture.

use super::figures;
use super::html::{Html, Table, count, figure, path, quoted};
use crate::calibration::{Level, ModelAccuracy, NoiseSource, SetAccuracy, Statistic};
use crate::io::calibration_file::{CalibrationFile, KindWord};
use crate::io::residuals::Residuals;
use crate::report::plot::escape;
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
    let (set, key, of) = match held_out {
        Some(set) => (set, "accuracy.held_out", "rows that were not fitted"),
        None => (&file.accuracy.training, "accuracy.training", "the fitted rows, since none was held out"),
    };
    page.table(&position_table(&format!("Position error on {of}, mm"), set, key));
    if let Some(table) = rotation_table(&format!("Rotation error on {of}, degrees"), set, key) {
        page.table(&table);
    }
    page.note(
        "<b>Nominal</b>: the model as delivered. <b>Registered</b>: tool and measuring device found too. <b>Calibrated</b>: the joints' \
         axes found too. What calibrating this robot gained is calibrated against registered.",
    );
    facts(page, file, residuals);
    page.raw("</div>");
    page.plots(
        &[figures::distributions(residuals, held_out.is_some())],
        &format!("{} {of}.", count(set.count, &format!("{key}.count"))),
    );
    page.raw("</div>");
    contents(page, file);
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
    let reasons = reasons.iter().enumerate();
    let reasons: Vec<String> =
        reasons.map(|(k, reason)| quoted(reason, &format!("verdict.reasons.{k}"))).collect();
    page.list(&reasons);
    page.raw("</section>");
    let warnings = file.warnings.iter().enumerate().map(|(k, text)| quoted(text, &format!("warnings.{k}")));
    let stated =
        |text: &str| file.verdict.as_ref().is_some_and(|verdict| verdict.reasons.iter().any(|it| it == text));
    let found = file.diagnosis.iter().enumerate().filter(|(_, found)| !stated(&found.statement));
    let found = found.map(|(k, found)| quoted(&found.statement, &format!("diagnosis.{k}.statement")));
    let doubts: Vec<String> = warnings.chain(found).collect();
    if !doubts.is_empty() {
        page.raw("<section class=\"doubts\" aria-labelledby=\"doubts-title\">\n<h2 id=\"doubts-title\">Look at this first</h2>");
        page.list(&doubts);
        page.raw("</section>");
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
            "To expect",
            format!("{measured} mm (RMS) where it was measured, {range} mm anywhere within the limits"),
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
