//! Programs of KRL (`.src`): statements, and their motions.

use std::collections::BTreeSet;

use super::super::axes::ControllerAxes;
use super::super::build::ProgramBlocks;
use super::super::flow::{FlowNode, FlowState, FlowWalk};
use super::super::forms::PoseForm;
use super::super::parsed_program::{ActiveFrame, ParsedProgram, PoseMeaning, ProgramMotion, ProgramTarget};
use super::super::scan::{Scanner, Token, TokenKind, bracket, excerpt, is_one_of, parts};
use super::super::stated_configuration::StatedConfiguration;
use super::super::stated_frames::StatedFrames;
use super::data::{numbered_frame, stated_pose};
use super::status::Status;
use super::values::{KrlValue, KrlVariables, ToolAndBase, assignment, value};
use super::{KrlMotionType, MOTIONS, RULES, reason};
use poecal_arm::lie::Pose;
use poecal_numerics::error::Result;

/// Tool and base of a motion, if they are its own.
type OwnFrames = (Option<ActiveFrame>, Option<ActiveFrame>);

/// A statement with an effect on motions.
#[derive(Clone, Debug)]
pub(crate) enum KrlStep {
    /// A motion to the target with this index.
    Move {
        target: usize,
        line: usize,
        is_straight: bool,
        stated: StatedConfiguration,
        own: OwnFrames,
    },
    Tool(ActiveFrame),
    Frame(ActiveFrame),
    /// The position of the robot becomes unknown.
    Away,
    /// The position, the tool and the base become unknown.
    Lost,
}

/// Statements that neither move the robot nor set tool and base.
const HARMLESS: &str = "WAIT HALT PULSE TRIGGER INTERRUPT SIGNAL CONTINUE DECL EXT EXTFCT IMPORT ENUM STRUC BRAKE \
                        ANIN ANOUT CWRITE SWRITE SREAD CAST_TO CAST_FROM CONFIRM";

/// Words before a bracket that call no routine: operators, and functions of the language, which only return a value.
const FUNCTIONS: &str = "AND OR NOT EXOR B_AND B_OR ABS SQRT SIN COS TAN ACOS ATAN2 VARSTATE STRLEN STRTODELETE INV_POS \
                         FORWARD INVERSE STRCOMP STRFIND ROUND";

/// Reads the statements of a program.
pub(crate) struct KrlReader<'r> {
    text: &'r [u8],
    given: &'r StatedFrames,
    axes: &'r ControllerAxes,
    variables: &'r KrlVariables,
    out: ParsedProgram,
    /// Names of variables in another file, which were already reported.
    absent: BTreeSet<String>,
    blocks: ProgramBlocks<KrlStep>,
    /// Routines that other files may call.
    open: BTreeSet<String>,
}

impl<'r> KrlReader<'r> {
    pub(crate) fn new(
        text: &'r [u8],
        given: &'r StatedFrames,
        axes: &'r ControllerAxes,
        variables: &'r KrlVariables,
    ) -> Self {
        KrlReader {
            text,
            given,
            axes,
            variables,
            out: ParsedProgram::default(),
            absent: BTreeSet::new(),
            blocks: ProgramBlocks::new(),
            open: BTreeSet::new(),
        }
    }

    pub(crate) fn read(mut self) -> Result<ParsedProgram> {
        let mut scanner = Scanner::new(self.text, &RULES);
        let mut tokens = Vec::new();
        while scanner.statement(&mut tokens).is_some() {
            self.statement(&tokens)?;
        }
        let main = self.blocks.finish();
        self.list_unused();
        let given = self.given;
        let moves_root = self.variables.moves_root;
        let motions = &mut self.out.motions;
        let mut step = |step: &KrlStep, state: &mut FlowState| match step {
            KrlStep::Tool(setting) => state.tool = *setting,
            KrlStep::Frame(setting) => state.frame = *setting,
            KrlStep::Away => state.last = None,
            KrlStep::Lost => *state = state.after_unknown_routine(),
            KrlStep::Move { target, line, is_straight, stated, own } => {
                let frame = own.1.unwrap_or(state.frame).pose_or(given.frame(None));
                motions.push(ProgramMotion {
                    after: state.last,
                    is_straight: *is_straight,
                    tool: own.0.unwrap_or(state.tool).pose_or(given.tool(None)),
                    frame: frame.filter(|_| !moves_root),
                    stated: stated.clone(),
                    ..ProgramMotion::from_target(*target, *line)
                });
                state.last = Some(motions.len() - 1);
            }
        };
        let open = &self.open;
        let mut walk = FlowWalk::new(&self.blocks.routines, self.blocks.size, true, &mut step);
        walk.run(&main, &self.blocks.called, &|name| open.contains(name));
        Ok(self.out)
    }

    /// Targets to which no motion of the file leads: other files may use them, with any tool and base.
    fn list_unused(&mut self) {
        for variable in self.variables.known.values().filter(|it| it.assignments == 1) {
            let numbers = match &variable.value {
                KrlValue::Pose(numbers, status) if *status != Status::default() => numbers,
                KrlValue::Joints(numbers) => numbers,
                KrlValue::Pose(..) | KrlValue::Broken(_) | KrlValue::Place(_) | KrlValue::Name(_) | KrlValue::Other => {
                    continue;
                }
            };
            if !numbers.is_empty() && !self.out.knows(numbers) {
                self.out.list(variable.line, &variable.name, reason::UNUSED);
            }
        }
    }

    fn statement(&mut self, tokens: &[Token]) -> Result<()> {
        let Some(first) = tokens.first().filter(|it| it.kind == TokenKind::Word) else { return Ok(()) };
        let word = first.text(self.text).to_ascii_uppercase();
        let rest = &tokens[1..];
        let line = first.line;
        match word.as_str() {
            "DEF" | "DEFFCT" | "GLOBAL" if rest.iter().any(|it| it.is(b'(')) => {
                let before = tokens.iter().take_while(|it| !it.is(b'(')).last();
                let name = before.map_or("", |it| it.text(self.text)).to_ascii_uppercase();
                if word == "GLOBAL" {
                    self.open.insert(name.clone());
                }
                // A routine without an end, ends at the beginning of the next one.
                while self.blocks.depth() > 0 {
                    self.blocks.end();
                }
                self.blocks.begin_routine(&name, line)?;
            }
            "LOOP" | "REPEAT" => self.blocks.begin_loop(line)?,
            "WHILE" | "FOR" => {
                self.blocks.begin_loop(line)?;
                self.calls(rest);
            }
            "UNTIL" => {
                self.calls(rest);
                self.blocks.end();
            }
            "IF" | "SWITCH" => {
                self.calls(rest);
                self.blocks.begin_branch(line)?;
            }
            "ELSE" | "DEFAULT" => self.blocks.arm(true),
            "CASE" => self.blocks.arm(false),
            "ENDLOOP" | "ENDWHILE" | "ENDFOR" | "ENDIF" | "ENDSWITCH" | "END" | "ENDFCT" => self.blocks.end(),
            "EXIT" | "RETURN" | "GOTO" | "RESUME" => {
                self.calls(rest);
                self.blocks.push([FlowNode::Leave]);
            }
            _ if matches!(rest, [colon] if colon.is(b':')) => self.blocks.push([FlowNode::Label]),
            "BAS" => self.bas(rest),
            _ => self.read_other(&word, tokens),
        }
        Ok(())
    }

    fn read_other(&mut self, word: &str, tokens: &[Token]) {
        if let Some((_, way)) = MOTIONS.iter().find(|it| it.0 == word) {
            return self.motion(tokens, *way);
        }
        if is_one_of(HARMLESS, word) {
            return;
        }
        self.calls(tokens);
        if let Some(it) = assignment(self.text, tokens) {
            self.read_assignment(&it.key, it.is_part, it.value);
        }
    }

    /// Routines that a statement calls.
    fn calls(&mut self, tokens: &[Token]) {
        for pair in tokens.windows(2) {
            let name = pair[0].text(self.text).to_ascii_uppercase();
            if pair[0].kind == TokenKind::Word && pair[1].is(b'(') && !is_one_of(FUNCTIONS, &name) {
                self.blocks.push([FlowNode::Call(name)]);
            }
        }
    }

    fn steps(&mut self, steps: impl IntoIterator<Item = KrlStep>) {
        self.blocks.push(steps.into_iter().map(FlowNode::Step));
    }

    /// Follows an assignment to a variable of the controller.
    fn read_assignment(&mut self, key: &str, is_part: bool, value: &[Token]) {
        match key {
            "$TOOL" | "$BASE" if is_part => self.steps([KrlStep::Lost]),
            "$TOOL" => self.steps([KrlStep::Tool(self.setting(value, true))]),
            "$BASE" => self.steps([KrlStep::Frame(self.setting(value, false))]),
            "FDAT_ACT" => {
                let (tool, base) = self.of_place(self.place(value));
                self.steps([KrlStep::Tool(tool), KrlStep::Frame(base)]);
            }
            "$IPO_MODE" if value.iter().any(|it| it.is_word(self.text, "TCP")) => {
                self.steps([KrlStep::Tool(ActiveFrame::Unknown), KrlStep::Frame(ActiveFrame::Unknown)]);
            }
            _ => {}
        }
    }

    /// Tool and base of a named point.
    fn place(&self, tokens: &[Token]) -> Option<ToolAndBase> {
        let KrlValue::Name(key) = value(self.text, tokens, self.axes) else { return None };
        self.variables.place(&key)
    }

    /// A tool or base of the controller's lists by its number.
    fn numbered_setting(&self, list: &str, number: Option<i64>) -> ActiveFrame {
        number
            .and_then(|it| numbered_frame(list, it, self.variables, self.given))
            .map_or(ActiveFrame::Unknown, ActiveFrame::Is)
    }

    fn of_place(&self, place: Option<ToolAndBase>) -> (ActiveFrame, ActiveFrame) {
        let Some(place) = place.filter(|it| !it.is_external) else {
            return (ActiveFrame::Unknown, ActiveFrame::Unknown);
        };
        (self.numbered_setting("TOOL_DATA", place.tool), self.numbered_setting("BASE_DATA", place.base))
    }

    /// The pose that is assigned to `$TOOL` or `$BASE`.
    fn setting(&self, tokens: &[Token], is_tool: bool) -> ActiveFrame {
        let list = if is_tool { "TOOL_DATA" } else { "BASE_DATA" };
        let user = |name: &str| if is_tool { self.given.tool(Some(name)) } else { self.given.frame(Some(name)) };
        let pose = match value(self.text, tokens, self.axes) {
            KrlValue::Name(key) if key == "$NULLFRAME" || (key == "$WORLD" && !is_tool) => Some(Pose::identity()),
            KrlValue::Name(key) => {
                match key.strip_prefix(list).and_then(|it| it.strip_prefix('[')?.strip_suffix(']')) {
                    Some(number) => return self.numbered_setting(list, number.parse().ok()),
                    None => user(&key).or_else(|| stated_pose(&key, self.variables)),
                }
            }
            KrlValue::Pose(numbers, _) => PoseForm::Abc.of_numbers(&numbers),
            KrlValue::Joints(_) | KrlValue::Broken(_) | KrlValue::Place(_) | KrlValue::Other => None,
        };
        pose.map_or(ActiveFrame::Unknown, ActiveFrame::Is)
    }

    /// Follows `BAS(#TOOL, 3)` and other calls of BAS.
    fn bas(&mut self, rest: &[Token]) {
        let Some((inside, _)) = bracket(rest, b'(', b')') else { return };
        let arguments = parts(inside);
        let word = arguments.first().and_then(|it| it.last()).map_or("", |it| it.text(self.text)).to_ascii_uppercase();
        let number = match arguments.get(1) {
            Some([Token { kind: TokenKind::Number(value, 0), .. }]) => Some(*value as i64),
            _ => None,
        };
        // They set speeds; tool and base are set by FDAT_ACT, which is assigned before.
        const SPEEDS: &str = "PTP_PARAMS CP_PARAMS PTP_DAT CP_DAT VEL_PTP VEL_CP ACC_PTP ACC_CP OV_PRO";
        let step = match word.as_str() {
            "TOOL" => KrlStep::Tool(self.numbered_setting("TOOL_DATA", number)),
            "BASE" => KrlStep::Frame(self.numbered_setting("BASE_DATA", number)),
            word if is_one_of(SPEEDS, word) => return,
            _ => KrlStep::Lost,
        };
        self.steps([step]);
    }

    fn motion(&mut self, tokens: &[Token], way: KrlMotionType) {
        let (word, rest) = (&tokens[0], &tokens[1..]);
        let line = word.line;
        // Words behind the targets concern the path.
        let ends = ["C_PTP", "C_DIS", "C_VEL", "C_ORI", "C_SPL", "WITH"];
        let is_end = |it: &Token| ends.iter().any(|end| it.is_word(self.text, end));
        let (targets, others) = rest.split_at(rest.iter().position(is_end).unwrap_or(rest.len()));
        let arguments = parts(targets);
        if way == KrlMotionType::Relative {
            self.out.list(line, excerpt(self.text, tokens), reason::RELATIVE);
            return self.steps([KrlStep::Away]);
        }
        let own = self.own_frames(others);
        let is_angle = |it: &&[Token]| it.first().is_some_and(|word| word.is_word(self.text, "CA"));
        let has_angle = arguments.iter().any(is_angle);
        let is_arc = word.text(self.text).to_ascii_uppercase().ends_with("CIRC");
        let count = if is_arc { 2 } else { 1 };
        for argument in arguments.iter().filter(|it| !is_angle(it)).take(count) {
            if has_angle {
                self.out.list(line, excerpt(self.text, argument), reason::ANGLE);
                self.steps([KrlStep::Away]);
                continue;
            }
            let step = match self.aim(argument) {
                Ok((target, stated)) => {
                    KrlStep::Move { target, line, is_straight: way == KrlMotionType::Straight, stated, own }
                }
                Err(reason) => {
                    let name = excerpt(self.text, argument);
                    if reason != reason::ABSENT || self.absent.insert(name.to_ascii_uppercase()) {
                        self.out.list(line, name, reason);
                    }
                    KrlStep::Away
                }
            };
            self.steps([step]);
        }
    }

    /// Tool and base in the statement of the motion itself.
    fn own_frames(&self, others: &[Token]) -> OwnFrames {
        let mut own = (None, None);
        let Some(start) = others.iter().position(|it| it.is_word(self.text, "WITH")) else { return own };
        for part in parts(&others[start + 1..]) {
            let Some(it) = assignment(self.text, part) else { continue };
            let inside = match it.value {
                [_, rest @ ..] => bracket(rest, b'(', b')').map_or(&[][..], |it| it.0),
                [] => &[],
            };
            // `STOOL2(FP1)` and `SBASE(FP1.BASE_NO)` refer to the named point.
            let place = || self.of_place(self.place(inside.get(..1).unwrap_or(&[])));
            let is_call = !inside.is_empty();
            match it.key.as_str() {
                "$TOOL" => own.0 = Some(if is_call { place().0 } else { self.setting(it.value, true) }),
                "$BASE" => own.1 = Some(if is_call { place().1 } else { self.setting(it.value, false) }),
                _ => {}
            }
        }
        own
    }

    /// The target that an argument names or states.
    fn aim(&mut self, tokens: &[Token]) -> std::result::Result<(usize, StatedConfiguration), &'static str> {
        let line = tokens.first().map_or(0, |it| it.line);
        let (found, line, name) = match value(self.text, tokens, self.axes) {
            KrlValue::Name(key) if key.starts_with('$') => {
                return Err(if self.variables.of_name(&key).is_err() { reason::COMPUTED } else { reason::SEVERAL });
            }
            KrlValue::Name(key) => {
                let variable = self.variables.of_name(&key)?;
                (variable.value.clone(), variable.line, variable.name.clone())
            }
            found @ (KrlValue::Pose(..)
            | KrlValue::Joints(_)
            | KrlValue::Broken(_)
            | KrlValue::Place(_)
            | KrlValue::Other) => (found, line, excerpt(self.text, tokens)),
        };
        let (numbers, meant, stated) = match found {
            KrlValue::Pose(numbers, status) => (numbers, PoseMeaning::Pose(PoseForm::Abc), status.into()),
            KrlValue::Joints(numbers) => (numbers, PoseMeaning::Joints, StatedConfiguration::Nothing),
            KrlValue::Broken(reason) => return Err(reason),
            KrlValue::Place(_) => return Err(reason::UNKNOWN),
            KrlValue::Name(_) | KrlValue::Other => return Err(reason::COMPUTED),
        };
        Ok((self.out.target(ProgramTarget { line, name, numbers, meant }), stated))
    }
}
