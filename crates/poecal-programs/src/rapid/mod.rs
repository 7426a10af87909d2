//! Targets of programs in RAPID (ABB): `robtarget` and `jointtarget`, declared or in place.
//!
//! A `robtarget` is a pose of the tool in a work object, but states neither the tool nor the work object: the moves to it do. Its configuration
//! `[cf1,cf4,cf6,cfx]` has the quarter turns of joints 1, 4 and 6, and one of eight branches (ABB, *Technical reference manual, RAPID*,
//! `confdata`).

pub(crate) mod configuration;
mod declarations;
mod frames;
mod modal;
mod move_sequence;
mod moves;
mod outline;
mod targets;
mod tokens;

use declarations::{Declarations, RapidDataKind};
use modal::{ModalState, ModalSwitch, leads_elsewhere};
use move_sequence::{MoveFrame, RapidMove, RapidMoves};
use moves::{ArgumentLayout, Instruction, TargetNotation, ToolArgument, argument, layout};
use outline::RapidStatement;
pub(crate) use tokens::RULES;
use tokens::tokens;

use super::axes::ControllerAxes;
use super::parsed_program::ParsedProgram;
use super::scan::{Token, TokenKind, excerpt, is_one_of};
use super::stated_frames::StatedFrames;
use super::unchanged_statements::UnchangedStatement;

/// Message on a target to which a move is relative.
const RELATIVE: &str = "relative to a target: the offset is left as it is, at most its target is corrected";

/// The targets and motions of a program.
pub(crate) fn parse(text: &[u8], given: &StatedFrames, axes: &ControllerAxes) -> ParsedProgram {
    let tokens = tokens(text);
    let outline = outline::outline(&tokens, text);
    let mut declared = Declarations::read(&outline, &tokens, text);
    let modals = [ModalSwitch::Displacement, ModalSwitch::Lines, ModalSwitch::Joints]
        .map(|switch| ModalState::follow(switch, &outline, &tokens, text));
    let mut reader = RapidReader { text, modals, moves: RapidMoves::default(), last: None, listed: Vec::new() };
    for (index, statement) in outline.statements.iter().enumerate() {
        reader.statement(index, statement, &tokens, &mut declared);
    }
    let mut out = targets::parsed(&reader.moves, &declared, &outline, (given, axes), text);
    out.listed.append(&mut reader.listed);
    out.sorted()
}

struct RapidReader<'a> {
    text: &'a [u8],
    modals: [ModalState; 3],
    moves: RapidMoves,
    /// Number and block of the last move, if the next one always follows it.
    last: Option<(usize, usize)>,
    listed: Vec<UnchangedStatement>,
}

impl RapidReader<'_> {
    fn statement(&mut self, index: usize, statement: &RapidStatement, tokens: &[Token], declared: &mut Declarations) {
        declared.follow(statement, tokens, self.text);
        let own = tokens.get(statement.tokens.clone()).unwrap_or_default();
        if statement.routine.is_none() {
            return;
        }
        if statement.is_entry || self.last.is_some_and(|(_, block)| block != statement.block) {
            self.last = None;
        }
        let Some(instruction) = Instruction::from_tokens(own, self.text) else {
            self.last = None;
            return;
        };
        declared.note_arguments(own, statement, self.text);
        if let Some(layout) = layout(&instruction.name) {
            self.read_move(index, statement, &instruction, &layout, own, declared);
        } else {
            if leads_elsewhere(own, Some(&instruction)) {
                self.last = None;
            }
            self.not_moved(statement, &instruction, own, declared);
        }
    }

    /// An instruction that is no move: its use of data is unknown.
    fn not_moved(
        &mut self,
        statement: &RapidStatement,
        instruction: &Instruction<'_>,
        own: &[Token],
        declared: &mut Declarations,
    ) {
        let is_assignment = own.get(1).is_some_and(|it| it.kind != TokenKind::Word && !it.is(b'\\'));
        if is_assignment || is_one_of("const eoffson pdispon pers return tpwrite var", &instruction.name) {
            return;
        }
        let name = excerpt(self.text, own.get(..1).unwrap_or_default());
        let values = instruction.options.iter().map(|(_, value)| *value);
        for given in instruction.arguments.iter().copied().chain(values) {
            if let TargetNotation::Name(of, _) = argument(given, self.text) {
                declared.give(&of, &name, false, statement);
            }
        }
    }

    fn read_move(
        &mut self,
        index: usize,
        statement: &RapidStatement,
        instruction: &Instruction<'_>,
        layout: &ArgumentLayout,
        own: &[Token],
        declared: &mut Declarations,
    ) {
        let text = self.text;
        if let Some(set) = layout.sets.and_then(|at| instruction.arguments.get(at))
            && let TargetNotation::Name(name, _) = argument(set, text)
        {
            declared.change(&name, statement);
        }
        let tool = match layout.tool {
            ToolArgument::Place(at) => instruction.arguments.get(at),
            ToolArgument::Last => instruction.arguments.last().filter(|_| instruction.arguments.len() > 2),
        };
        let held = |written: &[Token]| MoveFrame::from_written(&excerpt(text, written), statement, declared);
        let [displaced, lines, joints] = &self.modals;
        let not_followed = if layout.is_free { joints } else { lines };
        let of = RapidMove {
            line: statement.line,
            tool: tool.map_or_else(|| MoveFrame::Unknown(String::new()), |it| held(it)),
            object: instruction.option("wobj").map_or(MoveFrame::BuiltIn, held),
            displaced: displaced.switched_at(index).filter(|_| !layout.is_joints),
            is_not_followed: not_followed.switched_at(index).is_some(),
            is_straight: !layout.is_free && !layout.is_joints,
        };
        let name = excerpt(text, own.get(..1).unwrap_or_default());
        for &at in layout.targets {
            let of = of.clone();
            let before = self.last.take().map(|(number, _)| number);
            let number = match instruction.arguments.get(at).copied() {
                Some(written) => self.read_target(&name, written, layout.is_joints, statement, of, before, declared),
                None => {
                    self.list(statement.line, excerpt(text, own), "an argument of this move is missing");
                    None
                }
            };
            self.last = number.map(|number| (number, statement.block));
        }
    }

    /// A move to a target by its text. Returns its number, if its target is known.
    #[allow(clippy::too_many_arguments)]
    fn read_target(
        &mut self,
        instruction: &str,
        written: &[Token],
        is_joints: bool,
        statement: &RapidStatement,
        of: RapidMove,
        before: Option<usize>,
        declared: &Declarations,
    ) -> Option<usize> {
        let text = self.text;
        let line = written.first().map_or(statement.line, |it| it.line);
        let of = RapidMove { line, ..of };
        let mut argument = argument(written, text);
        let mut is_relative = false;
        while let TargetNotation::Relative(base) = argument {
            is_relative = true;
            argument = *base;
        }
        if is_relative {
            self.list(line, excerpt(text, written), RELATIVE);
        }
        let number = match argument {
            TargetNotation::Name(name, indices) => {
                let sort = declared.find(&name, statement).and_then(|at| Some((at, declared.data.get(at)?)));
                let expected = if is_joints { RapidDataKind::Joints } else { RapidDataKind::Target };
                let reason = match sort {
                    None => "not declared in this file",
                    Some((_, data)) if data.sort == RapidDataKind::Parameter => {
                        "a parameter of its routine: its value is that of each call"
                    }
                    Some((_, data)) if data.sort != expected => {
                        "declared as something else than what this move expects"
                    }
                    Some((_, data)) if data.value.is_none() => {
                        "a variable without numbers: computed when the program runs"
                    }
                    Some((at, _)) => {
                        return self.moves.add_to_data(at, indices, of, before).filter(|_| !is_relative);
                    }
                };
                self.list(line, excerpt(text, written), reason);
                None
            }
            TargetNotation::Numbers(tokens) => {
                let first = tokens.split_inclusive(|it| it.is(b']')).next().unwrap_or_default();
                let name = format!("{instruction} {},…]", excerpt(text, first));
                let value = tokens::value(tokens, text, 0);
                Some(self.moves.in_place(name, value, is_joints, of, before))
            }
            TargetNotation::Computed | TargetNotation::Relative(_) => {
                let is_star = matches!(written, [star] if star.is(b'*'));
                let reason = if is_star { "no numbers stand here" } else { "computed when the program runs" };
                self.list(line, excerpt(text, written), reason);
                None
            }
        };
        number.filter(|_| !is_relative)
    }

    fn list(&mut self, line: usize, name: String, reason: &str) {
        self.listed.push(UnchangedStatement { line, name, reason: reason.to_owned() });
    }
}
