//! A plan of configurations.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Serialize;

use super::table::{line, number, robot_words, row};
use poecal_plan::plan::{Conditions, CurvePoint, ExpectedErrors, Plan as Found, PlanOptions, RowPurpose};
use poecal_results::model::Model;
use poecal_results::plan_program::SPEED_RAD_S;

/// A plan, for a person to look over or a machine to read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlanReport {
    model: String,
    measure: &'static str,
    criterion: &'static str,
    configurations: usize,
    kept: usize,
    judge: usize,
    returns: usize,
    /// Duration: motion at the speed of the programs, and a stop at each row.
    duration_s: f64,
    stop_s: f64,
    unknowns: usize,
    numbers: usize,
    robot_error_is_a_guess: bool,
    expected: PlanErrors,
    random: PlanErrors,
    log_determinant: f64,
    /// Indices from 0 of the candidates that were chosen, in the order of the rows.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    candidates: Vec<usize>,
    curve: Vec<CurveEntry>,
    /// Number of configurations from which on ten more gain less than 5 %.
    enough: Option<usize>,
    rows: Vec<PlanRowEntry>,
    /// Conditions that are checked.
    checked: Vec<&'static str>,
    /// Numbers of tried configurations that each condition refused.
    refused: BTreeMap<&'static str, usize>,
    tried: usize,
    left_out: Vec<[String; 2]>,
    without_limits: Vec<String>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    beyond_a_turn: Vec<String>,
    #[serde(skip)]
    robot_words: String,
}

/// Columns of the table of errors by number of configurations. Removable is the part of an error that more rows would remove.
pub(crate) const CURVE_HEAD: [&str; 5] = ["configurations", "calibrated", "removable", "corrected", "removable"];
/// Reason why a number of configurations is enough.
const LITTLE_GAIN: &str = "from there 10 more gain less than 5 %";

/// Expected errors (RMS over the workspace) in two parts each.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct PlanErrors {
    pub(crate) calibrated_mm: f64,
    calibrated_undetermined_mm: f64,
    robot_error_mm: f64,
    pub(crate) corrected_mm: f64,
    corrected_undetermined_mm: f64,
    corrected_robot_error_mm: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct CurveEntry {
    configurations: usize,
    #[serde(flatten)]
    expected: PlanErrors,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct PlanRowEntry {
    set: &'static str,
    returns: bool,
    readings: Vec<f64>,
}

impl PlanErrors {
    pub(crate) fn new(it: &ExpectedErrors) -> Self {
        PlanErrors {
            calibrated_mm: 1e3 * it.calibrated_m(),
            calibrated_undetermined_mm: 1e3 * it.undetermined_m,
            robot_error_mm: 1e3 * it.robot_m,
            corrected_mm: 1e3 * it.corrected_m(),
            corrected_undetermined_mm: 1e3 * it.corrected_undetermined_m,
            corrected_robot_error_mm: 1e3 * it.corrected_robot_m,
        }
    }

    /// Words for the calibrated and for the corrected model: the error, and its parts.
    pub(crate) fn words(&self) -> [String; 2] {
        let words = |all, open, rest| {
            format!(
                "to {} mm: more rows would remove {} mm, and {} mm is robot error beyond such a model",
                number(all),
                number(open),
                number(rest)
            )
        };
        [
            words(self.calibrated_mm, self.calibrated_undetermined_mm, self.robot_error_mm),
            words(self.corrected_mm, self.corrected_undetermined_mm, self.corrected_robot_error_mm),
        ]
    }
}

/// The part of a robot's error that no geometry describes.
pub(crate) fn robot_error_words(it: &PlanErrors, is_a_guess: bool) -> String {
    let assumed = if is_a_guess { " (assumed: 0.3 mm per metre of reach; state yours with --robot-error)" } else { "" };
    format!("{} mm that no geometry of the axes describes{assumed}", number(it.robot_error_mm))
}

impl PlanReport {
    /// A plan for a model, with the duration of the robot's stop at each row, seconds.
    #[must_use]
    pub fn new(model: &Model, options: &PlanOptions, found: &Found, stop_s: f64) -> Self {
        let count = |part: RowPurpose| found.rows.iter().filter(|row| row.part == part && !row.returns).count();
        let curve =
            |point: &CurvePoint| CurveEntry { configurations: point.count, expected: PlanErrors::new(&point.expected) };
        let kept = options.fitted_readings().len() / model.robot.reading_names().len().max(1);
        PlanReport {
            model: model.path.display().to_string(),
            measure: options.fit.session.kind.word(),
            criterion: options.criterion.word(),
            configurations: count(RowPurpose::Fit) - if options.replaced.is_empty() { 0 } else { kept },
            kept,
            judge: count(RowPurpose::Judge),
            returns: found.rows.iter().filter(|row| row.returns).count(),
            duration_s: found.travel_rad / SPEED_RAD_S + stop_s * found.rows.len() as f64,
            stop_s,
            unknowns: found.unknowns,
            numbers: found.numbers,
            robot_error_is_a_guess: found.robot_error_is_a_guess,
            expected: PlanErrors::new(&found.expected),
            random: PlanErrors::new(&found.random),
            log_determinant: found.log_determinant,
            candidates: found.rows.iter().filter_map(|row| row.candidate).collect(),
            curve: found.curve.iter().map(curve).collect(),
            enough: found.enough,
            rows: found
                .rows
                .iter()
                .map(|row| PlanRowEntry { set: row.part.set(), returns: row.returns, readings: row.readings.clone() })
                .collect(),
            checked: checked_conditions(&options.conditions),
            refused: found.refusals.iter_counts().map(|(obstacle, count)| (obstacle.words(), count)).collect(),
            tried: found.refusals.tried,
            left_out: found.left_out.iter().map(|(a, b)| [a.clone(), b.clone()]).collect(),
            without_limits: found.without_limits.clone(),
            beyond_a_turn: found.beyond_a_turn.clone(),
            robot_words: robot_words(&model.robot),
        }
    }

    fn checked_words(&self) -> String {
        let missing =
            ["collisions of the robot with itself", "sight"].into_iter().filter(|it| !self.checked.contains(it));
        let not: Vec<&str> = missing.chain(["the way between configurations"]).collect();
        format!("{}; NOT {}", self.checked.join(", "), not.join(", "))
    }

    fn refused_words(&self) -> String {
        let each = self.refused.iter().map(|(words, count)| format!("{count} by {words}"));
        each.collect::<Vec<_>>().join(", ")
    }

    /// Configurations to fit, kept and new.
    pub(crate) fn planned_count(&self) -> usize {
        self.configurations + self.kept
    }

    /// Comparison of the planned number of configurations with the worthwhile one, in words.
    pub(crate) fn advice(&self) -> String {
        let planned = self.planned_count();
        match self.enough {
            Some(enough) if enough > planned => format!(
                "{planned} configurations are planned, {enough} would be worth it: --count {enough} ({LITTLE_GAIN})"
            ),
            Some(enough) if enough < planned => {
                format!("{planned} configurations are planned, {enough} would do ({LITTLE_GAIN})")
            }
            Some(_) => format!("{planned} configurations are enough ({LITTLE_GAIN})"),
            None => format!(
                "{planned} configurations are planned, more than 100 would be worth it: 10 more still gain 5 % there"
            ),
        }
    }

    /// The plan in a sentence.
    #[must_use]
    pub fn answer(&self) -> String {
        format!(
            "{} configurations to fit are expected to leave {} mm calibrated and {} mm corrected (RMS over the workspace); as many random ones {} and {} mm.",
            self.planned_count(),
            number(self.expected.calibrated_mm),
            number(self.expected.corrected_mm),
            number(self.random.calibrated_mm),
            number(self.random.corrected_mm)
        )
    }

    /// Facts of the plan, with their names.
    pub(crate) fn facts(&self) -> Vec<(&'static str, String)> {
        let kept = if self.kept > 0 { format!(" beside {} kept ones", self.kept) } else { String::new() };
        let mut facts = vec![
            ("robot", self.robot_words.clone()),
            (
                "planned",
                format!(
                    "{} configurations to fit{kept}, {} at random to judge by, {} return{} to the first",
                    self.configurations,
                    self.judge,
                    self.returns,
                    if self.returns == 1 { "" } else { "s" }
                ),
            ),
            (
                "takes",
                format!(
                    "about {} min: {} rows of {} s each, and the way at {:.0} deg/s",
                    (self.duration_s / 60.0).ceil(),
                    self.rows.len(),
                    self.stop_s,
                    SPEED_RAD_S.to_degrees()
                ),
            ),
        ];
        let numbers = self.planned_count() * self.numbers;
        if numbers < self.unknowns {
            let words = format!("{numbers} numbers for {} unknowns: the prior decides the rest", self.unknowns);
            facts.push(("", words));
        }
        let words = |it: &PlanErrors| {
            format!("{} mm calibrated, {} mm corrected", number(it.calibrated_mm), number(it.corrected_mm))
        };
        facts.push(("expected", format!("{} (RMS over the workspace)", words(&self.expected))));
        facts.push(("random", words(&self.random)));
        facts.push(("robot error", robot_error_words(&self.expected, self.robot_error_is_a_guess)));
        facts.push(("checked", self.checked_words()));
        if !self.refused.is_empty() {
            let words = format!("of {} configurations refused: {}", self.tried, self.refused_words());
            facts.push(("", words));
        }
        if !self.left_out.is_empty() {
            let pairs: Vec<String> = self.left_out.iter().map(|[a, b]| format!("{a} and {b}")).collect();
            let pairs = pairs.join(", ");
            facts.push(("", format!("not looked at, since they overlap in all configurations: {pairs}")));
        }
        if !self.without_limits.is_empty() {
            let names = self.without_limits.join(", ");
            facts.push(("", format!("without limits, taken to 180 deg or 500 mm to either side: {names}")));
        }
        if !self.beyond_a_turn.is_empty() {
            let names = self.beyond_a_turn.join(", ");
            facts.push(("", format!("limits of more than a turn, taken within one: {names}")));
        }
        facts
    }

    /// As text of lines up to 80 characters (except for longer names).
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = String::new();
        self.facts().iter().for_each(|(name, words)| line(&mut out, name, words));
        // Writing to a String cannot fail.
        let _ = writeln!(out, "\nExpected error, mm (RMS); removable: the part that more rows would remove");
        let widths = [26, 13];
        row(&mut out, "configurations", widths, &CURVE_HEAD[1..]);
        for point in &self.curve {
            let it = &point.expected;
            let mark = if point.configurations == self.planned_count() { "  planned" } else { "" };
            let cells =
                [it.calibrated_mm, it.calibrated_undetermined_mm, it.corrected_mm, it.corrected_undetermined_mm];
            row(&mut out, &format!("  {}{mark}", point.configurations), widths, cells.map(number));
        }
        let _ = writeln!(out);
        line(&mut out, "advice", &self.advice());
        out
    }
}

/// The conditions that are checked.
fn checked_conditions(conditions: &Conditions) -> Vec<&'static str> {
    let own = [
        (true, "limits of the joints"),
        (!conditions.keep_out.is_empty(), "keep-out boxes"),
        (conditions.floor_m.is_some(), "the floor"),
        (!conditions.capsules.is_empty(), "collisions of the robot with itself"),
        (conditions.sight.is_some(), "sight"),
    ];
    own.into_iter().filter(|it| it.0).map(|it| it.1).collect()
}
