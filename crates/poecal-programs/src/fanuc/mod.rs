//! Positions of programs of FANUC in their printed form (LS): `P[n]` of the section `/POS`, as joints or as poses.
//!
//! A position itself states its user frame, its tool and its configuration. The frames and tools are in the controller, and the user states them.
//! Positions of joints are the controller's readings, whose third joint is measured from the horizontal and not from the lower arm. The readings of
//! a calibration by the controller's joints have the same convention.

pub(crate) mod configuration;
mod instructions;
mod positions;
mod words;

use std::collections::HashMap;

pub(crate) use configuration::FanucConfiguration;
use instructions::{FanucMotion, Instructions};
use positions::{GroupPose, Position, PositionGroup, positions};
pub(crate) use words::RULES;
use words::{tokens, whole_number};

use super::axes::{ControllerAxes, NO_EXTERNAL, OTHER_EXTERNAL};
use super::forms::PoseForm;
use super::parsed_program::{Number, ParsedProgram, PoseMeaning, ProgramMotion, ProgramTarget};
use super::stated_configuration::StatedConfiguration;
use super::stated_frames::StatedFrames;
use poecal_arm::lie::Pose;

/// The group of axes that is the arm.
const ARM: u32 = 1;

/// A section's name in upper case, if a line begins one.
fn section(line: &[u8]) -> Option<String> {
    let name = line.trim_ascii().strip_prefix(b"/")?;
    let name = name.split(|it| !it.is_ascii_alphabetic()).next().filter(|it| !it.is_empty())?;
    std::str::from_utf8(name).ok().map(str::to_ascii_uppercase)
}

/// The positions and motions of a program.
pub(crate) fn parse(text: &[u8], given: &StatedFrames, axes: &ControllerAxes) -> ParsedProgram {
    let mut instructions = Instructions::new(text);
    let mut name = String::new();
    let mut all = Vec::new();
    let mut start = 0;
    let mut tracked = None;
    for (number, line) in text.split_inclusive(|it| *it == b'\n').enumerate() {
        let range = start..start + line.len();
        start = range.end;
        if let Some(found) =
            section(line).filter(|it| matches!(it.as_str(), "PROG" | "ATTR" | "APPL" | "MN" | "POS" | "END"))
        {
            if found == "POS" && name != "POS" {
                all = positions(text, range.end, number + 2);
            }
            name = found;
        } else if name == "MN" {
            instructions.line(range, number + 1);
        } else if name == "APPL" && tracked.is_none() && follows_line(line) {
            tracked = Some(number + 1);
        }
    }
    FanucBuilder { given, axes, tracked, out: ParsedProgram::default(), targets: HashMap::new() }
        .all(all, &instructions)
}

/// True if a line of the section `/APPL` states that the program follows a moving line.
fn follows_line(line: &[u8]) -> bool {
    let text = String::from_utf8_lossy(line).to_ascii_uppercase();
    let number =
        text.split_once(':').and_then(|(_, it)| it.trim().trim_end_matches([';', ',']).trim().parse::<u32>().ok());
    text.contains("LINE_TRACK_SCHEDULE_NUMBER") && number.is_some_and(|it| it > 0)
}

/// A target, with tool, frame and configuration of the motions to it.
type FanucTarget = (ProgramTarget, Option<Pose>, Option<Pose>, StatedConfiguration);

struct FanucBuilder<'a> {
    given: &'a StatedFrames,
    axes: &'a ControllerAxes,
    /// Line which states that the program follows a moving line.
    tracked: Option<usize>,
    out: ParsedProgram,
    /// Motion of each position.
    targets: HashMap<u32, ProgramMotion>,
}

impl FanucBuilder<'_> {
    fn all(mut self, positions: Vec<Position>, instructions: &Instructions<'_>) -> ParsedProgram {
        let mut count: HashMap<u32, usize> = HashMap::new();
        for position in &positions {
            *count.entry(position.number).or_default() += 1;
        }
        for position in positions {
            let is_double = count.get(&position.number).is_some_and(|it| *it > 1);
            let moves = instructions.moves_to(position.number);
            let (line, name) = (position.line, position.name.clone());
            let made = if is_double { Err("stated more than once".to_owned()) } else { self.target(&position, &moves) };
            match made {
                Ok((target, tool, frame, stated)) => {
                    let at = self.out.targets.len();
                    self.out.targets.push(target);
                    self.targets.insert(
                        position.number,
                        ProgramMotion { tool, frame, stated, ..ProgramMotion::from_target(at, line) },
                    );
                }
                Err(reason) => self.out.list(line, name, reason),
            }
        }
        self.motions(instructions);
        self.out.listed.extend(instructions.listed.iter().cloned());
        self.out.sorted()
    }

    /// Motions in the order of the text, then positions without one: they are corrected too, since another program or a computed index may lead
    /// there.
    fn motions(&mut self, instructions: &Instructions<'_>) {
        let mut is_moved = vec![false; self.out.targets.len()];
        for (number, of) in &instructions.moves {
            if let Some(motion) = self.targets.get(number) {
                is_moved[motion.target] = true;
                let motion = ProgramMotion { line: of.line, is_straight: of.is_straight, ..motion.clone() };
                self.out.motions.push(motion);
            }
        }
        let mut rest: Vec<&ProgramMotion> = self.targets.values().filter(|it| !is_moved[it.target]).collect();
        rest.sort_by_key(|it| it.target);
        self.out.motions.extend(rest.into_iter().cloned());
    }

    /// The external axes of the model, and the others.
    fn external<'o>(&self, all: &'o [Option<Number>]) -> Result<(Vec<Number>, &'o [Option<Number>]), String> {
        let (own, others) = all.split_at_checked(self.axes.external.len()).ok_or(NO_EXTERNAL)?;
        let own: Option<Vec<Number>> = own.iter().cloned().collect();
        Ok((own.ok_or(NO_EXTERNAL)?, others))
    }

    fn target(&self, position: &Position, moves: &[&FanucMotion]) -> Result<FanucTarget, String> {
        // Other groups in the position move without this arm, except for motions with COORD.
        let mut own = position.groups.iter().filter(|(number, _)| [0, ARM].contains(number));
        let group = match (own.next(), own.next()) {
            (Some((_, group)), None) => group,
            (None, _) => {
                return Err("it is not of group 1, the arm: correct the group's own robot".to_owned());
            }
            (Some(_), Some(_)) => return Err("it states group 1 more than once: leave one out".to_owned()),
        };
        if let Some(of) = moves.iter().find(|it| it.is_incremental) {
            return Err(format!("moved to by INC on line {}: it is a distance, not a place", of.line));
        }
        let (line, name) = (position.line, position.name.clone());
        match group {
            PositionGroup::Joints(numbers, external) => {
                let (external, _) = self.external(external)?;
                let numbers = self.axes.join_readings(numbers, &external).ok_or("it has other axes than the robot")?;
                Ok((
                    ProgramTarget { line, name, numbers, meant: PoseMeaning::Joints },
                    None,
                    None,
                    StatedConfiguration::Nothing,
                ))
            }
            PositionGroup::Pose(pose) => {
                let (numbers, tool, frame, stated) = self.pose(pose, moves)?;
                let meant = PoseMeaning::Pose(PoseForm::Wpr);
                Ok((ProgramTarget { line, name, numbers, meant }, Some(tool), Some(frame), stated))
            }
            PositionGroup::Unknown(reason) => Err((*reason).to_owned()),
        }
    }

    /// Numbers, tool, frame and configuration of a pose.
    fn pose(
        &self,
        pose: &GroupPose,
        moves: &[&FanucMotion],
    ) -> Result<(Vec<Number>, Pose, Pose, StatedConfiguration), String> {
        if let Some(line) = self.tracked {
            return Err(format!("the program follows a moving line (line {line})"));
        }
        if let Some(of) = moves.iter().find(|it| it.is_coordinated) {
            return Err(format!(
                "moved to together with another group, or with a tool that stands, on line {}",
                of.line
            ));
        }
        let (external, others) = self.external(&pose.external)?;
        if others.iter().any(|it| it.as_ref().is_none_or(|it| it.value != 0.0)) {
            return Err(OTHER_EXTERNAL.to_owned());
        }
        let (Some(frame), Some(tool)) = (pose.frame, pose.tool) else {
            return Err("its user frame or its tool is not a number".to_owned());
        };
        for of in moves {
            let line = of.line;
            if let Some(active) = of.frame.filter(|it| *it != frame) {
                return Err(format!("stated in user frame {frame}, but moved to in {active} on line {line}"));
            }
            if let Some(active) = of.tool.filter(|it| *it != tool) {
                return Err(format!("stated with tool {tool}, but moved to with {active} on line {line}"));
            }
        }
        let known = |given: Option<Pose>, number: u32, what: &str, flag: &str| {
            let own = (number == 0).then(Pose::identity);
            given.or(own).ok_or_else(|| {
                format!("its {what} {number} is not in the file: state it by {flag} {number}=X,Y,Z,W,P,R")
            })
        };
        let frame = known(self.given.frame(Some(&frame.to_string())), frame, "user frame", "--work-object")?;
        let tool = known(self.given.tool(Some(&tool.to_string())), tool, "tool", "--tool-data")?;
        let configuration = pose.configuration.clone().ok_or("its configuration is not understood")?;
        let numbers = pose.numbers.iter().chain(&external).cloned().collect();
        Ok((numbers, tool, frame, StatedConfiguration::Fanuc(configuration)))
    }
}
