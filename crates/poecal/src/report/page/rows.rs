//! What the rows leave: charts of them, tables with the same facts, suspected rows, and configurations that were measured several times.

use super::data::{MOST_ROWS, drawn, keep_first, place, short};
use super::first::{position_table, rotation_table};
use super::html::{Html, Table, count, decimal, figure};
use super::{figures, readings_of};
use crate::calibration::Statistic;
use crate::io::calibration_file::{CalibrationFile, OutlierSet};
use crate::io::residuals::{Judged, ResidualRow, Residuals};
use crate::report::plot::escape;
use crate::report::table::number;
use crate::threads;

/// Suspected rows, rows of large leverage and repeated poses that a table lists at most.
const LISTED: usize = 50;
const LEVERAGES: usize = 10;
/// Parts of a joint's values by which errors are stated.
const PARTS: usize = 6;

pub(super) fn sections(page: &mut Html, file: &CalibrationFile, residuals: &Residuals) {
    errors(page, file, residuals);
    suspects(page, file, residuals);
    repeatability(page, file, residuals);
}

fn errors(page: &mut Html, file: &CalibrationFile, residuals: &Residuals) {
    page.section("errors", "Errors of the rows");
    page.text("What the calibrated model leaves of each measurement: measured less predicted, in the axes of the measuring device.");
    let shown = drawn(residuals).len();
    if shown < residuals.rows.len() {
        page.note(&format!(
            "Charts draw {shown} of {} rows: the suspected ones, those furthest off, and others at equal distances, {MOST_ROWS} at most. Histogram, \
             normal plot and smoothed curves are of the evenly chosen ones alone. Tables count every row.",
            residuals.rows.len()
        ));
    }
    page.chart("rows", "By row", "A dot for each row in the order read. A drift or a step here is a session that changed: a tool knocked, a device moved.");
    page.chart(
        "components",
        "By component",
        "Residuals along the device's axes. A mean away from zero in held-out rows is a frame that moved.",
    );
    page.folded_table("The components as numbers", &component_table(residuals));
    page.chart(
        "joints",
        "By joint",
        "Residuals over each joint's value, with a smoothed curve. A curve that swings, once or twice a turn or as a gear repeats, is an error of a gear or an \
         encoder that the model does not describe; one that bends with the load is a link that gives.",
    );
    page.folded_table("Errors by parts of each joint's values", &joint_table(residuals));
    page.raw("<div class=\"pair\">");
    page.chart(
        "histogram",
        "How the errors are spread",
        "Position errors of fitted and held-out rows, each as shares of its own rows.",
    );
    page.chart(
        "normal",
        "Normal plot of the components",
        "Components of position, ordered, against where those of a normal distribution would be. On the line they are noise; ends that \
         bend away are wrong rows or errors that the model does not describe.",
    );
    page.raw("</div>");
    page.heading("Fitted against held-out rows");
    page.raw("<div class=\"pair\">");
    page.plots(
        &[figures::sets(residuals)],
        "Fitted rows are always predicted a little better than others; only held-out ones are a promise.",
    );
    set_tables(page, file);
    page.raw("</div>");
    page.chart(
        "leverage",
        "Leverage",
        "To the right: rows that pull the fit to themselves. Above: rows that are far off, in units of their own standard deviation. \
         A row that is both decides the result alone.",
    );
    if let Some(table) = leverage_table(residuals) {
        page.folded_table("The rows of largest leverage", &table);
    }
    page.end_section();
}

fn set_tables(page: &mut Html, file: &CalibrationFile) {
    let mut sets = vec![("fitted rows", "accuracy.training", Some(&file.accuracy.training))];
    sets.push(("held-out rows", "accuracy.held_out", file.accuracy.held_out.as_ref()));
    let robust = &file.robust;
    sets.push((
        "fitted rows without the suspected",
        "robust.training_without_suspected",
        robust.training_without_suspected.as_ref(),
    ));
    sets.push((
        "held-out rows without the suspected",
        "robust.held_out_without_suspected",
        robust.held_out_without_suspected.as_ref(),
    ));
    page.raw("<div class=\"tables\">");
    for (words, key, set) in sets.into_iter().filter_map(|(words, key, set)| Some((words, key, set?))) {
        page.table(&position_table(&format!("Position error, mm: {} {words}", set.count), set, key));
        if let Some(table) =
            rotation_table(&format!("Rotation error, degrees: {} {words}", set.count), set, key)
        {
            page.table(&table);
        }
    }
    page.raw("</div>");
}

/// Mean and spread of each component.
fn component_table(residuals: &Residuals) -> Table {
    let mut table =
        Table::new("Residuals by component", 2, &["component", "rows", "number", "mean", "RMS", "largest"]);
    let turned = residuals.rows.iter().any(|row| row.rotation_deg.is_some());
    let parts = if turned { 2 } else { 1 };
    let rows = threads::map_parts_of(residuals.rows.len(), 6 * parts, |index| {
        let (part, component, (set, held_out)) =
            (index / 6, index / 2 % 3, [("fitted", false), ("held out", true)][index % 2]);
        let of = |row: &ResidualRow| {
            let errors = if part == 0 { Some(row.position_mm) } else { row.rotation_deg };
            errors.map(|errors| errors.residual[component])
        };
        let name = [["x, mm", "y, mm", "z, mm"], ["about x, °", "about y, °", "about z, °"]][part][component];
        let values: Vec<f64> =
            residuals.rows.iter().filter(|row| row.held_out == held_out).filter_map(of).collect();
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        let found = Statistic::of(values.iter().map(|value| value.abs()).collect())?;
        let sign = if mean < 0.0 { "−" } else { "" };
        Some(vec![
            name.to_owned(),
            set.to_owned(),
            values.len().to_string(),
            format!("{sign}{}", number(mean.abs())),
            number(found.rms),
            number(found.max),
        ])
    });
    table.rows.extend(rows.into_iter().flatten());
    table
}

/// Errors by equal parts of what was sampled of each joint.
fn joint_table(residuals: &Residuals) -> Table {
    let mut table = Table::new(
        "Position error of the calibrated model, mm (RMS), and number of rows by parts of each reading",
        1,
        &["reading", "from", "to", "rows", "RMS"],
    );
    let readings: Vec<_> = readings_of(residuals).collect();
    let rows = threads::map_parts_of(residuals.rows.len(), readings.len(), |reading| {
        let (index, name, unit) = &readings[reading];
        let value = |row: usize| residuals.values(row).get(*index).copied();
        let values = || (0..residuals.rows.len()).filter_map(value);
        let (least, most) =
            values().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        let width = (most - least) / PARTS as f64;
        if width.is_nan() || width <= 0.0 {
            return Vec::new();
        }
        let mut sums = [(0usize, 0.0); PARTS];
        for (k, row) in residuals.rows.iter().enumerate() {
            let part = value(k).map(|value| (((value - least) / width) as usize).min(PARTS - 1));
            if let Some(sum) = part.and_then(|part| sums.get_mut(part)) {
                sum.0 += 1;
                sum.1 += row.position_mm.models[2].powi(2);
            }
        }
        let row = |(part, (rows, sum)): (usize, &(usize, f64))| {
            let end = |part: usize| format!("{} {unit}", decimal(least + width * part as f64, 1));
            let rms = if *rows > 0 { number((sum / *rows as f64).sqrt()) } else { "–".to_owned() };
            vec![escape(name), end(part), end(part + 1), rows.to_string(), rms]
        };
        sums.iter().enumerate().map(row).collect::<Vec<_>>()
    });
    table.rows.extend(rows.into_iter().flatten());
    table
}

/// The place of a row as the calibration file has it; rows that came from no file have none.
fn named(residuals: &Residuals, file: &str, row: u32, key: &str) -> String {
    match file {
        "" => "–".to_owned(),
        file => format!("{}:{}", escape(short(&residuals.files, file)), count(row as usize, key)),
    }
}

fn leverage_table(residuals: &Residuals) -> Option<Table> {
    let judged = residuals.rows.iter().enumerate().filter_map(|(k, row)| Some((k, row.judged?)));
    let mut judged: Vec<_> = judged.filter(|(_, found)| found.leverage.is_finite()).collect();
    let larger =
        |a: &(usize, Judged), b: &(usize, Judged)| b.1.leverage.total_cmp(&a.1.leverage).then(a.0.cmp(&b.0));
    keep_first(&mut judged, LEVERAGES, larger);
    judged.sort_unstable_by(larger);
    let mut table = Table::new(
        "Rows of largest leverage",
        2,
        &["row", "set", "leverage", "studentised residual", "weight"],
    );
    for (k, found) in &judged {
        let set = if residuals.rows.get(*k).is_some_and(|row| row.held_out) { "held out" } else { "fitted" };
        table.rows.push(vec![
            escape(&place(residuals, *k)),
            set.to_owned(),
            number(found.leverage),
            number(found.studentized),
            number(found.weight),
        ]);
    }
    (!judged.is_empty()).then_some(table)
}

fn suspects(page: &mut Html, file: &CalibrationFile, residuals: &Residuals) {
    page.section("suspects", "Suspected rows");
    let robust = &file.robust;
    let fit = match robust.loss {
        Some(loss) => {
            format!("The fit was made by the {} loss, which keeps such rows from spoiling it.", loss.word())
        }
        None => "The fit was made by least squares.".to_owned(),
    };
    if robust.suspected_fit + robust.suspected_held_out == 0 {
        page.text(&format!("No row is suspected to be grossly wrong. {fit}"));
        page.end_section();
        return;
    }
    page.text(&format!(
        "{} fitted and {} held-out rows are too far off to be noise. {fit} <b>Studentised</b> is the length of the residual in units of its own standard deviation, \
         <b>weight</b> what the row counted in the fit (or would have). Look whether a mirror was knocked, or a target mistaken.",
        count(robust.suspected_fit, "robust.suspected_fit"),
        count(robust.suspected_held_out, "robust.suspected_held_out")
    ));
    let turned = file.outliers.iter().any(|it| it.residual_deg.is_some());
    let mut head = vec!["row", "set", "off by, mm"];
    head.extend(turned.then_some("off by, °"));
    head.extend(["studentised", "weight"]);
    let mut table = Table::new("Rows that are suspected to be grossly wrong, the worst first", 2, &head);
    for (k, found) in file.outliers.iter().take(LISTED).enumerate() {
        let key = |name: &str| format!("outliers.{k}.{name}");
        let set = match found.set {
            OutlierSet::Fit => "fitted",
            OutlierSet::HeldOut => "held out",
        };
        let place = named(residuals, &found.file, found.row, &key("row"));
        let mut cells = vec![place, set.to_owned(), figure(found.residual_mm, &key("residual_mm"))];
        if turned {
            cells.push(
                found.residual_deg.map_or_else(|| "–".to_owned(), |it| figure(it, &key("residual_deg"))),
            );
        }
        cells.extend([figure(found.studentized, &key("studentized")), figure(found.weight, &key("weight"))]);
        table.rows.push(cells);
    }
    page.table(&table);
    if file.outliers.len() > LISTED {
        page.note(&format!("The table has the {LISTED} worst; <code>calibration.json</code> and <code>residuals.csv</code> have the others."));
    }
    page.end_section();
}

fn repeatability(page: &mut Html, file: &CalibrationFile, residuals: &Residuals) {
    let Some(found) = &file.repeatability else { return };
    page.section("repeatability", "Repeatability");
    page.text(&format!(
        "{} poses were measured three times or more ({} rows). In the manner of ISO 9283, <b>accuracy</b> is the distance from where a model \
         says to the mean of the measured positions, and <b>repeatability</b> the mean distance of these from their mean, and three standard \
         deviations of it. ISO 9283 asks for 30 rows a pose, each approached anew; rows of a robot that stood still tell of the device alone.",
        count(found.poses, "repeatability.poses"),
        count(found.rows, "repeatability.rows")
    ));
    let head = ["pose", "rows", "accuracy, nominal", "registered", "calibrated", "repeatability"];
    let mut table = Table::new("Pose accuracy and repeatability, mm", 1, &head);
    let key = |name: &str| format!("repeatability.{name}");
    table.rows.push(vec![
        "mean of all".to_owned(),
        count(found.rows, &key("rows")),
        figure(found.accuracy_nominal_mm, &key("accuracy_nominal_mm")),
        figure(found.accuracy_registered_mm, &key("accuracy_registered_mm")),
        figure(found.accuracy_calibrated_mm, &key("accuracy_calibrated_mm")),
        figure(found.repeatability_mm, &key("repeatability_mm")),
    ]);
    let worst = figure(found.worst_repeatability_mm, &key("worst_repeatability_mm"));
    for (k, pose) in found.listed.iter().take(LISTED).enumerate() {
        let key = |name: &str| format!("repeatability.listed.{k}.{name}");
        table.rows.push(vec![
            named(residuals, &pose.file, pose.row, &key("row")),
            count(pose.rows, &key("rows")),
            figure(pose.accuracy_nominal_mm, &key("accuracy_nominal_mm")),
            figure(pose.accuracy_registered_mm, &key("accuracy_registered_mm")),
            figure(pose.accuracy_calibrated_mm, &key("accuracy_calibrated_mm")),
            figure(pose.repeatability_mm, &key("repeatability_mm")),
        ]);
    }
    page.table(&table);
    page.note(&format!("The worst repeatability is {worst} mm. A pose is named by its first row."));
    page.end_section();
}
