//! A plan of configurations.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Serialize;

use super::table::{line, number, robot_words, row};
use crate::io::model::Model;
use crate::io::plan_program::SPEED_RAD_S;
use crate::plan::{
    Conditions, CurvePoint, ExpectedErrors, Plan as Found, PlanCriterion, PlanOptions, RowPart,
};

/// A plan, for a person to look over or a machine to read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    model: String,
    measure: &'static str,
    criterion: &'static str,
    configurations: usize,
    kept: usize,
    judge: usize,
    returns: usize,
    /// How long it takes: the way at the speed of the programs, and a stop at each row.
    duration_s: f64,
    stop_s: f64,
    unknowns: usize,
    numbers: usize,
    robot_error_is_a_guess: bool,
    expected: Entry,
    random: Entry,
    log_determinant: f64,
    /// Indices from 0 of the candidates that were chosen, in the order of the rows.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    candidates: Vec<usize>,
    curve: Vec<CurveEntry>,
    /// Number of configurations from which ten more gain less than 5 %.
    enough: Option<usize>,
    rows: Vec<RowEntry>,
    /// Conditions that are looked at.
    checked: Vec<&'static str>,
    /// How many configurations each condition refused, of those that were tried.
    refused: BTreeMap<&'static str, usize>,
    tried: usize,
    left_out: Vec<[String; 2]>,
    without_limits: Vec<String>,
    #[serde(skip)]
    robot_words: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Entry {
    calibrated_mm: f64,
    calibrated_undetermined_mm: f64,
    robot_error_mm: f64,
    corrected_mm: f64,
    corrected_undetermined_mm: f64,
    corrected_robot_error_mm: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct CurveEntry {
    configurations: usize,
    #[serde(flatten)]
    expected: Entry,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct RowEntry {
    set: &'static str,
    returns: bool,
    readings: Vec<f64>,
}

impl Entry {
    fn new(it: &ExpectedErrors) -> Self {
        Entry {
            calibrated_mm: 1e3 * it.calibrated_m(),
            calibrated_undetermined_mm: 1e3 * it.undetermined_m,
            robot_error_mm: 1e3 * it.robot_m,
            corrected_mm: 1e3 * it.corrected_m(),
            corrected_undetermined_mm: 1e3 * it.corrected_undetermined_m,
            corrected_robot_error_mm: 1e3 * it.corrected_robot_m,
        }
    }
}

impl Plan {
    /// A plan for a model, and how long the robot stands at each row, seconds.
    #[must_use]
    pub fn new(model: &Model, options: &PlanOptions, found: &Found, stop_s: f64) -> Self {
        let count = |part: RowPart| found.rows.iter().filter(|row| row.part == part && !row.returns).count();
        let curve = |point: &CurvePoint| CurveEntry {
            configurations: point.count,
            expected: Entry::new(&point.expected),
        };
        let kept = options.fitted().len() / model.robot.reading_names().len().max(1);
        Plan {
            model: model.path.display().to_string(),
            measure: options.fit.session.kind.word(),
            criterion: match options.criterion {
                PlanCriterion::Expected => "expected",
                PlanCriterion::D => "D",
                PlanCriterion::A => "A",
                PlanCriterion::E => "E",
                PlanCriterion::G => "G",
            },
            configurations: count(RowPart::Fit) - if options.replaced.is_empty() { 0 } else { kept },
            kept,
            judge: count(RowPart::Judge),
            returns: found.rows.iter().filter(|row| row.returns).count(),
            duration_s: found.travel_rad / SPEED_RAD_S + stop_s * found.rows.len() as f64,
            stop_s,
            unknowns: found.unknowns,
            numbers: found.numbers,
            robot_error_is_a_guess: found.robot_error_is_a_guess,
            expected: Entry::new(&found.expected),
            random: Entry::new(&found.random),
            log_determinant: found.log_determinant,
            candidates: found.rows.iter().filter_map(|row| row.candidate).collect(),
            curve: found.curve.iter().map(curve).collect(),
            enough: found.enough,
            rows: found
                .rows
                .iter()
                .map(|row| RowEntry {
                    set: if row.part == RowPart::Fit { "fit" } else { "held_out" },
                    returns: row.returns,
                    readings: row.readings.clone(),
                })
                .collect(),
            checked: checked(&options.conditions),
            refused: found.refusals.each().map(|(obstacle, count)| (obstacle.words(), count)).collect(),
            tried: found.refusals.tried,
            left_out: found.left_out.iter().map(|(a, b)| [a.clone(), b.clone()]).collect(),
            without_limits: found.without_limits.clone(),
            robot_words: robot_words(&model.robot),
        }
    }

    fn checked_words(&self) -> String {
        let missing = ["collisions of the robot with itself", "sight"]
            .into_iter()
            .filter(|it| !self.checked.contains(it));
        let not: Vec<&str> = missing.chain(["the way between configurations"]).collect();
        format!("{}; NOT {}", self.checked.join(", "), not.join(", "))
    }

    fn refused_words(&self) -> String {
        let each = self.refused.iter().map(|(words, count)| format!("{count} by {words}"));
        each.collect::<Vec<_>>().join(", ")
    }

    /// What stands above the table of configurations.
    #[must_use]
    pub fn comments(&self) -> Vec<String> {
        let mut found = vec![
            format!(
                "{} configurations to measure and fit, then {} at random to judge by (held_out), each set in a short order of travel.",
                self.configurations, self.judge
            ),
            "Rows whose column `returns` names row 1 are the first configuration again: they show how well the robot repeats, and drift."
                .to_owned(),
            "ONLY CONFIGURATIONS ARE CHECKED, NEVER THE WAY BETWEEN THEM: go through them slowly or in simulation first.".to_owned(),
        ];
        found.push(format!(
            "Expected error of the calibrated robot {} mm, with corrections {} mm (RMS).",
            number(self.expected.calibrated_mm),
            number(self.expected.corrected_mm)
        ));
        found
    }

    /// As text of lines up to 80 characters (but for names that are longer).
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = String::new();
        line(&mut out, "robot", &self.robot_words);
        let kept = if self.kept > 0 { format!(" beside {} kept ones", self.kept) } else { String::new() };
        let rows = format!(
            "{} configurations to fit{kept}, {} at random to judge by, {} returns to the first",
            self.configurations, self.judge, self.returns
        );
        line(&mut out, "planned", &rows);
        let duration = format!(
            "about {} min: {} rows of {} s each, and the way at {:.0} deg/s",
            (self.duration_s / 60.0).ceil(),
            self.rows.len(),
            number(self.stop_s),
            SPEED_RAD_S.to_degrees()
        );
        line(&mut out, "takes", &duration);
        if (self.configurations + self.kept) * self.numbers < self.unknowns {
            line(
                &mut out,
                "",
                &format!(
                    "{} numbers for {} unknowns: the prior decides the rest",
                    (self.configurations + self.kept) * self.numbers,
                    self.unknowns
                ),
            );
        }
        let words = |it: &Entry| {
            format!("{} mm calibrated, {} mm corrected", number(it.calibrated_mm), number(it.corrected_mm))
        };
        line(&mut out, "expected", &format!("{} (RMS over the workspace)", words(&self.expected)));
        line(&mut out, "random", &words(&self.random));
        let guess = if self.robot_error_is_a_guess {
            ", a guess of 0.3 mm for each metre of reach: --robot-error states it"
        } else {
            ""
        };
        let robot = format!("{} mm that no geometry describes{guess}", number(self.expected.robot_error_mm));
        line(&mut out, "robot error", &robot);
        line(&mut out, "checked", &self.checked_words());
        if !self.refused.is_empty() {
            line(
                &mut out,
                "",
                &format!("of {} configurations refused: {}", self.tried, self.refused_words()),
            );
        }
        if !self.left_out.is_empty() {
            let pairs: Vec<String> = self.left_out.iter().map(|[a, b]| format!("{a} and {b}")).collect();
            line(
                &mut out,
                "",
                &format!("not looked at, since they overlap in all configurations: {}", pairs.join(", ")),
            );
        }
        if !self.without_limits.is_empty() {
            line(
                &mut out,
                "",
                &format!(
                    "without limits, taken to 180 deg or 500 mm to either side: {}",
                    self.without_limits.join(", ")
                ),
            );
        }
        // Writing to a String cannot fail.
        let _ = writeln!(out);
        let widths = [26, 13];
        row(&mut out, "configurations", widths, ["calibrated", "of it open", "corrected", "of it open"]);
        for point in &self.curve {
            let it = &point.expected;
            let mark = if point.configurations == self.configurations + self.kept { "  planned" } else { "" };
            let cells = [
                it.calibrated_mm,
                it.calibrated_undetermined_mm,
                it.corrected_mm,
                it.corrected_undetermined_mm,
            ];
            row(&mut out, &format!("  {}{mark}", point.configurations), widths, cells.map(number));
        }
        let _ = writeln!(out);
        let advice = match self.enough {
            Some(enough) => format!("{enough} configurations; from there 10 more gain less than 5 %"),
            None => "more than 100 configurations: 10 more still gain 5 %".to_owned(),
        };
        line(&mut out, "advice", &advice);
        out
    }
}

/// The conditions that are looked at.
fn checked(conditions: &Conditions) -> Vec<&'static str> {
    let own = [
        (true, "limits of the joints"),
        (!conditions.keep_out.is_empty(), "keep-out boxes"),
        (conditions.floor_m.is_some(), "the floor"),
        (!conditions.capsules.is_empty(), "collisions of the robot with itself"),
        (conditions.sight.is_some(), "sight"),
    ];
    own.into_iter().filter(|it| it.0).map(|it| it.1).collect()
}
