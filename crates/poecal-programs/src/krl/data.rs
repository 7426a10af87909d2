//! Lists of data (`.dat`): targets with the tool and base of their points; the motions are in other files.

use super::super::forms::PoseForm;
use super::super::given::Given;
use super::super::parsed::{Meant, Motion, Number, Parsed, Target};
use super::reason;
use super::status::Status;
use super::values::{Place, Value, Variable, Variables};
use poecal_arm::lie::Pose;

/// Names of the controller's own data, which are no targets.
const NO_TARGETS: [&str; 5] = ["TOOL_DATA", "BASE_DATA", "LOAD_DATA", "MACHINE_DEF", "$"];

/// Targets of a list of data.
pub(crate) fn parse(variables: &Variables, given: &Given) -> Parsed {
    let mut all: Vec<(&String, &Variable)> = variables.known.iter().collect();
    all.sort_by_key(|(_, it)| it.line);
    let mut out = Parsed::default();
    for (key, variable) in all {
        if NO_TARGETS.iter().any(|it| key.starts_with(it)) {
            continue;
        }
        let is_target = matches!(variable.value, Value::Pose(..) | Value::Joints(_) | Value::Broken(_));
        let refused = match (&variable.value, variables.of_name(key)) {
            (Value::Broken(reason), _) => Some(*reason),
            (_, Err(reason)) if is_target => Some(reason),
            (Value::Pose(..), Ok(_)) if variable.is_frame => Some(reason::FRAME),
            _ => None,
        };
        if let Some(reason) = refused {
            out.list(variable.line, &variable.name, reason);
            continue;
        }
        match &variable.value {
            Value::Pose(numbers, status) => {
                let place = of_point(variables, key);
                out.motions.push(motion(out.targets.len(), variable.line, *status, place, variables, given));
                out.targets.push(target(variable, numbers.clone(), Meant::Pose(PoseForm::Abc)));
            }
            Value::Joints(numbers) => out.targets.push(target(variable, numbers.clone(), Meant::Joints)),
            Value::Broken(_) | Value::Place(_) | Value::Name(_) | Value::Other => {}
        }
    }
    out
}

fn target(variable: &Variable, numbers: Vec<Number>, meant: Meant) -> Target {
    Target { line: variable.line, name: variable.name.clone(), numbers, meant }
}

/// Tool and base of a point in the file: those of XP1 are in FP1.
fn of_point(variables: &Variables, key: &str) -> Option<Place> {
    variables.place(&format!("F{}", key.strip_prefix('X')?))
}

fn motion(
    target: usize,
    line: usize,
    status: Status,
    place: Option<Place>,
    variables: &Variables,
    given: &Given,
) -> Motion {
    let (tool, frame, refused) = match place {
        None => (given.tool(None), given.frame(None), None),
        Some(place) if place.is_external => (None, None, Some(reason::FOREIGN)),
        Some(place) => {
            let tool = place.tool.and_then(|it| numbered("TOOL_DATA", it, variables, given));
            let frame = place.base.and_then(|it| numbered("BASE_DATA", it, variables, given));
            let refused = (tool.is_none() || frame.is_none()).then_some(reason::PLACE);
            (tool, frame, refused)
        }
    };
    let (frame, refused) = (frame.filter(|_| !variables.moves_root), refused.map(str::to_owned));
    Motion { tool, frame, stated: status.into(), refused, ..Motion::to(target, line) }
}

/// A tool or base by its number, from the file or the user; number 0 is the identity.
pub(crate) fn numbered(list: &str, number: i64, variables: &Variables, given: &Given) -> Option<Pose> {
    if number == 0 {
        return Some(Pose::identity());
    }
    let user =
        |name: &str| if list == "TOOL_DATA" { given.tool(Some(name)) } else { given.frame(Some(name)) };
    user(&number.to_string()).or_else(|| stated(&format!("{list}[{number}]"), variables))
}

/// The pose of a variable that is assigned once.
pub(crate) fn stated(key: &str, variables: &Variables) -> Option<Pose> {
    let Value::Pose(numbers, _) = &variables.of_name(key).ok()?.value else { return None };
    PoseForm::Abc.of_numbers(numbers)
}
