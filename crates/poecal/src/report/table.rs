//! The table of a calibration in 80 columns.

use std::fmt::Write as _;

use super::fixed::Fixed;
use crate::analysis::{Cause, Identifiability};
use crate::calibration::{Calibration, Level, ModelAccuracy, NoiseSource, SetAccuracy, Statistic};
use crate::error::shown;
use crate::measurement::{Dataset, PoseResidual};
use crate::parameters::Formulation;
use crate::robot::{JointKind, Robot};
use crate::solve::{Method, Termination};
use crate::text::visible;

/// Columns of the table: their heads and how to take them from the accuracy of a set.
type Column<'a> = (&'a str, fn(&SetAccuracy) -> &ModelAccuracy);

/// A row of statistics: its label and how to take it.
type StatisticRow = (&'static str, fn(&Statistic) -> f64);

/// The rows of every table of errors.
pub(super) const STATISTICS: [StatisticRow; 4] =
    [("mean", |s| s.mean), ("RMS", |s| s.rms), ("95 %", |s| s.p95), ("max", |s| s.max)];

/// What a calibration did and how good it is, as text of lines up to 80 characters.
#[must_use]
pub fn summary(calibration: &Calibration, data: &Dataset) -> String {
    let mut out = String::new();
    line(&mut out, "robot", &robot_words(&calibration.nominal));
    line(&mut out, "measurements", &data_words(calibration, data));
    line(&mut out, "noise", &noise_words(calibration, data));
    out.push('\n');
    out.push_str(&accuracy_table(&calibration.accuracy.training, calibration.accuracy.held_out.as_ref()));
    out.push('\n');
    out.push_str(&super::outliers::suspected(calibration, data));
    identifiability_lines(&mut out, &calibration.identifiability);
    line(&mut out, "solver", &solver_words(calibration));
    trust_lines(&mut out, calibration);
    if let Some(words) = formulation_words(calibration, data) {
        line(&mut out, "formulation", &words);
    }
    out
}

/// Directions of a kind that the terminal names.
const MOST_DIRECTIONS: usize = 6;

/// What measurements determine, leave open, tell hardly, and could not tell.
pub(super) fn identifiability_lines(out: &mut String, found: &Identifiability) {
    let condition = if found.condition.is_finite() {
        format!(", condition {:.3e}", found.condition)
    } else {
        String::new()
    };
    line(out, "determined", &format!("{} of {} unknowns{condition}", found.rank, found.parameters));
    for (label, directions) in [("open", &found.unidentifiable), ("weak", &found.weak)] {
        if found.rank == 0 && found.parameters > 0 {
            line(out, "", "open: everything, since what the fit leaves is as large as what it describes");
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
#[must_use]
pub fn accuracy_table(training: &SetAccuracy, held_out: Option<&SetAccuracy>) -> String {
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
pub(super) fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if value < 1e-3 {
        return format!("{value:.1e}");
    }
    let digits = (3 - value.log10().floor() as i32).clamp(1, 4) as usize;
    Fixed(value, digits).to_string()
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

fn data_words(calibration: &Calibration, data: &Dataset) -> String {
    let poses = data.observations.iter().filter(|row| row.measurement.sees_orientation()).count();
    let points = data.len() - poses;
    let kinds = kinds_words(poses, points);
    let targets = match data.targets.len() {
        1 => String::new(),
        count => format!(" of {count} targets"),
    };
    let held_out = calibration.held_out_rows.len();
    format!("{kinds}{targets}: {} fitted, {held_out} held out", calibration.fit_rows.len())
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

fn noise_words(calibration: &Calibration, data: &Dataset) -> String {
    let source = match calibration.noise_source {
        NoiseSource::Rows => return "as each row states it".to_owned(),
        NoiseSource::Exact => return "none: the fit leaves nothing but rounding".to_owned(),
        NoiseSource::Given => "as given",
        NoiseSource::Estimated => "estimated from the fit",
    };
    let rotation = if data.observations.iter().any(|row| row.measurement.sees_orientation()) {
        format!(", {} deg", number(calibration.noise.rotation_rad.to_degrees()))
    } else {
        String::new()
    };
    let stated = data.observations.iter().filter(|row| row.sigma_position_m.is_some()).count();
    if stated == data.len() {
        return format!("positions as each row states it{rotation} each component, {source}");
    }
    let rows = if stated > 0 { "; rows that state theirs keep it" } else { "" };
    format!("{} mm{rotation} each component, {source}{rows}", number(calibration.noise.position_m * 1e3))
}

fn solver_words(calibration: &Calibration) -> String {
    let solver = &calibration.solver;
    let end = match solver.termination {
        Termination::Optimum | Termination::StepVanished | Termination::NoProgress => "at the optimum",
        Termination::IterationLimit => "NOT converged: the limit of iterations was reached",
        Termination::NotFinite => "NOT converged: residuals are not finite",
    };
    let restarts = match solver.restarts {
        0 => String::new(),
        1 => ", 1 further start tried".to_owned(),
        count => format!(", {count} further starts tried"),
    };
    format!("{} iterations, {end}{restarts}", solver.iterations)
}

/// What is to be expected of predictions, what cross-validation shows, and the verdict.
fn trust_lines(out: &mut String, calibration: &Calibration) {
    let trust = &calibration.trust;
    if calibration.verdict.level != Level::DoNotUse
        && let (Some(measured), Some(range)) = (trust.measured, trust.range)
    {
        let words = format!(
            "true place within {} mm (RMS) where it was measured, {} mm anywhere within the limits",
            number(measured.sigma_m * 1e3),
            number(range.sigma_m * 1e3)
        );
        line(out, "to expect", &words);
    }
    if let Some(found) = &trust.cross_validation {
        let worst = found.worst().map_or(String::new(), |worst| {
            format!("; {}: {} mm", worst.name, number(worst.position_rms_m * 1e3))
        });
        let words = format!("random rows {} mm (RMS){worst}", number(found.random.position_rms_m * 1e3));
        line(out, "left out", &words);
    }
    line(out, "per joint", &per_joint_words(calibration));
    for (coverage, joint) in trust.coverage.iter().zip(&trust.joints) {
        if let Some(words) = &joint.suspicious {
            line(out, "suspicious", &format!("{}: {words}", coverage.joint));
        }
    }
    let verdict = &calibration.verdict;
    line(out, "verdict", &format!("{}: {}", verdict.level.words(), verdict.reasons.join("; ")));
}

/// What is left if one joint alone stays nominal, the dearest first.
fn per_joint_words(calibration: &Calibration) -> String {
    const MOST: usize = 7;
    let trust = &calibration.trust;
    let mut joints: Vec<_> = trust
        .coverage
        .iter()
        .zip(&trust.joints)
        .map(|(coverage, joint)| (joint.left_nominal_rms_m, coverage.joint.as_str()))
        .collect();
    joints.sort_by(|a, b| b.0.total_cmp(&a.0));
    let named: Vec<String> = joints
        .iter()
        .take(MOST)
        .map(|(left_m, name)| format!("{name} {} mm", number(left_m * 1e3)))
        .collect();
    let others = if joints.len() > MOST { ", the others less" } else { "" };
    format!("errors (RMS) with one joint left nominal: {}{others}", named.join(", "))
}

/// How the problem was written, where not as usual, and what follows from that.
fn formulation_words(calibration: &Calibration, data: &Dataset) -> Option<String> {
    let poses = data.observations.iter().any(|row| row.measurement.sees_orientation());
    let usual_residual = !poses || calibration.pose_residual == PoseResidual::default();
    let usual = (Formulation::default(), Method::default());
    if usual_residual && (calibration.formulation, calibration.method) == usual {
        return None;
    }
    let residual = if poses {
        format!(" {} residual of poses,", calibration.pose_residual.word())
    } else {
        String::new()
    };
    let mut words = format!("{},{residual} {}", calibration.formulation.word(), calibration.method.word());
    if calibration.formulation.has_free_screws() && calibration.method == Method::GaussNewton {
        words
            .push_str("; screws are normalised after each step, so with noise this is not the least squares");
    }
    if calibration.formulation.has_offsets() {
        words.push_str("; joint offsets cannot be told from screws, and stand moved into them");
    }
    Some(words)
}

/// A labelled line, broken at 80 columns with the text aligned.
pub(super) fn line(out: &mut String, label: &str, text: &str) {
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
