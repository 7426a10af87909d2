//! What the rows leave: charts of them, tables with the same facts, suspected rows, and configurations that were measured several times.

use maud::{Markup, Render, html};

use super::data::{MOST_ROWS, drawn, keep_first, place};
use super::first::{error_table, error_words};
use super::html::{HtmlTable, chart, count, decimal, figure, figure_or, folded, plots, section};
use super::{figures, readings_of, short};
use crate::calibration::Statistic;
use crate::io::calibration_file::{CalibrationFile, OutlierSet};
use crate::io::residuals::{ResidualRow, Residuals, RowDiagnostics};
use crate::report::table::number;
use crate::threads;

/// Suspected rows, rows of large leverage and repeated poses that a table lists at most.
const LISTED: usize = 50;
const LEVERAGES: usize = 10;
/// Parts of a joint's values by which errors are stated.
const PARTS: usize = 6;

pub(super) fn sections(file: &CalibrationFile, residuals: &Residuals) -> Markup {
    html! { (errors(file, residuals)) (suspects(file, residuals)) (repeatability(file, residuals)) }
}

fn errors(file: &CalibrationFile, residuals: &Residuals) -> Markup {
    let (shown, all) = (drawn(residuals).len(), residuals.rows.len());
    let content = html! {
        p { "Residual of each measurement: measured minus predicted by the calibrated model, in the axes of the measuring device." }
        @if shown < all {
            p.note {
                "Charts draw " (shown) " of " (all) " rows: the suspected ones, those of the largest errors, and others at equal distances, "
                (MOST_ROWS) " at most. Histogram, normal plot and smoothed curves are of the evenly chosen ones alone. Tables count every row."
            }
        }
        (chart("rows", "By row", "A dot for each row in the order read. A drift or a step shows a change during the session: a tool knocked, a device moved."))
        (chart("components", "By component", "Residuals along the device's axes. A mean away from zero in held-out rows shows a frame that moved."))
        (folded("The components as numbers", &component_table(residuals)))
        (chart(
            "joints",
            "By joint",
            "Residuals over each joint's value, with a smoothed curve. A periodic curve (once or twice a turn, or with the period of a gear) is an error of a \
             gear or an encoder that is not modelled; a curve that follows the load is a flexible link.",
        ))
        (folded("Errors by parts of each joint's values", &joint_table(residuals)))
        div.pair {
            (chart("histogram", "How the errors are spread", "Position errors of fitted and held-out rows, each as shares of its own rows."))
            (chart(
                "normal",
                "Normal plot of the components",
                "Components of position, ordered, against where those of a normal distribution would be. On the line they are noise; ends that \
                 bend away are gross errors or errors that the model does not describe.",
            ))
        }
        h3 { "Fitted against held-out rows" }
        div.pair {
            (plots(
                &[figures::sets(residuals)],
                "Fitted rows are always predicted a little better than others; only held-out rows measure the error of predictions.",
            ))
            (set_tables(file))
        }
        (chart(
            "leverage",
            "Leverage",
            "To the right: rows of high leverage. Above: rows of large residuals, in units of their own standard deviation. \
             A row with both decides much of the result, unless it is suspected and has almost no weight.",
        ))
        @if let Some(table) = leverage_table(residuals) { (folded("The rows of largest leverage", &table)) }
    };
    section("errors", "Errors of the rows", &content)
}

/// Errors of all sets, with and without suspected rows.
fn set_tables(file: &CalibrationFile) -> Markup {
    let (accuracy, robust) = (&file.accuracy, &file.robust);
    let without =
        [&robust.training_without_suspected, &robust.held_out_without_suspected].map(Option::as_ref);
    let sets = [
        ("fitted rows", "accuracy.training", Some(&accuracy.training)),
        ("held-out rows", "accuracy.held_out", accuracy.held_out.as_ref()),
        ("fitted rows without the suspected", "robust.training_without_suspected", without[0]),
        ("held-out rows without the suspected", "robust.held_out_without_suspected", without[1]),
    ];
    html! {
        div.tables {
            @for (words, key, set) in sets.into_iter().filter_map(|(words, key, set)| Some((words, key, set?))) {
                @for (quantity, _) in set.calibrated.iter() {
                    (error_table(&format!("{}: {} {words}", error_words(quantity, ""), set.count), set, key, quantity))
                }
            }
        }
    }
}

/// Mean and spread of each component.
fn component_table(residuals: &Residuals) -> HtmlTable {
    let mut table = HtmlTable::new(
        "Residuals by component",
        2,
        &["component", "rows", "number", "mean", "RMS", "largest"],
    );
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
        let mean = format!("{sign}{}", number(mean.abs()));
        Some([
            name.to_owned(),
            set.to_owned(),
            values.len().to_string(),
            mean,
            number(found.rms),
            number(found.max),
        ])
    });
    rows.into_iter().flatten().for_each(|cells| table.cells(cells));
    table
}

/// Errors by equal parts of what was sampled of each joint.
fn joint_table(residuals: &Residuals) -> HtmlTable {
    let mut table = HtmlTable::new(
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
            [(*name).to_owned(), end(part), end(part + 1), rows.to_string(), rms]
        };
        sums.iter().enumerate().map(row).collect::<Vec<_>>()
    });
    rows.into_iter().flatten().for_each(|cells| table.cells(cells));
    table
}

/// The place of a row as the calibration file has it; rows that came from no file have none.
fn named(residuals: &Residuals, file: &str, row: u32, key: impl Render) -> Markup {
    match file {
        "" => html! { "–" },
        file => html! { (short(&residuals.files, file)) ":" (count(row as usize, key)) },
    }
}

fn leverage_table(residuals: &Residuals) -> Option<HtmlTable> {
    let judged = residuals.rows.iter().enumerate().filter_map(|(k, row)| Some((k, row.judged?)));
    let mut judged: Vec<_> = judged.filter(|(_, found)| found.leverage.is_finite()).collect();
    let larger = |a: &(usize, RowDiagnostics), b: &(usize, RowDiagnostics)| {
        b.1.leverage.total_cmp(&a.1.leverage).then(a.0.cmp(&b.0))
    };
    keep_first(&mut judged, LEVERAGES, larger);
    judged.sort_unstable_by(larger);
    let mut table = HtmlTable::new(
        "Rows of largest leverage",
        2,
        &["row", "set", "leverage", "studentised residual", "weight"],
    );
    for (k, found) in &judged {
        let set = if residuals.rows.get(*k).is_some_and(|row| row.held_out) { "held out" } else { "fitted" };
        let numbers = [found.leverage, found.studentized, found.weight].map(number);
        table.row(&[&place(residuals, *k), &set, &numbers[0], &numbers[1], &numbers[2]]);
    }
    (!judged.is_empty()).then_some(table)
}

fn suspects(file: &CalibrationFile, residuals: &Residuals) -> Markup {
    let robust = &file.robust;
    let fit = html! {
        @match robust.loss {
            Some(loss) => { "The fit was made by the " (loss.word()) " loss, which limits the influence of outliers." }
            None => { "The fit was made by least squares." }
        }
    };
    let content = html! {
        @if robust.suspected_fit + robust.suspected_held_out == 0 {
            p { "No row is a suspected outlier. " (fit) }
        } @else {
            p {
                (count(robust.suspected_fit, "robust.suspected_fit")) " fitted and "
                (count(robust.suspected_held_out, "robust.suspected_held_out"))
                " held-out rows have residuals too large for noise. " (fit) " " b { "Studentised" }
                " is the length of the residual in units of its own standard deviation, " b { "weight" }
                " is that of the row in the fit (or what it would be). Check whether a reflector was knocked, or two were confused."
            }
            (suspect_table(file, residuals))
            @if file.outliers.len() > LISTED {
                p.note {
                    "The table has the " (LISTED) " worst; " code { "calibration.json" } " and " code { "residuals.csv" } " have the others."
                }
            }
        }
    };
    section("suspects", "Suspected rows", &content)
}

fn suspect_table(file: &CalibrationFile, residuals: &Residuals) -> HtmlTable {
    let turned = file.outliers.iter().any(|it| it.residual_deg.is_some());
    let mut head = vec!["row", "set", "off by, mm"];
    head.extend(turned.then_some("off by, °"));
    head.extend(["studentised", "weight"]);
    let mut table = HtmlTable::new("Suspected outliers, the worst first", 2, &head);
    for (k, found) in file.outliers.iter().take(LISTED).enumerate() {
        let figure = |value, name| figure_or(value, format_args!("outliers.{k}.{name}"), "–");
        let set = match found.set {
            OutlierSet::Fit => "fitted",
            OutlierSet::HeldOut => "held out",
        };
        let place = named(residuals, &found.file, found.row, format_args!("outliers.{k}.row"));
        let mut cells = vec![place, set.render(), figure(Some(found.residual_mm), "residual_mm")];
        cells.extend(turned.then(|| figure(found.residual_deg, "residual_deg")));
        cells.extend([figure(Some(found.studentized), "studentized"), figure(Some(found.weight), "weight")]);
        table.cells(cells);
    }
    table
}

fn repeatability(file: &CalibrationFile, residuals: &Residuals) -> Markup {
    let Some(found) = &file.repeatability else { return Markup::default() };
    let head = ["pose", "rows", "accuracy, nominal", "registered", "calibrated", "repeatability"];
    let mut table = HtmlTable::new("Pose accuracy and repeatability, mm", 1, &head);
    table.row(&[
        &"mean of all",
        &count(found.rows, "repeatability.rows"),
        &figure(found.accuracy_nominal_mm, "repeatability.accuracy_nominal_mm"),
        &figure(found.accuracy_registered_mm, "repeatability.accuracy_registered_mm"),
        &figure(found.accuracy_calibrated_mm, "repeatability.accuracy_calibrated_mm"),
        &figure(found.repeatability_mm, "repeatability.repeatability_mm"),
    ]);
    for (k, pose) in found.listed.iter().take(LISTED).enumerate() {
        let figure = |value, name| figure(value, format_args!("repeatability.listed.{k}.{name}"));
        table.row(&[
            &named(residuals, &pose.file, pose.row, format_args!("repeatability.listed.{k}.row")),
            &count(pose.rows, format_args!("repeatability.listed.{k}.rows")),
            &figure(pose.accuracy_nominal_mm, "accuracy_nominal_mm"),
            &figure(pose.accuracy_registered_mm, "accuracy_registered_mm"),
            &figure(pose.accuracy_calibrated_mm, "accuracy_calibrated_mm"),
            &figure(pose.repeatability_mm, "repeatability_mm"),
        ]);
    }
    let content = html! {
        p {
            (count(found.poses, "repeatability.poses")) " poses were measured three times or more ("
            (count(found.rows, "repeatability.rows")) " rows). In the manner of ISO 9283, " b { "accuracy" }
            " is the distance from where a model says to the mean of the measured positions, and " b { "repeatability" }
            " the mean distance of these from their mean, and three standard deviations of it. ISO 9283 asks for 30 rows a pose, each \
             approached again; rows of a robot that stood still show the device's repeatability only."
        }
        (table)
        p.note {
            "The worst repeatability is " (figure(found.worst_repeatability_mm, "repeatability.worst_repeatability_mm"))
            " mm. A pose is named by its first row."
        }
    };
    section("repeatability", "Repeatability", &content)
}
