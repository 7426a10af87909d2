//! Lists of data (`.dat`): targets with the tool and base of their points; the motions are in other files.

use super::super::forms::PoseForm;
use super::super::parsed_program::{Number, ParsedProgram, PoseMeaning, ProgramMotion, ProgramTarget};
use super::super::stated_frames::StatedFrames;
use super::reason;
use super::status::Status;
use super::values::{KrlValue, KrlVariable, KrlVariables, ToolAndBase};
use poecal_arm::lie::Pose;

/// Names of the controller's own data, which are no targets.
const NO_TARGETS: [&str; 5] = ["TOOL_DATA", "BASE_DATA", "LOAD_DATA", "MACHINE_DEF", "$"];

/// Targets of a list of data.
pub(crate) fn parse(variables: &KrlVariables, given: &StatedFrames) -> ParsedProgram {
    let mut all: Vec<(&String, &KrlVariable)> = variables.known.iter().collect();
    all.sort_by_key(|(_, it)| it.line);
    let mut out = ParsedProgram::default();
    for (key, variable) in all {
        if NO_TARGETS.iter().any(|it| key.starts_with(it)) {
            continue;
        }
        let is_target = matches!(variable.value, KrlValue::Pose(..) | KrlValue::Joints(_) | KrlValue::Broken(_));
        let refused = match (&variable.value, variables.of_name(key)) {
            (KrlValue::Broken(reason), _) => Some(*reason),
            (_, Err(reason)) if is_target => Some(reason),
            (KrlValue::Pose(..), Ok(_)) if variable.is_frame => Some(reason::FRAME),
            _ => None,
        };
        if let Some(reason) = refused {
            out.list(variable.line, &variable.name, reason);
            continue;
        }
        match &variable.value {
            KrlValue::Pose(numbers, status) => {
                let place = of_point(variables, key);
                out.motions.push(motion(out.targets.len(), variable.line, *status, place, variables, given));
                out.targets.push(target(variable, numbers.clone(), PoseMeaning::Pose(PoseForm::Abc)));
            }
            KrlValue::Joints(numbers) => out.targets.push(target(variable, numbers.clone(), PoseMeaning::Joints)),
            KrlValue::Broken(_) | KrlValue::Place(_) | KrlValue::Name(_) | KrlValue::Other => {}
        }
    }
    out
}

fn target(variable: &KrlVariable, numbers: Vec<Number>, meant: PoseMeaning) -> ProgramTarget {
    ProgramTarget { line: variable.line, name: variable.name.clone(), numbers, meant }
}

/// Tool and base of a point in the file: those of XP1 are in FP1.
fn of_point(variables: &KrlVariables, key: &str) -> Option<ToolAndBase> {
    variables.place(&format!("F{}", key.strip_prefix('X')?))
}

fn motion(
    target: usize,
    line: usize,
    status: Status,
    place: Option<ToolAndBase>,
    variables: &KrlVariables,
    given: &StatedFrames,
) -> ProgramMotion {
    let (tool, frame, refused) = match place {
        None => (given.tool(None), given.frame(None), None),
        Some(place) if place.is_external => (None, None, Some(reason::FOREIGN)),
        Some(place) => {
            let tool = place.tool.and_then(|it| numbered_frame("TOOL_DATA", it, variables, given));
            let frame = place.base.and_then(|it| numbered_frame("BASE_DATA", it, variables, given));
            let refused = (tool.is_none() || frame.is_none()).then_some(reason::PLACE);
            (tool, frame, refused)
        }
    };
    let (frame, refused) = (frame.filter(|_| !variables.moves_root), refused.map(str::to_owned));
    ProgramMotion { tool, frame, stated: status.into(), refused, ..ProgramMotion::from_target(target, line) }
}

/// A tool or base by its number, from the file or the user; number 0 is the identity.
pub(crate) fn numbered_frame(list: &str, number: i64, variables: &KrlVariables, given: &StatedFrames) -> Option<Pose> {
    if number == 0 {
        return Some(Pose::identity());
    }
    let user = |name: &str| if list == "TOOL_DATA" { given.tool(Some(name)) } else { given.frame(Some(name)) };
    user(&number.to_string()).or_else(|| stated_pose(&format!("{list}[{number}]"), variables))
}

/// The pose of a variable that is assigned once.
pub(crate) fn stated_pose(key: &str, variables: &KrlVariables) -> Option<Pose> {
    let KrlValue::Pose(numbers, _) = &variables.of_name(key).ok()?.value else { return None };
    PoseForm::Abc.of_numbers(numbers)
}
