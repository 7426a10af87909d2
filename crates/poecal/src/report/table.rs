//! What all tables of 80 columns have in common: labelled lines, figures, errors of the three models.

use std::fmt::Write as _;

use crate::analysis::{Cause, Identifiability};
use crate::calibration::{ModelAccuracy, SetAccuracy, Statistic};
use crate::error::shown;
use crate::robot::{JointKind, Robot};
use crate::text::visible;

/// Columns of the table: their heads and how to take them from the accuracy of a set.
type Column<'a> = (&'a str, fn(&SetAccuracy) -> &ModelAccuracy);

/// A row of statistics: its label and how to take it.
type StatisticRow = (&'static str, fn(&Statistic) -> f64);

/// The rows of every table of errors.
pub(super) const STATISTICS: [StatisticRow; 4] =
    [("mean", |s| s.mean), ("RMS", |s| s.rms), ("95 %", |s| s.p95), ("max", |s| s.max)];

/// Directions of a kind that the terminal names.
const MOST_DIRECTIONS: usize = 6;

/// Which unknowns measurements determine, do not determine, determine weakly, and could not determine.
pub(super) fn identifiability_lines(out: &mut String, found: &Identifiability) {
    let condition = if found.condition.is_finite() {
        format!(", condition {:.3e}", found.condition)
    } else {
        String::new()
    };
    line(out, "determined", &format!("{} of {} unknowns{condition}", found.rank, found.parameters));
    for (label, directions) in [("undetermined", &found.unidentifiable), ("weakly determined", &found.weak)] {
        if found.rank == 0 && found.parameters > 0 {
            line(
                out,
                "",
                "undetermined: everything, since the residual is as large as the effect of the unknowns",
            );
            break;
        }
        for (k, direction) in directions.iter().enumerate() {
            if k == MOST_DIRECTIONS {
                line(out, "", &format!("{label}: {} more, in calibration.json", directions.len() - k));
                break;
            }
            let count = direction.directions;
            let times = if count > 1 { format!(" ({count} directions)") } else { String::new() };
            line(out, "", &format!("{label}: {}{times}", direction.description));
        }
    }
    for direction in found.structural.iter().filter(|it| it.cause == Cause::NoOrientation) {
        line(out, "", &direction.description);
    }
}

/// Position and rotation errors of the three models, training and held out apart.
pub(super) fn accuracy_table(training: &SetAccuracy, held_out: Option<&SetAccuracy>) -> String {
    let columns: [Column<'_>; 3] = [
        ("nominal", |set| &set.nominal),
        ("registered", |set| &set.registered),
        ("calibrated", |set| &set.calibrated),
    ];
    let mut out = String::new();
    block(&mut out, "position, mm", &columns, training, held_out, |model| Some(model.position_mm));
    let turned = |set: &SetAccuracy| set.calibrated.rotation_deg.is_some();
    if turned(training) || held_out.is_some_and(turned) {
        out.push('\n');
        block(&mut out, "rotation, deg", &columns, training, held_out, |model| model.rotation_deg);
    }
    out
}

fn block(
    out: &mut String,
    title: &str,
    columns: &[Column<'_>],
    training: &SetAccuracy,
    held_out: Option<&SetAccuracy>,
    of: impl Fn(&ModelAccuracy) -> Option<Statistic>,
) {
    // Writing to a String cannot fail.
    let _ = write!(out, "{title:<26}");
    for (head, _) in columns {
        let _ = write!(out, "{head:>14}");
    }
    out.push('\n');
    set_rows(out, "training", columns, training, &of);
    match held_out {
        Some(set) => set_rows(out, "held out", columns, set, &of),
        None => out.push_str("  held out        none: every measurement was fitted\n"),
    }
}

fn set_rows(
    out: &mut String,
    name: &str,
    columns: &[Column<'_>],
    set: &SetAccuracy,
    of: impl Fn(&ModelAccuracy) -> Option<Statistic>,
) {
    for (k, (label, value)) in STATISTICS.iter().enumerate() {
        let head = if k == 0 { format!("{name} ({})", set.count) } else { String::new() };
        let _ = write!(out, "  {head:<17} {label:<6}");
        for (_, model) in columns {
            let cell = of(model(set)).map_or_else(|| "-".to_owned(), |s| number(value(&s)));
            let _ = write!(out, "{cell:>14}");
        }
        out.push('\n');
    }
}

/// Four digits that matter, without an exponent where people read lengths.
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

pub(super) fn robot_words(robot: &Robot) -> String {
    let sliding = robot.joints.iter().filter(|joint| joint.kind == JointKind::Prismatic).count();
    let turning = robot.joints.len() - sliding;
    let kinds = match (turning, sliding) {
        (turning, 0) => format!("{turning} revolute"),
        (0, sliding) => format!("{sliding} prismatic"),
        (turning, sliding) => format!("{turning} revolute, {sliding} prismatic"),
    };
    format!("{}: {kinds}, from {} to {}", shown(&robot.name), shown(&robot.base_name), shown(&robot.tip_name))
}

/// How many poses and points.
pub(super) fn kinds_words(poses: usize, points: usize) -> String {
    let words = |count: usize, one: &str| format!("{count} {one}{}", if count == 1 { "" } else { "s" });
    match (poses, points) {
        (poses, 0) => words(poses, "pose"),
        (0, points) => words(points, "point"),
        (poses, points) => format!("{} and {}", words(poses, "pose"), words(points, "point")),
    }
}

/// A labelled line, broken at 80 columns with the text aligned.
pub fn line(out: &mut String, label: &str, text: &str) {
    const INDENT: usize = 14;
    let mut width = INDENT;
    let _ = write!(out, "{label:<INDENT$}");
    for (k, word) in visible(text).split(' ').enumerate() {
        let length = word.chars().count();
        if k > 0 && width + 1 + length > 80 {
            let _ = write!(out, "\n{:INDENT$}", "");
            width = INDENT;
        } else if k > 0 {
            out.push(' ');
            width += 1;
        }
        out.push_str(word);
        width += length;
    }
    out.push('\n');
}
