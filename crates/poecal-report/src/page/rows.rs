//! The residuals: charts of them, tables with the same facts, suspected rows, and configurations that were measured several times.

use maud::{Markup, Render, html};

use super::charts::{Charts, by_joint, chart};
use super::data::{MOST_ROWS, keep_first, place};
use super::devices::devices;
use super::errors::{error_table, error_words};
use super::html::{HtmlTable, capital, count, decimal, figure, figure_or, fold_table, section};
use super::leading_error::{LeadingError, component_words, sign, spaced_unit};
use super::{figures, readings_of, short_name};
use crate::summary::delivered_name;
use crate::table::{further_words, number};
use poecal_calibrate::Statistic;
use poecal_model::measurement::{Device, Quantity};
use poecal_numerics::error::Result;
use poecal_numerics::threads;
use poecal_results::calibration_file::{CalibrationFile, OutlierSet, RepeatabilityEntry};
use poecal_results::residuals::{ResidualRow, Residuals, RowDiagnostics};

/// Suspected rows, rows of large leverage and repeated poses that a table lists at most.
const LISTED: usize = 50;
const LEVERAGES: usize = 10;
/// Parts of a joint's values by which errors are stated.
const PARTS: usize = 6;

pub(crate) fn sections(file: &CalibrationFile, charts: &Charts<'_>) -> Result<Markup> {
    let residuals = charts.residuals;
    Ok(html! { (errors(file, charts)?) (suspects(file, residuals)) (repeatability(file, residuals)) })
}

fn errors(file: &CalibrationFile, charts: &Charts<'_>) -> Result<Markup> {
    let residuals = charts.residuals;
    let (shown, all) = (charts.rows.len(), residuals.rows().len());
    let few = charts.rows.iter().filter(|row| row.few).count();
    let lead = charts.lead.name();
    let by_joint = by_joint(charts, file)?;
    let content = html! {
        p { "Residual of each measurement: measured minus predicted by the " (delivered_name(file)) " model" (axes_words(file, residuals)) "." }
        @if shown < all {
            p.note {
                "Charts draw " (shown) " of " (all) " rows: the suspected ones, those of the largest errors, and others at equal distances, "
                (MOST_ROWS) " at most. Histogram, normal plot and smoothed curves are of the evenly chosen ones alone. Tables count every row."
            }
        }
        @if few < shown {
            p.note {
                "The small charts, by component and by joint, draw " (few) " of the " (all) " rows: suspected ones, those of the largest errors, and \
                 others at equal distances."
            }
        }
        (chart(
            "rows",
            "By row",
            "A dot for each row in the order read. A drift or a step shows a change during the session: a tool knocked, a device moved.",
            &charts.by_row(),
        ))
        (chart("components", "By component", &component_note(residuals), &charts.by_component()))
        (fold_table("The components as numbers", &component_table(residuals)))
        (chart(
            "joints",
            "By joint",
            "Residuals over each joint's value, with a smoothed curve and one standard deviation to each side of it. A periodic curve (once or twice a turn, or with the period of a gear) is an error of a \
             gear or an encoder that is not modelled; a curve that follows the load is a flexible link.",
            &by_joint,
        ))
        (fold_table("Errors by parts of each joint's values", &joint_table(file, residuals)))
        div.pair {
            (chart(
                "histogram",
                "How the errors are spread",
                &format!("Errors of {lead} in fitted and held-out rows, each as shares of its own rows."),
                &charts.histogram(),
            ))
            figure {
                h3 { "Fitted against held-out rows" }
                div.plots { (figures::sets(file, residuals)) }
                figcaption { "Fitted rows are always predicted a little better than others; only held-out rows measure the error of predictions." }
            }
        }
        details { summary { "The errors of both sets as numbers" } (set_tables(file)) }
    };
    Ok(section("errors", "Errors of the rows", &content))
}

/// Details for few readers: comparison of the errors with noise, and the rows with a large influence on the result.
pub(crate) fn for_the_metrologist(charts: &Charts<'_>) -> Markup {
    let lead = charts.lead.name();
    html! {
        div.pair {
            (chart(
                "normal",
                "Normal plot of the components",
                &format!(
                    "Components of {lead}, ordered, against where those of a normal distribution would be. On the line they are noise; ends \
                     that bend away are gross errors or errors that the model does not describe."
                ),
                &charts.normal(),
            ))
            (chart(
                "leverage",
                "Leverage",
                "Fitted rows, in the fit of the joint axes. To the right: rows of high leverage. Above: rows of large residuals, in units of their own standard deviation. \
                 A row with both decides much of the result, unless it is suspected and has almost no weight.",
                &charts.leverage(),
            ))
        }
        @if let Some(table) = leverage_table(charts.residuals) { (fold_table("The fitted rows of largest leverage", &table)) }
    }
}

/// Axes of the residuals, if they have any.
fn axes_words(file: &CalibrationFile, residuals: &Residuals) -> &'static str {
    let has_axes = residuals.measured_quantities().iter().any(|it| it.is_of_pose());
    match (has_axes, devices(file) == [Device::Pair]) {
        (false, _) => "",
        (true, false) => ", in the axes of the measuring device",
        (true, true) => ", in the axes of the target in the first of the two configurations",
    }
}

/// Meaning of the components of each quantity.
fn component_note(residuals: &Residuals) -> String {
    let all: Vec<&str> = residuals.measured_quantities().iter().map(|it| it.residual_words()).collect();
    format!(
        "Residuals {}. A mean away from zero in held-out rows shows that something moved: the device, what it is fixed to, the tool.",
        all.join("; ")
    )
}

/// Errors of all sets, with and without suspected rows.
fn set_tables(file: &CalibrationFile) -> Markup {
    let (accuracy, robust) = (&file.accuracy, &file.robust);
    let without = [&robust.without_suspected.training, &robust.without_suspected.held_out].map(Option::as_ref);
    let sets = [
        ("fitted rows", "accuracy.training", Some(&accuracy.training)),
        ("held-out rows", "accuracy.held_out", accuracy.held_out.as_ref()),
        ("fitted rows without the suspected", "robust.without_suspected.training", without[0]),
        ("held-out rows without the suspected", "robust.without_suspected.held_out", without[1]),
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
    let mut table =
        HtmlTable::new("Residuals by component", 2, &["component", "rows", "number", "mean", "RMS", "largest"]);
    let measured = residuals.measured_quantities().into_iter();
    let components: Vec<(Quantity, usize)> =
        measured.flat_map(|quantity| (0..quantity.components()).map(move |component| (quantity, component))).collect();
    let rows = threads::map_parts_of(residuals.rows().len(), 2 * components.len(), |index| {
        let (quantity, component) = *components.get(index / 2)?;
        let (set, held_out) = [("fitted", false), ("held out", true)][index % 2];
        let of =
            |row: &ResidualRow| row.errors.get(quantity)?.residual().get(component).copied().filter(|it| !it.is_nan());
        let name = format!("{}, {}", component_words(quantity, component), sign(quantity.unit()));
        let values: Vec<f64> = residuals.rows().iter().filter(|row| row.held_out == held_out).filter_map(of).collect();
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        let found = Statistic::from_errors(values.iter().map(|value| value.abs()).collect())?;
        let sign = if mean < 0.0 { "−" } else { "" };
        let mean = format!("{sign}{}", number(mean.abs()));
        Some([name, set.to_owned(), values.len().to_string(), mean, number(found.rms), number(found.max)])
    });
    rows.into_iter().flatten().for_each(|cells| table.cells(cells));
    table
}

/// Errors by equal parts of each joint's sampled range.
fn joint_table(file: &CalibrationFile, residuals: &Residuals) -> HtmlTable {
    let lead = LeadingError::from_residuals(residuals);
    let of = format!(
        "of the {} model, {} (RMS), and number of rows by parts of each reading",
        delivered_name(file),
        lead.unit()
    );
    let caption = capital(&format!("{} error {of}", lead.name()));
    let mut table = HtmlTable::new(&caption, 1, &["reading", "from", "to", "rows", "RMS"]);
    let readings: Vec<_> = readings_of(residuals).collect();
    let rows = threads::map_parts_of(residuals.rows().len(), readings.len(), |reading| {
        let (index, name, unit) = &readings[reading];
        let value = |row: usize| residuals.values(row).get(*index).copied();
        let values = || (0..residuals.rows().len()).filter_map(value);
        let (least, most) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        let width = (most - least) / PARTS as f64;
        if width.is_nan() || width <= 0.0 {
            return Vec::new();
        }
        let mut sums = [(0usize, 0.0); PARTS];
        for (k, row) in residuals.rows().iter().enumerate() {
            let part = value(k).map(|value| (((value - least) / width) as usize).min(PARTS - 1));
            if let Some((sum, error)) = part.and_then(|part| sums.get_mut(part)).zip(lead.error(row)) {
                sum.0 += 1;
                sum.1 += error.powi(2);
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

/// The origin of a row as in the calibration file; rows that came from no file have none.
fn row_place(residuals: &Residuals, file: &str, row: u32, key: impl Render) -> Markup {
    match file {
        "" => html! { "–" },
        file => html! { (short_name(&residuals.files, file)) ":" (count(row as usize, key)) },
    }
}

fn leverage_table(residuals: &Residuals) -> Option<HtmlTable> {
    // A row that was held out has no influence on the fit.
    let fitted = residuals.rows().iter().enumerate().filter(|(_, row)| !row.held_out);
    let judged = fitted.filter_map(|(k, row)| Some((k, row.judged?)));
    let mut judged: Vec<_> = judged.filter(|(_, found)| found.leverage.is_finite()).collect();
    let larger = |a: &(usize, RowDiagnostics), b: &(usize, RowDiagnostics)| {
        b.1.leverage.total_cmp(&a.1.leverage).then(a.0.cmp(&b.0))
    };
    keep_first(&mut judged, LEVERAGES, larger);
    judged.sort_unstable_by(larger);
    let mut table =
        HtmlTable::new("Fitted rows of largest leverage", 1, &["row", "leverage", "studentised residual", "weight"]);
    for (k, found) in &judged {
        let numbers = [found.leverage, found.studentized, found.weight].map(number);
        table.row(&[&place(residuals, *k), &numbers[0], &numbers[1], &numbers[2]]);
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
        @if robust.suspected.training + robust.suspected.held_out == 0 {
            p { "No row is a suspected outlier. " (fit) }
        } @else {
            p {
                (count(robust.suspected.training, "robust.suspected.training")) " fitted and "
                (count(robust.suspected.held_out, "robust.suspected.held_out"))
                " held-out rows have residuals too large for noise, in the fit of the joint axes. " (fit) " " b { "Studentised" }
                " is the length of the residual in units of its own standard deviation, " b { "weight" }
                " is that of the row in the fit (or what it would be). Check whether a reflector was knocked, or two were confused."
            }
            (off_alike(file, residuals))
            (suspect_table(file, residuals))
            @if file.outliers.len() > LISTED {
                p.note {
                    "The table has the " (LISTED) " worst; the files that were written with this page have the others."
                }
            }
        }
    };
    section("suspects", "Suspected rows", &content)
}

/// Configurations in which all targets deviate by similar distances.
fn off_alike(file: &CalibrationFile, residuals: &Residuals) -> Markup {
    let found = &file.suspected_configurations;
    if found.is_empty() {
        return Markup::default();
    }
    let head = ["first row", "rows", "targets", "off by from, mm", "to, mm"];
    let mut table = HtmlTable::new("Configurations in which all targets are off alike, the worst first", 1, &head);
    for (k, it) in found.iter().enumerate().take(LISTED) {
        let key = |name: &str| format!("suspected_configurations.{k}.{name}");
        table.cells([
            row_place(residuals, &it.file, it.row, key("row")),
            count(it.rows, key("rows")),
            count(it.targets, key("targets")),
            figure(it.least_mm, key("least_mm")),
            figure(it.largest_mm, key("largest_mm")),
        ]);
    }
    let one = found.len() == 1;
    html! {
        p {
            "In " b { (found.len()) (if one { " configuration" } else { " configurations" }) } " all targets are off alike: there the robot or its \
             readings are wrong, not a reflector. Measure " (if one { "it" } else { "them" }) " again, and look at brakes, backlash and the time \
             between stopping and measuring."
        }
        (table)
    }
}

fn suspect_table(file: &CalibrationFile, residuals: &Residuals) -> HtmlTable {
    let is_measured = |quantity: &Quantity| file.outliers.iter().any(|it| it.residual.get(*quantity).is_some());
    let measured: Vec<Quantity> = Quantity::ALL.into_iter().filter(is_measured).collect();
    let off_by: Vec<String> =
        measured.iter().map(|quantity| format!("{} off by, {}", quantity.name(), sign(quantity.unit()))).collect();
    let words = |words: [&'static str; 2]| words.into_iter();
    let head = words(["row", "set"]).chain(off_by.iter().map(String::as_str)).chain(words(["studentised", "weight"]));
    let head: Vec<&str> = head.collect();
    let mut table = HtmlTable::new("Suspected outliers, the worst first", 2, &head);
    for (k, found) in file.outliers.iter().take(LISTED).enumerate() {
        let figure = |value, name: &str| figure_or(value, format_args!("outliers.{k}.{name}"), "–");
        let set = match found.set {
            OutlierSet::Fit => "fitted",
            OutlierSet::HeldOut => "held out",
        };
        let place = row_place(residuals, &found.file, found.row, format_args!("outliers.{k}.row"));
        let mut cells = vec![place, set.render()];
        let residuals = measured.iter().map(|it| (format!("residual.{}", it.key()), found.residual.get(*it)));
        cells.extend(residuals.map(|(key, residual)| figure(residual, &key)));
        cells.extend([figure(Some(found.studentized), "studentized"), figure(Some(found.weight), "weight")]);
        table.cells(cells);
    }
    table
}

fn repeatability(file: &CalibrationFile, residuals: &Residuals) -> Markup {
    let Some(found) = &file.repeatability else { return Markup::default() };
    let tables = found.mean.repeatability.iter().map(|(quantity, _)| repeatability_table(found, residuals, quantity));
    let tables: Vec<HtmlTable> = tables.collect();
    let worst = found.worst_repeatability.iter().map(|(quantity, worst)| {
        html! { (figure(worst, format_args!("repeatability.worst_repeatability.{}", quantity.key()))) (spaced_unit(quantity.unit())) (further_words(quantity)) }
    });
    let worst: Vec<Markup> = worst.collect();
    let content = html! {
        p {
            (count(found.poses, "repeatability.poses")) " poses were measured three times or more ("
            (count(found.rows, "repeatability.rows")) " rows). In the manner of ISO 9283, " b { "accuracy" }
            " is the distance from the predicted position to the mean of the measured positions, and " b { "repeatability" }
            " the mean distance of these from their mean, and three standard deviations of it. ISO 9283 asks for 30 rows a pose, each \
             approached again; rows of a robot that stood still show the device's repeatability only."
        }
        @for table in &tables { (table) }
        p.note {
            "The worst repeatability is " @for (k, worst) in worst.iter().enumerate() { @if k > 0 { ", " } (worst) }
            ". A pose is named by its first row."
        }
    };
    section("repeatability", "Repeatability", &content)
}

/// Poses whose errors of this quantity were compared.
fn repeatability_table(found: &RepeatabilityEntry, residuals: &Residuals, quantity: Quantity) -> HtmlTable {
    let head = ["pose", "rows", "accuracy, nominal", "registered", "calibrated", "repeatability"];
    let caption = format!("Pose accuracy and repeatability, {} ({})", sign(quantity.unit()), quantity.name());
    let mut table = HtmlTable::new(&caption, 1, &head);
    let is_all = found.mean.repeatability.iter().count() == 1;
    let rows = if is_all { count(found.rows, "repeatability.rows") } else { Markup::default() };
    let figures = |numbers: [(String, Option<f64>); 4], key: &str| {
        numbers.map(|(own, value)| figure_or(value, format_args!("{key}.{own}"), "–"))
    };
    let mean = figures(found.mean.by_key(quantity), "repeatability");
    table.cells(["mean of all".render(), rows].into_iter().chain(mean));
    let listed = found.listed.iter().enumerate();
    let listed = listed.filter(|(_, pose)| pose.own.repeatability.get(quantity).is_some());
    for (k, pose) in listed.take(LISTED) {
        let key = format!("repeatability.listed.{k}");
        let place = row_place(residuals, &pose.file, pose.row, format_args!("{key}.row"));
        let rows = count(pose.rows, format_args!("{key}.rows"));
        table.cells([place, rows].into_iter().chain(figures(pose.own.by_key(quantity), &key)));
    }
    table
}
