//! Common parts of all tables of 80 columns: labelled lines, figures, errors of the three models.

use std::fmt::{Display, Write as _};

use poecal_calibrate::{ModelAccuracy, PixelAccuracy, SetAccuracy, Statistic};
use poecal_model::measurement::{MeasuredQuantities, Quantity};
use poecal_model::robot::{JointKind, Robot};
use poecal_numerics::error::shorten_name;
use poecal_numerics::text::escape_invisible;

/// A model: its word, and its accuracy in a set.
type ModelColumn = (&'static str, fn(&SetAccuracy) -> Option<&ModelAccuracy>);

/// The models; not every calibration has the last.
const MODELS: [ModelColumn; 4] = [
    ("nominal", |set| Some(&set.nominal)),
    ("registered", |set| Some(&set.registered)),
    ("calibrated", |set| Some(&set.calibrated)),
    ("corrected", |set| set.corrected.as_ref()),
];

/// The models of some rows.
pub(crate) fn models(set: &SetAccuracy) -> Vec<ModelColumn> {
    MODELS.into_iter().filter(|(_, model)| model(set).is_some()).collect()
}

/// A row of statistics: its label, its name in files, and its value.
type StatisticRow = (&'static str, &'static str, fn(Statistic) -> f64);

/// The rows of every table of errors.
pub(crate) const STATISTICS: [StatisticRow; 4] =
    [("mean", "mean", |s| s.mean), ("RMS", "rms", |s| s.rms), ("95 %", "p95", |s| s.p95), ("max", "max", |s| s.max)];

/// Widths of the label and of each cell in tables of models.
pub(crate) const WIDTHS: [usize; 2] = [26, 13];

/// Errors of each quantity by the three models, training and held out separately.
pub(crate) fn accuracy_table(training: &SetAccuracy, held_out: Option<&SetAccuracy>) -> String {
    let mut out = String::new();
    for (k, quantity) in measured_quantities(training, held_out).enumerate() {
        if k > 0 {
            out.push('\n');
        }
        block(&mut out, quantity, training, held_out);
    }
    out
}

/// Quantities that rows of these sets measured.
pub(crate) fn measured_quantities<'a>(
    training: &'a SetAccuracy,
    held_out: Option<&'a SetAccuracy>,
) -> impl Iterator<Item = Quantity> + 'a {
    let is_in = |set: &SetAccuracy, quantity| set.calibrated.get(quantity).is_some();
    let is_measured = move |it: &Quantity| is_in(training, *it) || held_out.is_some_and(|set| is_in(set, *it));
    Quantity::ALL.into_iter().filter(is_measured)
}

fn block(out: &mut String, quantity: Quantity, training: &SetAccuracy, held_out: Option<&SetAccuracy>) {
    let title = format!("{}, {}", quantity.name(), quantity.unit().symbol());
    row(out, &title, WIDTHS, models(training).iter().map(|(word, _)| *word));
    set_rows(out, "training", training, quantity);
    match held_out {
        Some(set) => set_rows(out, "held out", set, quantity),
        None => out.push_str("  held out        none: every measurement was fitted\n"),
    }
}

fn set_rows(out: &mut String, name: &str, set: &SetAccuracy, quantity: Quantity) {
    for (k, (label, _, value)) in STATISTICS.into_iter().enumerate() {
        let head = if k == 0 { format!("{name} ({})", set.count) } else { String::new() };
        let cells = models(set)
            .into_iter()
            .map(|(_, model)| number_or_dash(model(set).and_then(|model| model.get(quantity)).map(value)));
        row(out, &format!("  {head:<17} {label:<6}"), WIDTHS, cells);
    }
}

/// A row of a table: a label, and cells that end below each other.
pub fn row(
    out: &mut String,
    label: &str,
    [label_width, width]: [usize; 2],
    cells: impl IntoIterator<Item = impl Display>,
) {
    // Writing to a String cannot fail.
    let _ = write!(out, "{label:<label_width$}");
    for cell in cells {
        let _ = write!(out, "{cell:>width$}");
    }
    out.push('\n');
}

/// Four significant digits, without an exponent in the range of lengths.
pub fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if value < 1e-3 {
        return format!("{value:.1e}");
    }
    let digits = (3 - value.log10().floor() as i32).clamp(1, 4) as usize;
    format!("{value:.digits$}")
}

/// `(x, y, z)` in another unit.
pub(crate) fn format_triple(values: [f64; 3], factor: f64, digits: usize) -> String {
    format!("({})", values.map(|value| format_short(value * factor, digits)).join(", "))
}

/// Up to `digits` decimals, without zeros at the end; more decimals for a value that would otherwise become zero.
pub(crate) fn format_short(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    match text {
        "0" | "-0" if value.abs() > 1e-12 => format!("{value:.1e}"),
        "-0" => "0".to_owned(),
        text => text.to_owned(),
    }
}

/// A number of the leading quantity with its unit, or a dash if nothing was measured.
pub(crate) fn leading_words(numbers: &MeasuredQuantities<f64>) -> String {
    let words = |(quantity, it): (Quantity, f64)| format!("{} {}", number(it), quantity.unit().symbol());
    numbers.leading_value().map_or_else(|| "-".to_owned(), words)
}

/// Words after a number of a quantity that is no part of a pose, since its unit does not identify it.
pub(crate) fn further_words(quantity: Quantity) -> String {
    if quantity.is_of_pose() { String::new() } else { format!(" of {}", quantity.name()) }
}

/// The noise of each measured quantity, with its unit.
pub(crate) fn noise_words(sigma: &MeasuredQuantities<f64>) -> String {
    let words = sigma
        .iter()
        .map(|(quantity, it)| format!("{} {}{}", number(it), quantity.unit().symbol(), further_words(quantity)));
    format!("{} each component", words.collect::<Vec<_>>().join(", "))
}

/// [`number`], or a dash for a missing value.
pub(crate) fn number_or_dash(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), number)
}

pub(crate) fn robot_words(robot: &Robot) -> String {
    let kinds = joints_words(robot.joints.iter().map(|joint| joint.kind));
    format!(
        "{}: {kinds}, from {} to {}",
        shorten_name(&robot.name),
        shorten_name(&robot.base_name),
        shorten_name(&robot.tip_name)
    )
}

/// Number of joints that turn, and of joints that slide.
pub(crate) fn joints_words(kinds: impl Iterator<Item = JointKind>) -> String {
    let (turning, sliding): (Vec<_>, Vec<_>) = kinds.partition(|kind| *kind == JointKind::Revolute);
    let words = [(turning.len(), "revolute"), (sliding.len(), "prismatic")];
    let words = words.iter().filter(|(count, _)| *count > 0).map(|(count, word)| format!("{count} {word}"));
    words.collect::<Vec<_>>().join(", ")
}

/// Number of poses and points.
pub(crate) fn kinds_words(poses: usize, points: usize) -> String {
    let words = |count: usize, one: &str| format!("{count} {one}{}", if count == 1 { "" } else { "s" });
    match (poses, points) {
        (poses, 0) => words(poses, "pose"),
        (0, points) => words(points, "point"),
        (poses, points) => format!("{} and {}", words(poses, "pose"), words(points, "point")),
    }
}

/// Width of the column of labels.
pub const INDENT: usize = 14;
/// Width of all lines.
pub const WIDTH: usize = 80;

/// A labelled line, broken at 80 columns with the text aligned.
pub fn line(out: &mut String, label: &str, text: &str) {
    let text = break_text(&escape_invisible(text), INDENT, INDENT, WIDTH);
    // Writing to a String cannot fail.
    let _ = writeln!(out, "{label:<INDENT$}{text}");
}

/// Paragraphs under one label.
pub fn lines<T: AsRef<str>>(out: &mut String, label: &str, texts: impl IntoIterator<Item = T>) {
    for (k, text) in texts.into_iter().enumerate() {
        line(out, if k == 0 { label } else { "" }, text.as_ref());
    }
}

/// A text with line breaks in place of blanks if it would be wider than `width`: after `before` characters, and with further lines indented.
#[must_use]
pub fn break_text(text: &str, before: usize, indent: usize, width: usize) -> String {
    let (mut out, mut used) = (String::new(), before);
    for (k, word) in text.split(' ').enumerate() {
        let length = word.chars().count();
        if k > 0 && used + 1 + length > width {
            out.push('\n');
            out.push_str(&" ".repeat(indent));
            used = indent;
        } else if k > 0 {
            out.push(' ');
            used += 1;
        }
        out.push_str(word);
        used += length;
    }
    out
}
/// Errors of corners: in the picture, and at the board.
pub(crate) fn corner_words(found: &PixelAccuracy) -> String {
    format!("{} px, {} mm at the board square to the ray", number(found.rms_px), number(found.rms_mm))
}

/// Errors of some pictures, with the median one.
pub(crate) fn pictures_words(found: &PixelAccuracy) -> String {
    let median = number(found.median_picture_px);
    format!("{} pictures: {} (RMS), median picture {median} px", found.pictures, corner_words(found))
}
