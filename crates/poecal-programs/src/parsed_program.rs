//! Common result of the languages: targets of a program, its motions, and parts that cannot be corrected.

use std::collections::BTreeMap;

use super::forms::PoseForm;
pub use super::number::Number;
use super::stated_configuration::StatedConfiguration;
use super::unchanged_statements::UnchangedStatement;
use poecal_arm::lie::Pose;

/// A program as interpreted by its language.
#[derive(Clone, Debug, Default)]
pub struct ParsedProgram {
    /// Targets that are stated by numbers, in the order of the text.
    pub targets: Vec<ProgramTarget>,
    /// Motions to these targets, in the order of motion as far as it is known; each comes after [`ProgramMotion::after`].
    pub motions: Vec<ProgramMotion>,
    /// Parts that cannot be corrected for reasons of the language.
    pub listed: Vec<UnchangedStatement>,
    /// Targets by the first byte of their numbers.
    known: BTreeMap<usize, usize>,
}

impl ParsedProgram {
    /// Lists a target that stays unchanged.
    pub(crate) fn list(&mut self, line: usize, name: impl Into<String>, reason: impl Into<String>) {
        self.listed.push(UnchangedStatement { line, name: name.into(), reason: reason.into() });
    }

    /// Sorts the list in the order of the text, without repetitions.
    pub(crate) fn sorted(mut self) -> Self {
        self.listed.sort();
        self.listed.dedup();
        self
    }

    /// The index of a target, which is added if its numbers are new.
    pub(crate) fn target(&mut self, target: ProgramTarget) -> usize {
        let new = self.targets.len();
        let index = *self.known.entry(target.start()).or_insert(new);
        if index == new {
            self.targets.push(target);
        }
        index
    }

    /// True if there is a target with these numbers.
    pub(crate) fn knows(&self, numbers: &[Number]) -> bool {
        numbers.first().is_some_and(|it| self.known.contains_key(&it.range.start))
    }
}

/// A target that is stated by numbers. It is corrected if all motions to it have the same meaning.
#[derive(Clone, Debug)]
pub struct ProgramTarget {
    /// Line of the program with the numbers, from 1.
    pub line: usize,
    /// Its name, or its text.
    pub name: String,
    /// Its numbers: one for each reading; or those of a pose in its form, then the words of its configuration, if there are any
    /// ([`StatedConfiguration::words`]).
    pub numbers: Vec<Number>,
    /// Meaning of its numbers.
    pub meant: PoseMeaning,
}

impl ProgramTarget {
    /// The first byte of its numbers.
    fn start(&self) -> usize {
        self.numbers.first().map_or(0, |it| it.range.start)
    }

    /// Its numbers in the unit of their meaning.
    pub fn scaled_numbers(&self) -> Vec<f64> {
        self.numbers.iter().map(Number::scaled_value).collect()
    }
}

/// Meaning of the numbers of a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseMeaning {
    /// Readings in the robot's order; a number times its [`Number::scale`] is in rad, or in m for a prismatic joint.
    Joints,
    /// A pose of the tool in its frame; a number times its [`Number::scale`] is in the unit of the form.
    Pose(PoseForm),
}

/// A motion to a target.
#[derive(Clone, Debug)]
pub struct ProgramMotion {
    /// Index of the target.
    pub target: usize,
    /// Line of the program, from 1.
    pub line: usize,
    /// Index of the motion before it, if the program has one that is always the one before.
    pub after: Option<usize>,
    /// True if the path to it is straight in space, or an arc.
    pub is_straight: bool,
    /// `flange_from_tcp`, the tool in the controller's flange; `None` if it is not known, and for joints.
    pub tool: Option<Pose>,
    /// `base_from_frame`, the frame of the pose in the controller's base; `None` if it is not known, and for joints.
    pub frame: Option<Pose>,
    /// Configuration that the program states.
    pub stated: StatedConfiguration,
    /// Reason why the target cannot be corrected, if the language already determines it.
    pub refused: Option<String>,
}

impl ProgramMotion {
    /// A motion to a target without further information.
    pub(crate) fn from_target(target: usize, line: usize) -> Self {
        let (tool, frame, stated, refused) = (None, None, StatedConfiguration::Nothing, None);
        ProgramMotion { target, line, after: None, is_straight: false, tool, frame, stated, refused }
    }
}

impl PoseForm {
    /// The pose of numbers of a program; `None` as for [`PoseForm::pose`].
    pub(crate) fn of_numbers(self, numbers: &[Number]) -> Option<Pose> {
        self.pose(&numbers.iter().map(Number::scaled_value).collect::<Vec<f64>>())
    }
}

/// A tool or a frame while a program runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum ActiveFrame {
    /// The program has not set it: the user's value applies.
    #[default]
    Unset,
    /// The program has set it to this pose.
    Is(Pose),
    /// The program has set it to an unknown value.
    Unknown,
}

impl ActiveFrame {
    /// The pose, or the user's pose for programs that set none.
    pub(crate) fn pose_or(&self, given: Option<Pose>) -> Option<Pose> {
        match self {
            ActiveFrame::Unset => given,
            ActiveFrame::Is(pose) => Some(*pose),
            ActiveFrame::Unknown => None,
        }
    }
}
