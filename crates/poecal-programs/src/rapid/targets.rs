//! Conversion of declarations and moves to targets and motions, or to reasons why a target stays unchanged.

use std::collections::HashMap;

use super::super::axes::{ControllerAxes, NO_EXTERNAL, OTHER_EXTERNAL};
use super::super::forms::PoseForm;
use super::super::parsed_program::{Number, ParsedProgram, PoseMeaning, ProgramMotion, ProgramTarget};
use super::super::stated_configuration::StatedConfiguration;
use super::super::stated_frames::StatedFrames;
use super::configuration::RapidConfiguration;
use super::declarations::{DataDeclaration, Declarations, RapidDataKind};
use super::frames::{has_length, tool, work_object};
use super::move_sequence::{MoveFrame, RapidMove, RapidMoves, TargetReference};
use super::outline::RapidOutline;
use super::tokens::RapidValue;
use poecal_arm::lie::Pose;

/// Targets, motions and reasons.
pub(crate) fn parsed(
    moves: &RapidMoves,
    declared: &Declarations,
    outline: &RapidOutline,
    (given, axes): (&StatedFrames, &ControllerAxes),
    text: &[u8],
) -> ParsedProgram {
    let lines = text.iter().enumerate().filter(|(_, it)| **it == b'\n').map(|(at, _)| at).collect();
    let mut by_place: HashMap<&TargetReference, Vec<usize>> = HashMap::new();
    for (number, going) in moves.going.iter().enumerate() {
        by_place.entry(&going.to).or_default().push(number);
    }
    let mut maker = RapidBuilder {
        moves,
        by_place,
        declared,
        outline,
        given,
        axes,
        lines,
        motions: vec![None; moves.going.len()],
        more: Vec::new(),
        out: ParsedProgram::default(),
    };
    for (at, data) in declared.data.iter().enumerate() {
        if matches!(data.sort, RapidDataKind::Target | RapidDataKind::Joints)
            && let Some(value) = &data.value
        {
            maker.data(at, data, value);
        }
    }
    for (at, (name, value, is_joints)) in moves.in_place.iter().enumerate() {
        maker.read_value(name.clone(), 0, value, *is_joints, &TargetReference::InPlace(at));
    }
    maker.parsed()
}

/// Tool and frame of a motion.
type MotionSettings = (Pose, Pose);

struct RapidBuilder<'a> {
    moves: &'a RapidMoves,
    by_place: HashMap<&'a TargetReference, Vec<usize>>,
    declared: &'a Declarations,
    outline: &'a RapidOutline,
    given: &'a StatedFrames,
    axes: &'a ControllerAxes,
    /// Ends of lines.
    lines: Vec<usize>,
    /// Motion of each move.
    motions: Vec<Option<ProgramMotion>>,
    /// Motions to any element of an array.
    more: Vec<ProgramMotion>,
    out: ParsedProgram,
}

impl RapidBuilder<'_> {
    fn data(&mut self, at: usize, data: &DataDeclaration, value: &RapidValue) {
        let is_joints = data.sort == RapidDataKind::Joints;
        let reason = match (data.is_double, data.changed, data.given.first()) {
            (true, ..) => Some("declared more than once".to_owned()),
            (_, Some(line), _) => Some(format!("changed by the program on line {line}")),
            (.., given) => {
                given.map(|it| format!("given to {} on line {}, whose use of it is not known", it.to, it.line))
            }
        };
        if let Some(reason) = reason {
            return self.out.list(data.line, &data.name, reason);
        }
        let mut elements = Vec::new();
        spread(value, data.dimensions, &mut Vec::new(), &mut elements);
        for (index, value) in elements {
            let words: Vec<String> = index.iter().map(ToString::to_string).collect();
            let name = match words[..] {
                [] => data.name.clone(),
                _ => format!("{}{{{}}}", data.name, words.join(",")),
            };
            self.read_value(name, data.line, value, is_joints, &TargetReference::Data(at, index));
        }
    }

    /// Adds a target by its value and its position.
    fn read_value(&mut self, name: String, line: usize, value: &RapidValue, is_joints: bool, to: &TargetReference) {
        let line = first_number(value).map_or(line, |at| self.lines.partition_point(|end| *end < at) + 1);
        let own = self.by_place.get(to).cloned().unwrap_or_default();
        let any: &[RapidMove] = match to {
            TargetReference::Data(at, index) if !index.is_empty() => self.moves.to_any.get(at).map_or(&[], |it| it),
            TargetReference::Data(..) | TargetReference::InPlace(_) => &[],
        };
        let moves: Vec<&RapidMove> =
            own.iter().filter_map(|&it| Some(&self.moves.going.get(it)?.of)).chain(any).collect();
        let made = if is_joints {
            joints(value, self.axes).map(|it| (it, PoseMeaning::Joints, Vec::new()))
        } else {
            self.pose(value, &moves)
        };
        let (numbers, meant, known) = match made {
            Ok(made) => made,
            Err(reason) => return self.out.list(line, name, reason),
        };
        let target = self.out.targets.len();
        let stated = configuration(numbers.get(7..11).unwrap_or_default());
        if let (true, Some((tool, frame))) = (moves.is_empty(), known.first().copied()) {
            let (tool, frame, stated) = (Some(tool), Some(frame), stated.clone());
            self.more.push(ProgramMotion { tool, frame, stated, ..ProgramMotion::from_target(target, line) });
        }
        for (number, of) in moves.iter().enumerate() {
            let known = known.get(number);
            let motion = ProgramMotion {
                is_straight: of.is_straight,
                tool: known.map(|it| it.0),
                frame: known.map(|it| it.1),
                stated: if of.is_not_followed { StatedConfiguration::Nothing } else { stated.clone() },
                ..ProgramMotion::from_target(target, of.line)
            };
            match own.get(number).and_then(|&it| self.motions.get_mut(it)) {
                Some(place) => *place = Some(motion),
                None => self.more.push(motion),
            }
        }
        self.out.targets.push(ProgramTarget { line, name, numbers, meant });
    }

    fn pose(
        &self,
        value: &RapidValue,
        moves: &[&RapidMove],
    ) -> Result<(Vec<Number>, PoseMeaning, Vec<MotionSettings>), String> {
        const SHAPE: &str = "not written as [[x,y,z],[q1,q2,q3,q4],[cf1,cf4,cf6,cfx],[external axes]] with numbers";
        let Some([place, quaternion, configuration, external]) = value.list(4) else {
            return Err(SHAPE.into());
        };
        let mut all = place.numbers(3).ok_or(SHAPE)?;
        let quaternion = quaternion.numbers(4).ok_or(SHAPE)?;
        let configuration = configuration.numbers(4).ok_or(SHAPE)?;
        let external = external.numbers(6).ok_or(SHAPE)?;
        let mut known = Vec::new();
        if moves.is_empty() {
            // The moves are in another module: the user states their tool and work object.
            let (Some(tool), Some(frame)) = (self.given.tool(None), self.given.frame(None)) else {
                return Err(
                    "no move of this file goes to it: state its tool and work object by --tool-data and --work-object"
                        .to_owned(),
                );
            };
            known.push((tool, frame));
        }
        if let Some(line) = moves.iter().find_map(|it| it.displaced) {
            return Err(format!("a program displacement may be active: line {line} switches it on"));
        }
        let external = external_axes(external, self.axes)?;
        if configuration.iter().any(|it| it.value.fract() != 0.0 || it.value.abs() > 100.0) {
            return Err("its configuration is not written in whole numbers".to_owned());
        }
        if !has_length(&quaternion) {
            return Err("its quaternion has not the length 1".to_owned());
        }
        for of in moves {
            known.push((self.tool(&of.tool)?, self.frame(&of.object)?));
        }
        let first = known.first().copied();
        for (what, other) in [
            ("with different tools", known.iter().position(|it| Some(it.0) != first.map(|it| it.0))),
            ("in different work objects", known.iter().position(|it| Some(it.1) != first.map(|it| it.1))),
        ] {
            if let (Some(one), Some(other)) = (moves.first(), other.and_then(|at| moves.get(at))) {
                return Err(format!("moved {what}, on lines {} and {}", one.line, other.line));
            }
        }
        all.extend(quaternion);
        all.extend(configuration);
        all.extend(external);
        Ok((all, PoseMeaning::Pose(PoseForm::Quaternion), known))
    }

    fn tool(&self, held: &MoveFrame) -> Result<Pose, String> {
        self.known_pose(
            ("tool", "--tool-data"),
            held,
            RapidDataKind::Tool,
            self.given.tool(Some(self.name(held, "tool0"))),
            tool,
        )
    }

    fn frame(&self, held: &MoveFrame) -> Result<Pose, String> {
        let stated = self.given.frame(Some(self.name(held, "wobj0")));
        self.known_pose(("work object", "--work-object"), held, RapidDataKind::WorkObject, stated, work_object)
    }

    fn name<'b>(&'b self, held: &'b MoveFrame, built_in: &'b str) -> &'b str {
        match held {
            MoveFrame::BuiltIn => built_in,
            MoveFrame::Data(at) => self.declared.data.get(*at).map_or("", |it| it.name.as_str()),
            MoveFrame::Unknown(written) => written,
        }
    }

    /// A tool or a work object: as stated by the user, else as declared in the file.
    fn known_pose(
        &self,
        (what, flag): (&str, &str),
        held: &MoveFrame,
        sort: RapidDataKind,
        stated: Option<Pose>,
        read: fn(&RapidValue) -> Result<Pose, &'static str>,
    ) -> Result<Pose, String> {
        if let Some(stated) = stated {
            return Ok(stated);
        }
        let name = self.name(held, "");
        match held {
            MoveFrame::BuiltIn => Ok(Pose::identity()),
            MoveFrame::Unknown(_)
                if name.bytes().any(|it| it.is_ascii_punctuation() && it != b'_') || name.is_empty() =>
            {
                Err(format!("its {what} `{name}` is not known"))
            }
            MoveFrame::Unknown(_) => Err(format!("its {what} `{name}` is not in this file: state it by {flag}")),
            MoveFrame::Data(at) => {
                let data = self.declared.data.get(*at).filter(|it| it.sort == sort && !it.is_double);
                let data = data.ok_or_else(|| format!("its {what} `{name}` is not known"))?;
                if let Some(line) = data.changed {
                    return Err(format!("its {what} `{name}` is changed on line {line}"));
                }
                if let Some(given) = self.declared.changes_it(data, self.outline) {
                    let (to, line) = (&given.to, given.line);
                    return Err(format!("its {what} `{name}` is given to {to} on line {line}, which may change it"));
                }
                let value = data.value.as_ref().ok_or_else(|| format!("its {what} `{name}` has no numbers"))?;
                read(value).map_err(|reason| format!("its {what} `{name}` {reason}"))
            }
        }
    }

    fn parsed(mut self) -> ParsedProgram {
        // Numbers of motions, without moves that have none.
        let mut place = Vec::with_capacity(self.motions.len());
        let mut count = 0;
        for motion in &self.motions {
            place.push(motion.is_some().then_some(count));
            count += usize::from(motion.is_some());
        }
        let mut motions = Vec::with_capacity(count + self.more.len());
        for (motion, going) in self.motions.into_iter().zip(&self.moves.going) {
            // A stated configuration that is followed does not depend on the motion before.
            let after = going.after.filter(|_| going.of.is_not_followed);
            let after = after.and_then(|it| place.get(it).copied().flatten());
            motions.extend(motion.map(|motion| ProgramMotion { after, ..motion }));
        }
        motions.extend(self.more);
        self.out.motions = motions;
        self.out
    }
}

/// The configuration `[cf1,cf4,cf6,cfx]`.
fn configuration(numbers: &[Number]) -> StatedConfiguration {
    match numbers.iter().map(|it| it.value as i32).collect::<Vec<i32>>()[..] {
        [cf1, cf4, cf6, branch] => StatedConfiguration::Rapid(RapidConfiguration { quarters: [cf1, cf4, cf6], branch }),
        _ => StatedConfiguration::Nothing,
    }
}

/// Smallest value of an axis that means absence: `9E9`.
const NONE: f64 = 8.9e9;

/// The external axes of the model, mm; others must be absent, or at 0, where they do not affect the arm.
fn external_axes(mut numbers: Vec<Number>, axes: &ControllerAxes) -> Result<Vec<Number>, String> {
    let others = numbers.split_off(axes.external.len().min(numbers.len()));
    if others.iter().any(|it| it.value != 0.0 && it.value < NONE) {
        return Err(OTHER_EXTERNAL.to_owned());
    }
    if numbers.iter().any(|it| it.value >= NONE) {
        return Err(NO_EXTERNAL.to_owned());
    }
    numbers.iter_mut().for_each(|it| it.scale = 1e-3);
    Ok(numbers)
}

/// The joints `[[six angles in degrees],[external axes]]`. External axes that the model lacks do not change the arm's joint positions.
fn joints(value: &RapidValue, axes: &ControllerAxes) -> Result<Vec<Number>, String> {
    const SHAPE: &str = "not written as [[six angles],[external axes]] with numbers";
    let Some([arm, external]) = value.list(2) else { return Err(SHAPE.to_owned()) };
    let mut arm = arm.numbers(6).ok_or(SHAPE)?;
    let mut external = external.numbers(6).ok_or(SHAPE)?;
    external.truncate(axes.external.len());
    let external = external_axes(external, axes)?;
    if arm.iter().any(|it| it.value.abs() > 1e6) {
        return Err("has no angles of the arm".to_owned());
    }
    arm.iter_mut().for_each(|it| it.scale = 1_f64.to_radians());
    axes.join_readings(&arm, &external).ok_or_else(|| SHAPE.to_owned())
}

/// The elements of an array with this number of dimensions.
fn spread<'a>(
    value: &'a RapidValue,
    dimensions: usize,
    index: &mut Vec<usize>,
    out: &mut Vec<(Vec<usize>, &'a RapidValue)>,
) {
    if let RapidValue::List(values) = value
        && dimensions > 0
    {
        for (at, value) in values.iter().enumerate() {
            index.push(at + 1);
            spread(value, dimensions - 1, index, out);
            index.pop();
        }
    } else {
        out.push((index.clone(), value));
    }
}

/// The first byte of the first number of a value.
fn first_number(value: &RapidValue) -> Option<usize> {
    match value {
        RapidValue::Number(number) => Some(number.range.start),
        RapidValue::List(values) => values.iter().find_map(first_number),
        RapidValue::Word(_) | RapidValue::Text(_) | RapidValue::Other => None,
    }
}
