//! What the compensation of a program changes.

use std::fmt::Write as _;

use serde::Serialize;

use super::super::{Largest, Summary};
use super::Language;
use super::engine::Engine;
use super::parsed::{Listed, Meant, Number, Parsed};
use crate::lie::Pose;
use crate::robot::Robot;

/// What the compensation of a program changes, and what stays as it is.
#[derive(Clone, Debug, Serialize)]
pub struct ProgramSummary {
    /// The language.
    pub language: Language,
    /// Number of targets that are corrected.
    pub corrected: usize,
    /// What stays as it is, in the order of the lines.
    pub listed: Vec<Listed>,
    /// Corrections and what is left of the targets that are corrected.
    #[serde(flatten)]
    pub changes: Summary,
}

impl ProgramSummary {
    /// Whether every target that was found is corrected.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.listed.is_empty()
    }

    /// What a user has to look at, a sentence each.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut out = self.changes.warnings();
        if !self.listed.is_empty() {
            let (count, first) = (self.listed.len(), self.listed.first().map_or(0, |it| it.line));
            let are = if count == 1 { "1 target is".to_owned() } else { format!("{count} targets are") };
            out.push(format!(
                "{are} left as the program has them, the first on line {first}: the robot will miss them"
            ));
        }
        out
    }

    /// The summary in words, for the terminal; joints that slide are told by their names.
    #[must_use]
    pub fn text(&self, slides: &dyn Fn(&str) -> bool) -> String {
        let mut out = String::new();
        let what = if self.corrected == 1 { "target" } else { "targets" };
        if self.corrected > 0 {
            out = self.changes.text(slides, &format!("{what} corrected"));
        } else {
            let _ = writeln!(out, "0 targets corrected");
        }
        if !self.listed.is_empty() {
            let count = self.listed.len();
            let what = if count == 1 { "target is left as it is" } else { "targets are left as they are" };
            let _ = writeln!(out, "{count} {what}:");
        }
        for it in &self.listed {
            let _ = writeln!(out, "  line {}: {}: {}", it.line, crate::text::visible(&it.name), it.reason);
        }
        out
    }
}

/// Distance and angle that are left of a written program, by the robots' own forward kinematics.
pub(super) fn checked(
    engine: &Engine<'_>,
    (nominal, actual): (&Robot, &Robot),
    factors: &[f64],
    written: &Parsed,
    meant: &[(usize, Vec<f64>)],
) -> (Largest, Largest) {
    let mut places: Vec<Option<(Pose, Pose)>> = vec![None; written.targets.len()];
    for motion in &written.motions {
        if let (Some(place), Some(tool), Some(frame)) =
            (places.get_mut(motion.target), motion.tool, motion.frame)
        {
            *place = Some((tool, frame));
        }
    }
    let mut largest = (Largest::default(), Largest::default());
    for (index, q) in meant {
        let Some(target) = written.targets.get(*index) else { continue };
        let numbers: Vec<f64> = target.numbers.iter().map(Number::scaled).collect();
        let wanted = nominal.forward_kinematics(q);
        let mut commanded = match target.meant {
            Meant::Joints => numbers,
            Meant::Pose(form) => {
                let pose = |it: &[f64]| form.pose(it.get(..form.names().len()).unwrap_or(&[]));
                let place = places.get(*index).copied().flatten();
                let (Some(new), Some((tool, frame))) = (pose(&numbers), place) else { continue };
                let base_from_tip: Pose =
                    engine.given.base * frame * new * (engine.given.flange * tool).inverse();
                let mut own = engine.poses.of_arm(q);
                engine.poses.compensation().nominal().nearest(&base_from_tip, &mut own);
                engine.poses.of_robot(&own, q)
            }
        };
        commanded.extend_from_slice(factors);
        let (metres, radians) = actual.forward_kinematics(&commanded).apart(&wanted);
        largest.0.include(metres, target.line);
        largest.1.include(radians, target.line);
    }
    largest
}
