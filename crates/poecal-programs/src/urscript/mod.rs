//! URScript: the language of Universal Robots.

mod blocks;
mod reason;
mod step;
mod values;

use std::collections::BTreeSet;

use super::axes::ControllerAxes;
use super::flow::{FlowNode, FlowState, FlowWalk};
use super::forms::PoseForm;
use super::parsed_program::{ActiveFrame, Number, ParsedProgram, PoseMeaning, ProgramMotion, ProgramTarget};
use super::scan::{LexicalRules, Token, TokenKind, bracket, excerpt, is_one_of, parts};
use super::stated_configuration::StatedConfiguration;
use super::stated_frames::StatedFrames;
use blocks::Program;
use poecal_arm::lie::Pose;
use poecal_numerics::error::Result;
use step::{MotionArgument, PoseFrame, UrScriptMotionType, UrScriptStep};
use values::{UrScriptValue, UrScriptVariables};

pub(crate) const RULES: LexicalRules =
    LexicalRules { comments: &["#"], quotes: b"\"'", letters: b"", is_open_in_brackets: true };

/// Form of poses in the language.
const FORM: PoseForm = PoseForm::RotationVector;

/// Statements that move the robot to targets: their name, the indices of the targets among the arguments, and the path.
const MOTIONS: [(&str, &[usize], UrScriptMotionType); 9] = [
    ("movej", &[0], UrScriptMotionType::Joints),
    ("movel", &[0], UrScriptMotionType::Straight),
    ("movep", &[0], UrScriptMotionType::Straight),
    ("movec", &[0, 1], UrScriptMotionType::Straight),
    ("optimovej", &[0], UrScriptMotionType::Joints),
    ("optimovel", &[0], UrScriptMotionType::Straight),
    ("servoj", &[0], UrScriptMotionType::Stream),
    ("servoc", &[0], UrScriptMotionType::Stream),
    ("mc_add_linear", &[0], UrScriptMotionType::Unknown),
];

/// Statements after which the position of the robot is unknown.
const AWAY: &str = "speedj speedl freedrive_mode teach_mode force_mode move_until mc_run_motion tool_contact";

/// Targets and motions of a program.
pub(crate) fn parse(text: &[u8], given: &StatedFrames, axes: &ControllerAxes) -> Result<ParsedProgram> {
    let variables = UrScriptVariables::from_text(text, &RULES, axes);
    let mut reader = UrScriptReader { text, given, axes, variables, out: ParsedProgram::default() };
    let program = Program::read(text, &RULES, &mut |tokens, nodes| reader.statement(tokens, nodes))?;
    Ok(reader.motions(&program))
}

/// Reads statements.
struct UrScriptReader<'r> {
    text: &'r [u8],
    given: &'r StatedFrames,
    axes: &'r ControllerAxes,
    variables: UrScriptVariables,
    out: ParsedProgram,
}

/// A target of a motion, or the reason why it is none.
type TargetParse = std::result::Result<MotionArgument, String>;

impl UrScriptReader<'_> {
    /// Adds the effects of a statement as nodes.
    fn statement(&mut self, tokens: &[Token], nodes: &mut Vec<FlowNode<UrScriptStep>>) {
        for (at, token) in tokens.iter().enumerate() {
            let rest = &tokens[at + 1..];
            let Some((inside, _)) = bracket(rest, b'(', b')') else { continue };
            let name = token.text(self.text);
            let is_run = at > 0 && is_one_of("run join kill", tokens[at - 1].text(self.text));
            if self.variables.routines.contains(name) {
                self.arguments(inside);
                if !is_run {
                    nodes.push(FlowNode::Call(name.to_owned()));
                }
                continue;
            }
            let arguments = parts(inside);
            if let Some((_, places, way)) = MOTIONS.iter().find(|it| it.0 == name) {
                for &place in *places {
                    let argument = arguments.get(place).copied().unwrap_or(&[]);
                    let step = self.motion(token, argument, *way);
                    nodes.push(FlowNode::Step(step));
                }
            } else if name == "set_tcp" {
                let setting = self.tool(arguments.first().copied().unwrap_or(&[]));
                nodes.push(FlowNode::Step(UrScriptStep::Tool(setting)));
            } else if name.starts_with("track_conveyor") || name == "stop_conveyor_tracking" {
                nodes.push(FlowNode::Step(UrScriptStep::Moving(name.starts_with("track"))));
            } else if is_one_of(AWAY, name) {
                if name.starts_with("speed") {
                    self.list(&tokens[at..], token.line, reason::SPEED);
                }
                nodes.push(FlowNode::Step(UrScriptStep::Away));
            }
        }
    }

    fn list(&mut self, tokens: &[Token], line: usize, reason: &str) {
        self.out.list(line, excerpt(self.text, tokens), reason);
    }

    /// Lists targets that are passed to a routine.
    fn arguments(&mut self, inside: &[Token]) {
        for argument in parts(inside) {
            let is_target = match self.variables.value(self.text, argument, self.axes) {
                UrScriptValue::Pose(_) | UrScriptValue::Joints(_) => true,
                UrScriptValue::Name(name) => {
                    matches!(self.variables.of_name(&name), Ok(UrScriptValue::Pose(_) | UrScriptValue::Joints(_)))
                }
                UrScriptValue::Broken(_) | UrScriptValue::Other => false,
            };
            if let (true, Some(first)) = (is_target, argument.first()) {
                self.list(argument, first.line, reason::ARGUMENT);
            }
        }
    }

    fn motion(&mut self, word: &Token, argument: &[Token], way: UrScriptMotionType) -> UrScriptStep {
        let argument = match argument {
            [name, sign, rest @ ..] if name.kind == TokenKind::Word && sign.is(b'=') => rest,
            all => all,
        };
        let found =
            if way == UrScriptMotionType::Unknown { Err(reason::UNKNOWN.to_owned()) } else { self.aim(argument) };
        match found {
            Ok(aim) => UrScriptStep::Move { aim, line: word.line, way },
            Err(reason) => {
                let tokens = if argument.is_empty() { std::slice::from_ref(word) } else { argument };
                self.list(tokens, word.line, &reason);
                UrScriptStep::Away
            }
        }
    }

    /// The target of an expression.
    fn aim(&mut self, tokens: &[Token]) -> TargetParse {
        let line = tokens.first().map_or(0, |it| it.line);
        let (value, line, name) = match self.variables.value(self.text, tokens, self.axes) {
            UrScriptValue::Name(name) => (self.variables.of_name(&name)?, self.variables.line(&name), name),
            UrScriptValue::Other => return self.of_call(tokens),
            value @ (UrScriptValue::Pose(_) | UrScriptValue::Joints(_) | UrScriptValue::Broken(_)) => {
                (value, line, excerpt(self.text, tokens))
            }
        };
        let (numbers, meant) = match value {
            UrScriptValue::Pose(numbers) => (numbers, PoseMeaning::Pose(PoseForm::RotationVector)),
            UrScriptValue::Joints(numbers) => (numbers, PoseMeaning::Joints),
            UrScriptValue::Broken(reason) => return Err(reason.to_owned()),
            UrScriptValue::Name(_) | UrScriptValue::Other => return Err(reason::COMPUTED.to_owned()),
        };
        let target = self.out.target(ProgramTarget { line, name, numbers, meant });
        Ok(MotionArgument {
            target,
            frames: Vec::new(),
            stated: StatedConfiguration::Nothing,
            tool: None,
            is_inverse: false,
        })
    }

    /// A stated pose, which is changed once more.
    fn pose(&mut self, tokens: &[Token]) -> TargetParse {
        let aim = self.aim(tokens)?;
        let is_pose = self.out.targets.get(aim.target).is_some_and(|it| it.meant != PoseMeaning::Joints);
        if is_pose && !aim.is_inverse { Ok(aim) } else { Err(reason::COMPUTED.to_owned()) }
    }

    /// The target of `pose_trans(…)` or `get_inverse_kin(…)`.
    fn of_call(&mut self, tokens: &[Token]) -> TargetParse {
        let computed = || reason::COMPUTED.to_owned();
        let [name, rest @ ..] = tokens else { return Err(computed()) };
        let Some((inside, [])) = bracket(rest, b'(', b')') else { return Err(computed()) };
        let arguments = parts(inside);
        match (name.text(self.text), &arguments[..]) {
            ("pose_trans", [frame, pose]) => {
                let frame = match self.variables.value(self.text, frame, self.axes) {
                    UrScriptValue::Pose(numbers) => PoseFrame::Is(FORM.of_numbers(&numbers).ok_or_else(computed)?),
                    UrScriptValue::Name(name) => PoseFrame::Named(name),
                    UrScriptValue::Joints(_) | UrScriptValue::Broken(_) | UrScriptValue::Other => {
                        return Err(computed());
                    }
                };
                let mut aim = self.pose(pose)?;
                aim.frames.insert(0, frame);
                Ok(aim)
            }
            ("get_inverse_kin", [pose, others @ ..]) => self.inverse(pose, others),
            _ => Err(computed()),
        }
    }

    fn inverse(&mut self, pose: &[Token], others: &[&[Token]]) -> TargetParse {
        const NAMES: [&str; 4] = ["qnear", "maxPositionError", "maxOrientationError", "tcp"];
        let mut aim = self.pose(pose)?;
        aim.is_inverse = true;
        for (at, argument) in others.iter().enumerate() {
            let (name, value) = match argument {
                [name, sign, value @ ..] if sign.is(b'=') => (name.text(self.text), value),
                all => (NAMES.get(at).copied().unwrap_or(""), *all),
            };
            match name {
                "qnear" => match self.literal_value(value) {
                    Some(UrScriptValue::Joints(numbers)) => {
                        aim.stated = StatedConfiguration::Near(numbers.iter().map(Number::scaled_value).collect());
                    }
                    _ => return Err(reason::COMPUTED.to_owned()),
                },
                "tcp" if value.len() == 1 && value[0].text(self.text).contains("active_tcp") => {}
                "tcp" => aim.tool = Some(self.tool(value)),
                _ => {}
            }
        }
        Ok(aim)
    }

    /// The value of a literal, or of a variable that is assigned once.
    fn literal_value(&self, tokens: &[Token]) -> Option<UrScriptValue> {
        match self.variables.value(self.text, tokens, self.axes) {
            UrScriptValue::Name(name) => self.variables.of_name(&name).ok(),
            found @ (UrScriptValue::Pose(_)
            | UrScriptValue::Joints(_)
            | UrScriptValue::Broken(_)
            | UrScriptValue::Other) => Some(found),
        }
    }

    fn tool(&self, tokens: &[Token]) -> ActiveFrame {
        let named = || match self.variables.value(self.text, tokens, self.axes) {
            UrScriptValue::Name(name) => self.given.tool(Some(&name)),
            UrScriptValue::Pose(_) | UrScriptValue::Joints(_) | UrScriptValue::Broken(_) | UrScriptValue::Other => None,
        };
        match self.literal_value(tokens) {
            Some(UrScriptValue::Pose(numbers)) => FORM.of_numbers(&numbers),
            _ => named(),
        }
        .map_or(ActiveFrame::Unknown, ActiveFrame::Is)
    }

    /// Follows the program from motion to motion.
    fn motions(mut self, program: &Program) -> ParsedProgram {
        let names: BTreeSet<&str> = self.out.targets.iter().map(|it| it.name.as_str()).collect();
        let given = self.given;
        let at_start = given.frame(None).unwrap_or(Pose::identity());
        let motions = &mut self.out.motions;
        let frame_of = |frame: &PoseFrame| match frame {
            PoseFrame::Is(pose) => Ok(*pose),
            PoseFrame::Named(name) if names.contains(name.as_str()) => Err(reason::RELATIVE.to_owned()),
            PoseFrame::Named(name) => match (given.frame(Some(name)), self.variables.of_name(name)) {
                (Some(pose), _) => Ok(pose),
                (None, Ok(UrScriptValue::Pose(numbers))) => {
                    FORM.of_numbers(&numbers).ok_or_else(|| reason::COMPUTED.to_owned())
                }
                (None, Err(reason)) if reason == reason::ABSENT => Err(reason::FRAME.to_owned()),
                (None, Err(reason)) => Err(format!("its frame {name}: {reason}")),
                (None, Ok(_)) => Err(format!("its frame {name}: {}", reason::COMPUTED)),
            },
        };
        let mut step = |step: &UrScriptStep, state: &mut FlowState| match step {
            UrScriptStep::Tool(setting) => state.tool = *setting,
            UrScriptStep::Moving(true) => state.frame = ActiveFrame::Unknown,
            UrScriptStep::Moving(false) => state.frame = ActiveFrame::Unset,
            UrScriptStep::Away => state.last = None,
            UrScriptStep::Move { aim: MotionArgument { target, frames, stated, tool, is_inverse }, line, way } => {
                let product = frames.iter().map(frame_of).try_fold(at_start, |all, it| it.map(|it| all * it));
                let frame = product.as_ref().ok().filter(|_| state.frame != ActiveFrame::Unknown).copied();
                let tool = tool.unwrap_or(state.tool).pose_or(given.tool(None));
                motions.push(ProgramMotion {
                    after: state.last.filter(|_| !program.threads_move),
                    is_straight: *way != UrScriptMotionType::Joints && !is_inverse,
                    tool: tool.filter(|_| !program.threads_set),
                    frame,
                    stated: stated.clone(),
                    refused: product.err(),
                    ..ProgramMotion::from_target(*target, *line)
                });
                state.last = (*way != UrScriptMotionType::Stream).then(|| motions.len() - 1);
            }
        };
        let mut walk = FlowWalk::new(&program.blocks.routines, program.blocks.size, false, &mut step);
        walk.run(&program.main, &program.blocks.called, &|_| false);
        self.out
    }
}
