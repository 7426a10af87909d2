//! Changes of a program or table by compensation.

use std::fmt::Write as _;

use serde::Serialize;

use super::{CompensatedConfiguration, Compensation, CorrectionOutcome};
use poecal_programs::UnchangedStatement;

/// Change of a correction from one row to the next (rad, m) from which it is reported as a jump.
const JUMP: f64 = 0.02;
/// Most targets that a terminal lists.
const MOST_LINES: usize = 1000;

/// A largest value, and its line of the program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LargestValue {
    /// The value.
    pub value: f64,
    /// Line, from 1; 0 without a value.
    pub line: usize,
}

impl LargestValue {
    /// Adopts a value if it is larger.
    pub fn include(&mut self, value: f64, line: usize) {
        if value > self.value || self.line == 0 {
            *self = LargestValue { value, line };
        }
    }
}

/// Outcome of a corrected target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CorrectedTarget {
    /// Line of the program, from 1.
    pub line: usize,
    /// Index of the joint that moves most.
    pub joint: usize,
    /// Its change, rad or m.
    pub change: f64,
    /// Remaining distance of the tip, metres.
    pub left_m: f64,
    /// Remaining angle of the tip, radians.
    pub left_rad: f64,
}

/// Results recomputed from the written numbers, by the robots' own forward kinematics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ForwardCheck {
    /// Remaining distance, metres.
    pub left_m: LargestValue,
    /// Remaining angle, radians.
    pub left_rad: LargestValue,
    /// Distance of a joint from the value by its reading and its zero, relative to the limit.
    pub change: LargestValue,
}

impl ForwardCheck {
    /// Includes a target's remainder.
    pub fn include(&mut self, (metres, radians): (f64, f64), line: usize) {
        self.left_m.include(metres, line);
        self.left_rad.include(radians, line);
    }
}

/// Counts one more on a line; true if it is the first.
fn count(number: &mut usize, first: &mut usize, line: usize) -> bool {
    *number += 1;
    if *number == 1 {
        *first = line;
    }
    *number == 1
}

/// Changes by a compensation, and the remaining error.
#[derive(Clone, Debug, Default, Serialize)]
pub struct CompensationSummary {
    /// Number of corrected targets.
    pub rows: usize,
    /// Unchanged targets, in the order of the lines.
    pub listed: Vec<UnchangedStatement>,
    /// Every corrected target, on request.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub targets: Option<Vec<CorrectedTarget>>,
    /// Names of the readings.
    pub joints: Vec<String>,
    /// Largest correction of each reading, rad or m.
    pub largest: Vec<LargestValue>,
    /// Distance of the tip from its intended position without correction, metres.
    pub moved_m: LargestValue,
    /// Angle of the tip from its intended orientation without correction, radians.
    pub turned_rad: LargestValue,
    /// Remaining distance, metres.
    pub left_m: LargestValue,
    /// Remaining angle, radians.
    pub left_rad: LargestValue,
    /// Targets that the actual robot cannot reach, so that the nearest configuration is written, and the first of them.
    pub unreached: (usize, usize),
    /// Targets near singularities that keep some error of their orientation, the first of them, and the largest, radians.
    pub turned: (usize, usize, LargestValue),
    /// Readings beyond limits, the first line and its joint.
    pub beyond_limits: (usize, usize, String),
    /// Jumps of a correction between consecutive targets, and the largest.
    pub jumps: (usize, LargestValue),
    /// Result of an independent computation.
    pub checked: Option<ForwardCheck>,
    sum_moved: f64,
    /// Name of a position in the program.
    #[serde(skip)]
    place: &'static str,
    #[serde(skip)]
    last: Vec<f64>,
    #[serde(skip)]
    last_meant: Vec<f64>,
    #[serde(skip)]
    limits: Vec<(usize, f64, f64)>,
}

impl CompensationSummary {
    /// Summary without targets.
    #[must_use]
    pub fn new(compensation: &Compensation) -> Self {
        let limits = compensation.readings().iter().zip(compensation.actual_arm().limits());
        CompensationSummary {
            joints: compensation.names().to_vec(),
            largest: vec![LargestValue::default(); compensation.names().len()],
            limits: limits.map(|(&at, &(low, high))| (at, low, high)).collect(),
            place: "line",
            ..CompensationSummary::default()
        }
    }

    /// Summary of rows without lines.
    pub(crate) fn of_rows(compensation: &Compensation, each: bool) -> Self {
        CompensationSummary { place: "row", targets: each.then(Vec::new), ..CompensationSummary::new(compensation) }
    }

    /// Mean distance of the tip from its intended position without correction, metres.
    #[must_use]
    pub fn mean_moved_m(&self) -> f64 {
        if self.rows == 0 { 0.0 } else { self.sum_moved / self.rows as f64 }
    }

    /// Adds a target.
    pub fn include(&mut self, line: usize, meant: &[f64], found: &CompensatedConfiguration<'_>) {
        let (mut jump, mut step) = (0.0_f64, 0.0_f64);
        let is_first = self.rows == 0;
        self.last.resize(self.largest.len(), 0.0);
        self.last_meant.resize(self.largest.len(), 0.0);
        let mut most = CorrectedTarget { line, joint: 0, change: 0.0, left_m: found.left_m, left_rad: found.left_rad };
        for (index, (to, from)) in found.readings.iter().zip(meant).take(self.largest.len()).enumerate() {
            let change = to - from;
            if change.abs() > most.change {
                (most.joint, most.change) = (index, change.abs());
            }
            self.largest[index].include(change.abs(), line);
            jump = jump.max((change - self.last[index]).abs());
            self.last[index] = change;
            step = step.max((from - self.last_meant[index]).abs());
            self.last_meant[index] = *from;
        }
        // Targets that are far from each other have corrections of their own.
        if jump > JUMP.max(step) && !is_first {
            self.jumps.0 += 1;
            self.jumps.1.include(jump, line);
        }
        for &(index, low, high) in &self.limits {
            let Some(&value) = found.readings.get(index) else { continue };
            if (value < low || value > high) && count(&mut self.beyond_limits.0, &mut self.beyond_limits.1, line) {
                self.beyond_limits.2 = self.joints.get(index).cloned().unwrap_or_default();
            }
        }
        match found.outcome {
            CorrectionOutcome::Nearest => {
                count(&mut self.unreached.0, &mut self.unreached.1, line);
            }
            CorrectionOutcome::Turned => {
                count(&mut self.turned.0, &mut self.turned.1, line);
                self.turned.2.include(found.left_rad, line);
            }
            CorrectionOutcome::Reached | CorrectionOutcome::TooFar(..) => {}
        }
        if let Some(targets) = &mut self.targets {
            targets.push(most);
        }
        self.rows += 1;
        self.sum_moved += found.moved_m;
        self.moved_m.include(found.moved_m, line);
        self.turned_rad.include(found.turned_rad, line);
        self.left_m.include(found.left_m, line);
        self.left_rad.include(found.left_rad, line);
    }

    /// Adds a target that stays as it is.
    pub fn list(&mut self, line: usize, name: &str, reason: impl Into<String>) {
        self.listed.push(UnchangedStatement { line, name: name.to_owned(), reason: reason.into() });
    }

    /// True if every target is corrected.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.listed.is_empty()
    }

    /// The joint that is changed most, among those that turn or those that slide.
    fn most_changed(&self, slides: &dyn Fn(&str) -> bool) -> Option<(&str, LargestValue)> {
        let all = self.joints.iter().map(String::as_str).zip(self.largest.iter().copied());
        // With both kinds present, those that turn: the ratio of a millimetre to a degree depends on the arm.
        let of = |is_sliding: bool| {
            let some = all.clone().filter(move |(name, _)| slides(name) == is_sliding);
            some.max_by(|(_, one), (_, other)| one.value.total_cmp(&other.value))
        };
        of(false).filter(|(_, it)| it.value > 0.0).or_else(|| of(true))
    }

    /// Corrections and remaining errors, in words.
    fn changes(&self, out: &mut String, slides: &dyn Fn(&str) -> bool, what: &str) {
        let mm = |it: f64| format!("{:.4} mm", it * 1e3);
        let degrees = |it: f64| format!("{:.4} deg", it.to_degrees());
        if let Some((name, largest)) = self.most_changed(slides) {
            let value = if slides(name) { mm(largest.value) } else { degrees(largest.value) };
            let _ = writeln!(out, "largest change: `{name}` by {value} (line {})", largest.line);
        }
        let _ = writeln!(
            out,
            "{} {what}: without correction the tip would be off by {} in the mean, at most by {} (line {}) and {} (line {})",
            self.rows,
            mm(self.mean_moved_m()),
            mm(self.moved_m.value),
            self.moved_m.line,
            degrees(self.turned_rad.value),
            self.turned_rad.line
        );
        let _ = writeln!(out, "largest corrections:");
        let width = self.joints.iter().map(String::len).max().unwrap_or(0);
        for (name, largest) in self.joints.iter().zip(&self.largest) {
            let value = if slides(name) { mm(largest.value) } else { degrees(largest.value) };
            let _ = writeln!(out, "  {name:width$}  {value} (line {})", largest.line);
        }
        let left = |out: &mut String, words: &str, metres: &LargestValue, radians: &LargestValue| {
            let _ = writeln!(
                out,
                "{words}: at most {:.1e} mm (line {}) and {:.1e} deg (line {})",
                metres.value * 1e3,
                metres.line,
                radians.value.to_degrees(),
                radians.line
            );
        };
        left(out, "left after correction", &self.left_m, &self.left_rad);
        if let Some(checked) = &self.checked {
            left(out, "checked from the written numbers", &checked.left_m, &checked.left_rad);
            let _ = writeln!(
                out,
                "checked from the written numbers: no joint is changed by more than {:.1} % of what is allowed (line {})",
                100.0 * checked.change.value,
                checked.change.line
            );
        }
    }

    /// Number of corrected targets, the uncorrected error of the tip, and the remaining one, in a sentence.
    #[must_use]
    pub fn answer(&self) -> String {
        format!(
            "{} corrected, {} left as they are: the tip would be off by up to {:.4} mm, and is by up to {:.1e} mm",
            self.rows,
            self.listed.len(),
            self.moved_m.value * 1e3,
            self.left_m.value * 1e3
        )
    }

    /// The summary in words, for the terminal; sliding joints are listed by their names.
    #[must_use]
    pub fn text(&self, slides: &dyn Fn(&str) -> bool, what: &str) -> String {
        let mut out = String::new();
        if self.rows == 0 {
            let _ = writeln!(out, "0 {what}");
        } else {
            self.changes(&mut out, slides, what);
        }
        if !self.listed.is_empty() {
            let count = self.listed.len();
            let what = if count == 1 { "target is left as it is" } else { "targets are left as they are" };
            let _ = writeln!(out, "{count} {what}:");
        }
        for it in self.listed.iter().take(MOST_LINES) {
            let _ = writeln!(
                out,
                "  line {}: {}: {}",
                it.line,
                poecal_numerics::text::escape_invisible(&it.name),
                it.reason
            );
        }
        if self.listed.len() > MOST_LINES {
            let _ = writeln!(out, "  and {} more: --json has all", self.listed.len() - MOST_LINES);
        }
        out
    }

    /// Points that a user has to check, a sentence each.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let (mut out, place) = (Vec::new(), self.place);
        let of = |count: usize, one: &str, several: &str| {
            if count == 1 { format!("1 target {one}") } else { format!("{count} targets {several}") }
        };
        if self.unreached.0 > 0 {
            out.push(format!(
                "{} be reached by the actual robot, the first on {place} {}: there the nearest configuration is written",
                of(self.unreached.0, "cannot", "cannot"),
                self.unreached.1
            ));
        }
        if self.beyond_limits.0 > 0 {
            out.push(format!(
                "{} beyond their joint's limits once corrected, the first of joint `{}` on {place} {}",
                if self.beyond_limits.0 == 1 {
                    "1 reading is".to_owned()
                } else {
                    format!("{} readings are", self.beyond_limits.0)
                },
                self.beyond_limits.2,
                self.beyond_limits.1
            ));
        }
        if self.turned.0 > 0 {
            out.push(format!(
                "{} of orientation near a singularity, at most {:.4} deg ({place} {}), the first on {place} {}: the position is exact",
                of(self.turned.0, "keeps an error", "keep an error"),
                self.turned.2.value.to_degrees(),
                self.turned.2.line,
                self.turned.1
            ));
        }
        if self.jumps.0 > 0 {
            out.push(format!(
                "the correction jumps between consecutive targets ({} times), most on {place} {} (by {:.4} rad or m): near singularities",
                self.jumps.0, self.jumps.1.line, self.jumps.1.value
            ));
        }
        if !self.listed.is_empty() {
            let first = self.listed.iter().min_by_key(|it| it.line);
            out.push(format!(
                "{} left as the program has {}, where the robot will miss as before; the first on {place} {}: {}",
                of(self.listed.len(), "is", "are"),
                if self.listed.len() == 1 { "it" } else { "them" },
                first.map_or(0, |it| it.line),
                first.map_or("", |it| &it.reason)
            ));
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_larger_value_keeps_its_line() {
        let mut largest = LargestValue::default();
        largest.include(2.0, 7);
        largest.include(1.0, 8);
        assert_eq!((largest.value, largest.line), (2.0, 7));
    }

    #[test]
    fn rows_are_counted() {
        let robot = poecal_testing::sessions::unlimited_elbow();
        let mut compensation = Compensation::new(&robot, &robot, &[], &super::super::ChangeOptions::default()).unwrap();
        let mut summary = CompensationSummary::new(&compensation);
        let meant = [0.1; 6];
        summary.include(2, &meant, &compensation.joints(&meant));
        assert_eq!((summary.rows, summary.mean_moved_m()), (1, 0.0));
    }
}
