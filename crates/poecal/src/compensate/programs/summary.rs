//! What the compensation of a program changes.

use serde::Serialize;

use super::super::{Checked, Summary};
use super::Language;
use super::engine::Engine;
use super::parsed::{Meant, Number, Parsed};
use crate::lie::Pose;
use crate::robot::Robot;

/// What the compensation of a program changes, and what stays as it is.
#[derive(Clone, Debug, Serialize)]
pub struct ProgramSummary {
    /// The language.
    pub language: Language,
    /// Number of targets that are corrected.
    pub corrected: usize,
    /// Corrections, what is left of the targets that are corrected, and what stays as it is.
    #[serde(flatten)]
    pub changes: Summary,
}

impl ProgramSummary {
    /// Whether every target that was found is corrected.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.changes.is_whole()
    }

    /// The summary in words, for the terminal; joints that slide are told by their names.
    #[must_use]
    pub fn text(&self, slides: &dyn Fn(&str) -> bool) -> String {
        self.changes.text(slides, if self.corrected == 1 { "target corrected" } else { "targets corrected" })
    }
}

/// What a written program leaves, by the robots' own forward kinematics.
pub(super) fn checked(
    engine: &Engine<'_>,
    (nominal, actual): (&Robot, &Robot),
    factors: &[f64],
    written: &Parsed,
    meant: &[(usize, Vec<f64>)],
) -> Checked {
    let mut places: Vec<Option<(Pose, Pose)>> = vec![None; written.targets.len()];
    for motion in &written.motions {
        if let (Some(place), Some(tool), Some(frame)) =
            (places.get_mut(motion.target), motion.tool, motion.frame)
        {
            *place = Some((tool, frame));
        }
    }
    let mut largest = Checked::default();
    for (index, q) in meant {
        let Some(target) = written.targets.get(*index) else { continue };
        let numbers: Vec<f64> = target.numbers.iter().map(Number::scaled).collect();
        let wanted = nominal.forward_kinematics(q);
        let mut commanded = match target.meant {
            Meant::Joints => engine.readings(numbers),
            Meant::Pose(form) => {
                let pose = |it: &[f64]| form.pose(it.get(..form.names().len()).unwrap_or(&[]));
                let place = places.get(*index).copied().flatten();
                let (Some(new), Some((tool, frame))) = (pose(&numbers), place) else { continue };
                let base_from_tip: Pose =
                    engine.given.base * frame * new * (engine.given.flange * tool).inverse();
                let poses = engine.at(q);
                let mut own = poses.of_arm(q);
                poses.compensation().nominal().nearest(&base_from_tip, &mut own);
                poses.of_robot(&own, q)
            }
        };
        let share = engine.at(q).compensation().share_of_most(q, &commanded);
        largest.change.include(share, target.line);
        commanded.extend_from_slice(factors);
        largest.include(actual.forward_kinematics(&commanded).apart(&wanted), target.line);
    }
    largest
}
