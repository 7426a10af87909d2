//! Changes of a program by compensation.

use serde::Serialize;

use super::super::{CompensationSummary, ForwardCheck};
use super::engine::Engine;
use poecal_arm::lie::Pose;
use poecal_model::robot::Robot;
use poecal_programs::Language;
use poecal_programs::parsed_program::{ParsedProgram, PoseMeaning};

/// Changes of a program by compensation, and unchanged targets.
#[derive(Clone, Debug, Serialize)]
pub struct ProgramSummary {
    /// The language.
    pub language: Language,
    /// Number of corrected targets.
    pub corrected: usize,
    /// Corrections, the remaining error of corrected targets, and unchanged targets.
    #[serde(flatten)]
    pub changes: CompensationSummary,
}

impl ProgramSummary {
    /// True if every detected target is corrected.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.changes.is_whole()
    }

    /// The summary in words, for the terminal; sliding joints are listed by their names.
    #[must_use]
    pub fn text(&self, slides: &dyn Fn(&str) -> bool) -> String {
        self.changes.text(slides, if self.corrected == 1 { "target corrected" } else { "targets corrected" })
    }
}

/// Remaining error of a written program, by the robots' own forward kinematics.
pub(crate) fn check_written(
    engine: &Engine<'_>,
    (nominal, actual): (&Robot, &Robot),
    factors: &[f64],
    written: &ParsedProgram,
    meant: &[(usize, Vec<f64>)],
) -> ForwardCheck {
    let mut places: Vec<Option<(Pose, Pose)>> = vec![None; written.targets.len()];
    for motion in &written.motions {
        if let (Some(place), Some(known)) = (places.get_mut(motion.target), motion.tool.zip(motion.frame)) {
            *place = Some(known);
        }
    }
    let mut largest = ForwardCheck::default();
    for (index, q) in meant {
        let Some(target) = written.targets.get(*index) else { continue };
        let numbers = target.scaled_numbers();
        let wanted = nominal.forward_kinematics(q);
        let mut commanded = match target.meant {
            PoseMeaning::Joints => engine.readings(numbers),
            PoseMeaning::Pose(form) => {
                let place = places.get(*index).copied().flatten();
                let (Some(new), Some(place)) = (form.of_first(&numbers), place) else { continue };
                let poses = engine.compensation_at(q);
                poses.of_robot(&engine.commanded_by(poses, &new, place, q), q)
            }
        };
        let share = engine.compensation_at(q).compensation().share_of_most(q, &commanded);
        largest.change.include(share, target.line);
        commanded.extend_from_slice(factors);
        largest.include(actual.forward_kinematics(&commanded).distance_and_angle(&wanted), target.line);
    }
    largest
}
