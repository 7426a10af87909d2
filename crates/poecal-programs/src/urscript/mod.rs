//! URScript: the language of Universal Robots.

mod blocks;
mod reason;
mod step;
mod values;

use std::collections::BTreeSet;

use super::axes::Axes;
use super::flow::{Node, State, Walk};
use super::forms::PoseForm;
use super::given::Given;
use super::parsed::{Meant, Motion, Number, Parsed, Setting, Target};
use super::scan::{Kind, Rules, Token, bracket, is_one_of, parts, shown};
use super::stated::Stated;
use blocks::Program;
use poecal_arm::lie::Pose;
use poecal_numerics::error::Result;
use step::{Aim, Frame, Step, Way};
use values::{Value, Variables};

pub(crate) const RULES: Rules =
    Rules { comments: &["#"], quotes: b"\"'", letters: b"", is_open_in_brackets: true };

/// Form of poses in the language.
const FORM: PoseForm = PoseForm::RotationVector;

/// Statements that move the robot to targets: their name, the indices of the targets among the arguments, and the path.
const MOTIONS: [(&str, &[usize], Way); 9] = [
    ("movej", &[0], Way::Joints),
    ("movel", &[0], Way::Straight),
    ("movep", &[0], Way::Straight),
    ("movec", &[0, 1], Way::Straight),
    ("optimovej", &[0], Way::Joints),
    ("optimovel", &[0], Way::Straight),
    ("servoj", &[0], Way::Stream),
    ("servoc", &[0], Way::Stream),
    ("mc_add_linear", &[0], Way::Unknown),
];

/// Statements after which the position of the robot is unknown.
const AWAY: &str = "speedj speedl freedrive_mode teach_mode force_mode move_until mc_run_motion tool_contact";

/// Targets and motions of a program.
pub(crate) fn parse(text: &[u8], given: &Given, axes: &Axes) -> Result<Parsed> {
    let variables = Variables::from_text(text, &RULES, axes);
    let mut reader = Reader { text, given, axes, variables, out: Parsed::default() };
    let program = Program::read(text, &RULES, &mut |tokens, nodes| reader.statement(tokens, nodes))?;
    Ok(reader.motions(&program))
}

/// Reads statements.
struct Reader<'r> {
    text: &'r [u8],
    given: &'r Given,
    axes: &'r Axes,
    variables: Variables,
    out: Parsed,
}

/// A target of a motion, or the reason why it is none.
type Found = std::result::Result<Aim, String>;

impl Reader<'_> {
    /// Adds the effects of a statement as nodes.
    fn statement(&mut self, tokens: &[Token], nodes: &mut Vec<Node<Step>>) {
        for (at, token) in tokens.iter().enumerate() {
            let rest = &tokens[at + 1..];
            let Some((inside, _)) = bracket(rest, b'(', b')') else { continue };
            let name = token.text(self.text);
            let is_run = at > 0 && is_one_of("run join kill", tokens[at - 1].text(self.text));
            if self.variables.routines.contains(name) {
                self.arguments(inside);
                if !is_run {
                    nodes.push(Node::Call(name.to_owned()));
                }
                continue;
            }
            let arguments = parts(inside);
            if let Some((_, places, way)) = MOTIONS.iter().find(|it| it.0 == name) {
                for &place in *places {
                    let argument = arguments.get(place).copied().unwrap_or(&[]);
                    let step = self.motion(token, argument, *way);
                    nodes.push(Node::Step(step));
                }
            } else if name == "set_tcp" {
                let setting = self.tool(arguments.first().copied().unwrap_or(&[]));
                nodes.push(Node::Step(Step::Tool(setting)));
            } else if name.starts_with("track_conveyor") || name == "stop_conveyor_tracking" {
                nodes.push(Node::Step(Step::Moving(name.starts_with("track"))));
            } else if is_one_of(AWAY, name) {
                if name.starts_with("speed") {
                    self.list(&tokens[at..], token.line, reason::SPEED);
                }
                nodes.push(Node::Step(Step::Away));
            }
        }
    }

    fn list(&mut self, tokens: &[Token], line: usize, reason: &str) {
        self.out.list(line, shown(self.text, tokens), reason);
    }

    /// Lists targets that are passed to a routine.
    fn arguments(&mut self, inside: &[Token]) {
        for argument in parts(inside) {
            let is_target = match self.variables.value(self.text, argument, self.axes) {
                Value::Pose(_) | Value::Joints(_) => true,
                Value::Name(name) => {
                    matches!(self.variables.of_name(&name), Ok(Value::Pose(_) | Value::Joints(_)))
                }
                Value::Broken(_) | Value::Other => false,
            };
            if let (true, Some(first)) = (is_target, argument.first()) {
                self.list(argument, first.line, reason::ARGUMENT);
            }
        }
    }

    fn motion(&mut self, word: &Token, argument: &[Token], way: Way) -> Step {
        let argument = match argument {
            [name, sign, rest @ ..] if name.kind == Kind::Word && sign.is(b'=') => rest,
            all => all,
        };
        let found = if way == Way::Unknown { Err(reason::UNKNOWN.to_owned()) } else { self.aim(argument) };
        match found {
            Ok(aim) => Step::Move { aim, line: word.line, way },
            Err(reason) => {
                let tokens = if argument.is_empty() { std::slice::from_ref(word) } else { argument };
                self.list(tokens, word.line, &reason);
                Step::Away
            }
        }
    }

    /// The target of an expression.
    fn aim(&mut self, tokens: &[Token]) -> Found {
        let line = tokens.first().map_or(0, |it| it.line);
        let (value, line, name) = match self.variables.value(self.text, tokens, self.axes) {
            Value::Name(name) => (self.variables.of_name(&name)?, self.variables.line(&name), name),
            Value::Other => return self.of_call(tokens),
            value @ (Value::Pose(_) | Value::Joints(_) | Value::Broken(_)) => {
                (value, line, shown(self.text, tokens))
            }
        };
        let (numbers, meant) = match value {
            Value::Pose(numbers) => (numbers, Meant::Pose(PoseForm::RotationVector)),
            Value::Joints(numbers) => (numbers, Meant::Joints),
            Value::Broken(reason) => return Err(reason.to_owned()),
            Value::Name(_) | Value::Other => return Err(reason::COMPUTED.to_owned()),
        };
        let target = self.out.target(Target { line, name, numbers, meant });
        Ok(Aim { target, frames: Vec::new(), stated: Stated::Nothing, tool: None, is_inverse: false })
    }

    /// A stated pose, which is changed once more.
    fn pose(&mut self, tokens: &[Token]) -> Found {
        let aim = self.aim(tokens)?;
        let is_pose = self.out.targets.get(aim.target).is_some_and(|it| it.meant != Meant::Joints);
        if is_pose && !aim.is_inverse { Ok(aim) } else { Err(reason::COMPUTED.to_owned()) }
    }

    /// The target of `pose_trans(…)` or `get_inverse_kin(…)`.
    fn of_call(&mut self, tokens: &[Token]) -> Found {
        let computed = || reason::COMPUTED.to_owned();
        let [name, rest @ ..] = tokens else { return Err(computed()) };
        let Some((inside, [])) = bracket(rest, b'(', b')') else { return Err(computed()) };
        let arguments = parts(inside);
        match (name.text(self.text), &arguments[..]) {
            ("pose_trans", [frame, pose]) => {
                let frame = match self.variables.value(self.text, frame, self.axes) {
                    Value::Pose(numbers) => Frame::Is(FORM.of_numbers(&numbers).ok_or_else(computed)?),
                    Value::Name(name) => Frame::Named(name),
                    Value::Joints(_) | Value::Broken(_) | Value::Other => return Err(computed()),
                };
                let mut aim = self.pose(pose)?;
                aim.frames.insert(0, frame);
                Ok(aim)
            }
            ("get_inverse_kin", [pose, others @ ..]) => self.inverse(pose, others),
            _ => Err(computed()),
        }
    }

    fn inverse(&mut self, pose: &[Token], others: &[&[Token]]) -> Found {
        const NAMES: [&str; 4] = ["qnear", "maxPositionError", "maxOrientationError", "tcp"];
        let mut aim = self.pose(pose)?;
        aim.is_inverse = true;
        for (at, argument) in others.iter().enumerate() {
            let (name, value) = match argument {
                [name, sign, value @ ..] if sign.is(b'=') => (name.text(self.text), value),
                all => (NAMES.get(at).copied().unwrap_or(""), *all),
            };
            match name {
                "qnear" => match self.literal(value) {
                    Some(Value::Joints(numbers)) => {
                        aim.stated = Stated::Near(numbers.iter().map(Number::scaled).collect());
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
    fn literal(&self, tokens: &[Token]) -> Option<Value> {
        match self.variables.value(self.text, tokens, self.axes) {
            Value::Name(name) => self.variables.of_name(&name).ok(),
            found @ (Value::Pose(_) | Value::Joints(_) | Value::Broken(_) | Value::Other) => Some(found),
        }
    }

    fn tool(&self, tokens: &[Token]) -> Setting {
        let named = || match self.variables.value(self.text, tokens, self.axes) {
            Value::Name(name) => self.given.tool(Some(&name)),
            Value::Pose(_) | Value::Joints(_) | Value::Broken(_) | Value::Other => None,
        };
        match self.literal(tokens) {
            Some(Value::Pose(numbers)) => FORM.of_numbers(&numbers),
            _ => named(),
        }
        .map_or(Setting::Unknown, Setting::Is)
    }

    /// Follows the program from motion to motion.
    fn motions(mut self, program: &Program) -> Parsed {
        let names: BTreeSet<&str> = self.out.targets.iter().map(|it| it.name.as_str()).collect();
        let given = self.given;
        let at_start = given.frame(None).unwrap_or(Pose::identity());
        let motions = &mut self.out.motions;
        let frame_of = |frame: &Frame| match frame {
            Frame::Is(pose) => Ok(*pose),
            Frame::Named(name) if names.contains(name.as_str()) => Err(reason::RELATIVE.to_owned()),
            Frame::Named(name) => match (given.frame(Some(name)), self.variables.of_name(name)) {
                (Some(pose), _) => Ok(pose),
                (None, Ok(Value::Pose(numbers))) => {
                    FORM.of_numbers(&numbers).ok_or_else(|| reason::COMPUTED.to_owned())
                }
                (None, Err(reason)) if reason == reason::ABSENT => Err(reason::FRAME.to_owned()),
                (None, Err(reason)) => Err(format!("its frame {name}: {reason}")),
                (None, Ok(_)) => Err(format!("its frame {name}: {}", reason::COMPUTED)),
            },
        };
        let mut step = |step: &Step, state: &mut State| match step {
            Step::Tool(setting) => state.tool = *setting,
            Step::Moving(true) => state.frame = Setting::Unknown,
            Step::Moving(false) => state.frame = Setting::Unset,
            Step::Away => state.last = None,
            Step::Move { aim: Aim { target, frames, stated, tool, is_inverse }, line, way } => {
                let product = frames.iter().map(frame_of).try_fold(at_start, |all, it| it.map(|it| all * it));
                let frame = product.as_ref().ok().filter(|_| state.frame != Setting::Unknown).copied();
                let tool = tool.unwrap_or(state.tool).or(given.tool(None));
                motions.push(Motion {
                    after: state.last.filter(|_| !program.threads_move),
                    is_straight: *way != Way::Joints && !is_inverse,
                    tool: tool.filter(|_| !program.threads_set),
                    frame,
                    stated: stated.clone(),
                    refused: product.err(),
                    ..Motion::to(*target, *line)
                });
                state.last = (*way != Way::Stream).then(|| motions.len() - 1);
            }
        };
        let mut walk = Walk::new(&program.blocks.routines, program.blocks.size, false, &mut step);
        walk.run(&program.main, &program.blocks.called, &|_| false);
        self.out
    }
}
