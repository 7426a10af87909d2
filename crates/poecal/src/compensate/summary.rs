//! What compensation changes in a program.

use std::fmt::Write as _;

use serde::Serialize;

use super::{Compensated, Compensation, REACHED};

/// Change of a correction from one row to the next (rad, m) from which it is told as a jump.
const JUMP: f64 = 0.02;

/// A largest value, and the line of the program where it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Largest {
    /// The value.
    pub value: f64,
    /// Its line, from 1; 0 of none.
    pub line: usize,
}

impl Largest {
    /// Takes a value if it is larger.
    pub fn include(&mut self, value: f64, line: usize) {
        if value > self.value || self.line == 0 {
            *self = Largest { value, line };
        }
    }
}

/// What a compensation changes, and what is left.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Summary {
    /// Number of targets.
    pub rows: usize,
    /// Names of the readings.
    pub joints: Vec<String>,
    /// Largest correction of each reading, rad or m.
    pub largest: Vec<Largest>,
    /// How far the tip would have been off, metres.
    pub moved_m: Largest,
    /// How far it would have been turned, radians.
    pub turned_rad: Largest,
    /// What is left of that, metres.
    pub left_m: Largest,
    /// What is left, radians.
    pub left_rad: Largest,
    /// Targets that the actual robot cannot reach, and the first of them.
    pub unreached: (usize, usize),
    /// Readings beyond limits, the first line and its joint.
    pub beyond_limits: (usize, usize, String),
    /// Targets where the robot is bent another way, and the first of them.
    pub other_branches: (usize, usize),
    /// Jumps of a correction between consecutive targets, and the largest.
    pub jumps: (usize, Largest),
    /// What an independent computation finds left of the written numbers: distance and angle.
    pub checked: Option<(Largest, Largest)>,
    sum_moved: f64,
    #[serde(skip)]
    last: Vec<f64>,
    #[serde(skip)]
    limits: Vec<(usize, f64, f64)>,
}

impl Summary {
    /// Of no targets yet.
    #[must_use]
    pub fn new(compensation: &Compensation) -> Self {
        let limits = compensation.readings().iter().zip(compensation.actual().limits());
        Summary {
            joints: compensation.names().to_vec(),
            largest: vec![Largest::default(); compensation.names().len()],
            limits: limits.map(|(&at, &(low, high))| (at, low, high)).collect(),
            ..Summary::default()
        }
    }

    /// Mean distance by which the tip would have been off, metres.
    #[must_use]
    pub fn mean_moved_m(&self) -> f64 {
        if self.rows == 0 { 0.0 } else { self.sum_moved / self.rows as f64 }
    }

    /// Adds a target.
    pub fn include(&mut self, line: usize, meant: &[f64], found: &Compensated<'_>) {
        let mut jump = 0.0_f64;
        let is_first = self.rows == 0;
        self.last.resize(self.largest.len(), 0.0);
        for (index, (to, from)) in found.readings.iter().zip(meant).take(self.largest.len()).enumerate() {
            let change = to - from;
            self.largest[index].include(change.abs(), line);
            jump = jump.max((change - self.last[index]).abs());
            self.last[index] = change;
        }
        if jump > JUMP && !is_first {
            self.jumps.0 += 1;
            self.jumps.1.include(jump, line);
        }
        for &(index, low, high) in &self.limits {
            let Some(&value) = found.readings.get(index) else { continue };
            if value < low || value > high {
                if self.beyond_limits.0 == 0 {
                    self.beyond_limits = (0, line, self.joints.get(index).cloned().unwrap_or_default());
                }
                self.beyond_limits.0 += 1;
            }
        }
        let count = |counted: &mut (usize, usize), is: bool| {
            if is {
                counted.1 = if counted.0 == 0 { line } else { counted.1 };
                counted.0 += 1;
            }
        };
        count(&mut self.unreached, found.left_m > REACHED || found.left_rad > REACHED);
        count(&mut self.other_branches, found.is_other_branch);
        self.rows += 1;
        self.sum_moved += found.moved_m;
        self.moved_m.include(found.moved_m, line);
        self.turned_rad.include(found.turned_rad, line);
        self.left_m.include(found.left_m, line);
        self.left_rad.include(found.left_rad, line);
    }

    /// Adds what is left of a target with its numbers as they are written, and whether it is not reached.
    pub(super) fn include_left(&mut self, line: usize, (metres, radians): (f64, f64), is_unreached: bool) {
        self.left_m.include(metres, line);
        self.left_rad.include(radians, line);
        if is_unreached {
            self.unreached.1 = if self.unreached.0 == 0 { line } else { self.unreached.1 };
            self.unreached.0 += 1;
        }
    }

    /// The summary in words, for the terminal; joints that slide are told by their names.
    #[must_use]
    pub fn text(&self, slides: &dyn Fn(&str) -> bool, what: &str) -> String {
        let mut out = String::new();
        let mm = |it: f64| format!("{:.4} mm", it * 1e3);
        let degrees = |it: f64| format!("{:.4} deg", it.to_degrees());
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
        let left = |out: &mut String, words: &str, metres: &Largest, radians: &Largest| {
            let _ = writeln!(
                out,
                "{words}: at most {:.1e} mm (line {}) and {:.1e} deg (line {})",
                metres.value * 1e3,
                metres.line,
                radians.value.to_degrees(),
                radians.line
            );
        };
        left(&mut out, "left after correction", &self.left_m, &self.left_rad);
        if let Some((metres, radians)) = &self.checked {
            left(&mut out, "checked from the written numbers", metres, radians);
        }
        out
    }

    /// What a user has to look at, a sentence each.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut out = Vec::new();
        let of = |count: usize, one: &str, several: &str| {
            if count == 1 { format!("1 target {one}") } else { format!("{count} targets {several}") }
        };
        if self.unreached.0 > 0 {
            out.push(format!(
                "{} be reached by the actual robot, the first on line {}: there the nearest configuration is written",
                of(self.unreached.0, "cannot", "cannot"),
                self.unreached.1
            ));
        }
        if self.beyond_limits.0 > 0 {
            out.push(format!(
                "{} beyond their joint's limits once corrected, the first of joint `{}` on line {}",
                if self.beyond_limits.0 == 1 {
                    "1 reading is".to_owned()
                } else {
                    format!("{} readings are", self.beyond_limits.0)
                },
                self.beyond_limits.2,
                self.beyond_limits.1
            ));
        }
        if self.other_branches.0 > 0 {
            out.push(format!(
                "{} reached on another branch, since a singularity lies between the drawing and the robot, the first on line {}: look at \
                 the motion there",
                of(self.other_branches.0, "is", "are"),
                self.other_branches.1
            ));
        }
        if self.jumps.0 > 0 {
            out.push(format!(
                "the correction jumps between consecutive targets ({} times), most on line {} (by {:.4} rad or m): near singularities",
                self.jumps.0, self.jumps.1.line, self.jumps.1.value
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
        let mut largest = Largest::default();
        largest.include(2.0, 7);
        largest.include(1.0, 8);
        assert_eq!((largest.value, largest.line), (2.0, 7));
    }

    #[test]
    fn rows_are_counted() {
        let robot = crate::robot::tests::elbow();
        let mut compensation = Compensation::new(&robot, &robot, &[]).unwrap();
        let mut summary = Summary::new(&compensation);
        let meant = [0.1; 6];
        summary.include(2, &meant, &compensation.joints(&meant));
        assert_eq!((summary.rows, summary.mean_moved_m()), (1, 0.0));
    }
}
