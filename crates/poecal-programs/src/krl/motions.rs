//! Programs of KRL (`.src`): statements, and their motions.

use std::collections::BTreeSet;

use super::super::axes::Axes;
use super::super::build::Blocks;
use super::super::flow::{Node, State, Walk};
use super::super::forms::PoseForm;
use super::super::given::Given;
use super::super::parsed::{Meant, Motion, Parsed, Setting, Target};
use super::super::scan::{Kind, Scanner, Token, bracket, is_one_of, parts, shown};
use super::super::stated::Stated;
use super::data::{numbered, stated};
use super::status::Status;
use super::values::{Place, Value, Variables, assignment, value};
use super::{MOTIONS, RULES, Way, reason};
use poecal_arm::lie::Pose;
use poecal_numerics::error::Result;

/// Tool and base of a motion, if they are its own.
type Own = (Option<Setting>, Option<Setting>);

/// A statement with an effect on motions.
#[derive(Clone, Debug)]
pub(crate) enum Step {
    /// A motion to the target with this index.
    Move {
        target: usize,
        line: usize,
        is_straight: bool,
        stated: Stated,
        own: Own,
    },
    Tool(Setting),
    Frame(Setting),
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
pub(crate) struct Reader<'r> {
    text: &'r [u8],
    given: &'r Given,
    axes: &'r Axes,
    variables: &'r Variables,
    out: Parsed,
    /// Names of variables in another file, which were already reported.
    absent: BTreeSet<String>,
    blocks: Blocks<Step>,
    /// Routines that other files may call.
    open: BTreeSet<String>,
}

impl<'r> Reader<'r> {
    pub(crate) fn new(text: &'r [u8], given: &'r Given, axes: &'r Axes, variables: &'r Variables) -> Self {
        Reader {
            text,
            given,
            axes,
            variables,
            out: Parsed::default(),
            absent: BTreeSet::new(),
            blocks: Blocks::new(),
            open: BTreeSet::new(),
        }
    }

    pub(crate) fn read(mut self) -> Result<Parsed> {
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
        let mut step = |step: &Step, state: &mut State| match step {
            Step::Tool(setting) => state.tool = *setting,
            Step::Frame(setting) => state.frame = *setting,
            Step::Away => state.last = None,
            Step::Lost => *state = state.lost(),
            Step::Move { target, line, is_straight, stated, own } => {
                let frame = own.1.unwrap_or(state.frame).or(given.frame(None));
                motions.push(Motion {
                    after: state.last,
                    is_straight: *is_straight,
                    tool: own.0.unwrap_or(state.tool).or(given.tool(None)),
                    frame: frame.filter(|_| !moves_root),
                    stated: stated.clone(),
                    ..Motion::to(*target, *line)
                });
                state.last = Some(motions.len() - 1);
            }
        };
        let open = &self.open;
        let mut walk = Walk::new(&self.blocks.routines, self.blocks.size, true, &mut step);
        walk.run(&main, &self.blocks.called, &|name| open.contains(name));
        Ok(self.out)
    }

    /// Targets to which no motion of the file leads: other files may use them, with any tool and base.
    fn list_unused(&mut self) {
        for variable in self.variables.known.values().filter(|it| it.assignments == 1) {
            let numbers = match &variable.value {
                Value::Pose(numbers, status) if *status != Status::default() => numbers,
                Value::Joints(numbers) => numbers,
                Value::Pose(..) | Value::Broken(_) | Value::Place(_) | Value::Name(_) | Value::Other => {
                    continue;
                }
            };
            if !numbers.is_empty() && !self.out.knows(numbers) {
                self.out.list(variable.line, &variable.name, reason::UNUSED);
            }
        }
    }

    fn statement(&mut self, tokens: &[Token]) -> Result<()> {
        let Some(first) = tokens.first().filter(|it| it.kind == Kind::Word) else { return Ok(()) };
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
                self.blocks.push([Node::Leave]);
            }
            _ if matches!(rest, [colon] if colon.is(b':')) => self.blocks.push([Node::Label]),
            "BAS" => self.bas(rest),
            _ => self.other(&word, tokens),
        }
        Ok(())
    }

    fn other(&mut self, word: &str, tokens: &[Token]) {
        if let Some((_, way)) = MOTIONS.iter().find(|it| it.0 == word) {
            return self.motion(tokens, *way);
        }
        if is_one_of(HARMLESS, word) {
            return;
        }
        self.calls(tokens);
        if let Some(it) = assignment(self.text, tokens) {
            self.assigned(&it.key, it.is_part, it.value);
        }
    }

    /// Routines that a statement calls.
    fn calls(&mut self, tokens: &[Token]) {
        for pair in tokens.windows(2) {
            let name = pair[0].text(self.text).to_ascii_uppercase();
            if pair[0].kind == Kind::Word && pair[1].is(b'(') && !is_one_of(FUNCTIONS, &name) {
                self.blocks.push([Node::Call(name)]);
            }
        }
    }

    fn steps(&mut self, steps: impl IntoIterator<Item = Step>) {
        self.blocks.push(steps.into_iter().map(Node::Step));
    }

    /// Follows an assignment to a variable of the controller.
    fn assigned(&mut self, key: &str, is_part: bool, value: &[Token]) {
        match key {
            "$TOOL" | "$BASE" if is_part => self.steps([Step::Lost]),
            "$TOOL" => self.steps([Step::Tool(self.setting(value, true))]),
            "$BASE" => self.steps([Step::Frame(self.setting(value, false))]),
            "FDAT_ACT" => {
                let (tool, base) = self.of_place(self.place(value));
                self.steps([Step::Tool(tool), Step::Frame(base)]);
            }
            "$IPO_MODE" if value.iter().any(|it| it.is_word(self.text, "TCP")) => {
                self.steps([Step::Tool(Setting::Unknown), Step::Frame(Setting::Unknown)]);
            }
            _ => {}
        }
    }

    /// Tool and base of a named point.
    fn place(&self, tokens: &[Token]) -> Option<Place> {
        let Value::Name(key) = value(self.text, tokens, self.axes) else { return None };
        self.variables.place(&key)
    }

    /// A tool or base of the controller's lists by its number.
    fn numbered(&self, list: &str, number: Option<i64>) -> Setting {
        number
            .and_then(|it| numbered(list, it, self.variables, self.given))
            .map_or(Setting::Unknown, Setting::Is)
    }

    fn of_place(&self, place: Option<Place>) -> (Setting, Setting) {
        let Some(place) = place.filter(|it| !it.is_external) else {
            return (Setting::Unknown, Setting::Unknown);
        };
        (self.numbered("TOOL_DATA", place.tool), self.numbered("BASE_DATA", place.base))
    }

    /// The pose that is assigned to `$TOOL` or `$BASE`.
    fn setting(&self, tokens: &[Token], is_tool: bool) -> Setting {
        let list = if is_tool { "TOOL_DATA" } else { "BASE_DATA" };
        let user =
            |name: &str| if is_tool { self.given.tool(Some(name)) } else { self.given.frame(Some(name)) };
        let pose = match value(self.text, tokens, self.axes) {
            Value::Name(key) if key == "$NULLFRAME" || (key == "$WORLD" && !is_tool) => {
                Some(Pose::identity())
            }
            Value::Name(key) => {
                match key.strip_prefix(list).and_then(|it| it.strip_prefix('[')?.strip_suffix(']')) {
                    Some(number) => return self.numbered(list, number.parse().ok()),
                    None => user(&key).or_else(|| stated(&key, self.variables)),
                }
            }
            Value::Pose(numbers, _) => PoseForm::Abc.of_numbers(&numbers),
            Value::Joints(_) | Value::Broken(_) | Value::Place(_) | Value::Other => None,
        };
        pose.map_or(Setting::Unknown, Setting::Is)
    }

    /// Follows `BAS(#TOOL, 3)` and other calls of BAS.
    fn bas(&mut self, rest: &[Token]) {
        let Some((inside, _)) = bracket(rest, b'(', b')') else { return };
        let arguments = parts(inside);
        let word = arguments
            .first()
            .and_then(|it| it.last())
            .map_or("", |it| it.text(self.text))
            .to_ascii_uppercase();
        let number = match arguments.get(1) {
            Some([Token { kind: Kind::Number(value, 0), .. }]) => Some(*value as i64),
            _ => None,
        };
        // They set speeds; tool and base are set by FDAT_ACT, which is assigned before.
        const SPEEDS: &str = "PTP_PARAMS CP_PARAMS PTP_DAT CP_DAT VEL_PTP VEL_CP ACC_PTP ACC_CP OV_PRO";
        let step = match word.as_str() {
            "TOOL" => Step::Tool(self.numbered("TOOL_DATA", number)),
            "BASE" => Step::Frame(self.numbered("BASE_DATA", number)),
            word if is_one_of(SPEEDS, word) => return,
            _ => Step::Lost,
        };
        self.steps([step]);
    }

    fn motion(&mut self, tokens: &[Token], way: Way) {
        let (word, rest) = (&tokens[0], &tokens[1..]);
        let line = word.line;
        // Words behind the targets concern the path.
        let ends = ["C_PTP", "C_DIS", "C_VEL", "C_ORI", "C_SPL", "WITH"];
        let is_end = |it: &Token| ends.iter().any(|end| it.is_word(self.text, end));
        let (targets, others) = rest.split_at(rest.iter().position(is_end).unwrap_or(rest.len()));
        let arguments = parts(targets);
        if way == Way::Relative {
            self.out.list(line, shown(self.text, tokens), reason::RELATIVE);
            return self.steps([Step::Away]);
        }
        let own = self.own(others);
        let is_angle = |it: &&[Token]| it.first().is_some_and(|word| word.is_word(self.text, "CA"));
        let has_angle = arguments.iter().any(is_angle);
        let is_arc = word.text(self.text).to_ascii_uppercase().ends_with("CIRC");
        let count = if is_arc { 2 } else { 1 };
        for argument in arguments.iter().filter(|it| !is_angle(it)).take(count) {
            if has_angle {
                self.out.list(line, shown(self.text, argument), reason::ANGLE);
                self.steps([Step::Away]);
                continue;
            }
            let step = match self.aim(argument) {
                Ok((target, stated)) => {
                    Step::Move { target, line, is_straight: way == Way::Straight, stated, own }
                }
                Err(reason) => {
                    let name = shown(self.text, argument);
                    if reason != reason::ABSENT || self.absent.insert(name.to_ascii_uppercase()) {
                        self.out.list(line, name, reason);
                    }
                    Step::Away
                }
            };
            self.steps([step]);
        }
    }

    /// Tool and base in the statement of the motion itself.
    fn own(&self, others: &[Token]) -> Own {
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
    fn aim(&mut self, tokens: &[Token]) -> std::result::Result<(usize, Stated), &'static str> {
        let line = tokens.first().map_or(0, |it| it.line);
        let (found, line, name) = match value(self.text, tokens, self.axes) {
            Value::Name(key) if key.starts_with('$') => {
                return Err(if self.variables.of_name(&key).is_err() {
                    reason::COMPUTED
                } else {
                    reason::SEVERAL
                });
            }
            Value::Name(key) => {
                let variable = self.variables.of_name(&key)?;
                (variable.value.clone(), variable.line, variable.name.clone())
            }
            found @ (Value::Pose(..)
            | Value::Joints(_)
            | Value::Broken(_)
            | Value::Place(_)
            | Value::Other) => (found, line, shown(self.text, tokens)),
        };
        let (numbers, meant, stated) = match found {
            Value::Pose(numbers, status) => (numbers, Meant::Pose(PoseForm::Abc), status.into()),
            Value::Joints(numbers) => (numbers, Meant::Joints, Stated::Nothing),
            Value::Broken(reason) => return Err(reason),
            Value::Place(_) => return Err(reason::UNKNOWN),
            Value::Name(_) | Value::Other => return Err(reason::COMPUTED),
        };
        Ok((self.out.target(Target { line, name, numbers, meant }), stated))
    }
}
