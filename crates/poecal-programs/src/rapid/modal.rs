//! Modal states of RAPID that instructions leave on for later moves: program displacements, and configurations that are not followed.

use super::super::scan::{Token, is_one_of};
use super::moves::{Instruction, layout};
use super::outline::RapidOutline;
use super::tokens::ASSIGN;

/// A modal state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ModalSwitch {
    /// Targets are displaced (`PDispOn`, `PDispSet`).
    Displacement,
    /// The robot does not take the stated configuration on lines and arcs (`ConfL\EllipseDistance`).
    Lines,
    /// The robot does not take it in joint motions (`ConfJ\Off`).
    Joints,
}

/// Range in which a state is on: for each statement, the line that switched it on.
#[derive(Clone, Debug, Default)]
pub(crate) struct ModalState {
    on: Vec<Option<usize>>,
    everywhere: Option<usize>,
}

impl ModalState {
    /// Follows a state through a file. It is off at the beginning of a routine. If it may be on at the end of a block, or is on while other
    /// routines are called, it may be on everywhere.
    pub(crate) fn follow(switch: ModalSwitch, outline: &RapidOutline, tokens: &[Token], text: &[u8]) -> Self {
        let mut out = ModalState { on: vec![None; outline.statements.len()], everywhere: None };
        // Line and block of the instruction that switched it on.
        let mut on: Option<(usize, usize)> = None;
        let (mut routine, mut handler) = (None, 0);
        let everywhere = |all: &mut Option<usize>, on: Option<(usize, usize)>| {
            *all = all.or(on.map(|(line, _)| line));
        };
        for (index, statement) in outline.statements.iter().enumerate() {
            let outermost = outline.outermost_block(statement.block);
            if statement.routine != routine || outermost != handler {
                everywhere(&mut out.everywhere, on.take());
                (routine, handler) = (statement.routine, outermost);
            }
            everywhere(&mut out.everywhere, on.filter(|(_, block)| !outline.is_in(statement.block, *block)));
            let own = tokens.get(statement.tokens.clone()).unwrap_or_default();
            let instruction = Instruction::from_tokens(own, text);
            match instruction.as_ref().and_then(|it| switch_state(switch, it)) {
                Some(true) => {
                    on.get_or_insert((statement.line, statement.block));
                }
                Some(false) => {
                    // Within a branch, it may stay on.
                    on = on.filter(|(_, block)| *block != statement.block);
                }
                None => {
                    let leads = on.is_some() && leads_elsewhere(own, instruction.as_ref());
                    everywhere(&mut out.everywhere, on.filter(|_| leads));
                }
            }
            if let Some(of) = out.on.get_mut(index) {
                *of = on.map(|(line, _)| line);
            }
        }
        everywhere(&mut out.everywhere, on);
        out
    }

    /// The line that may have switched it on at a statement.
    pub(crate) fn switched_at(&self, index: usize) -> Option<usize> {
        self.on.get(index).copied().flatten().or(self.everywhere)
    }
}

/// True if an instruction switches it on, false if off; `None` if neither.
fn switch_state(switch: ModalSwitch, instruction: &Instruction<'_>) -> Option<bool> {
    let of = |name: &str| {
        if instruction.name != name {
            return None;
        }
        if instruction.option("off").is_some() {
            Some(true)
        } else {
            instruction.option("on").is_some().then_some(false)
        }
    };
    match (switch, instruction.name.as_str()) {
        (ModalSwitch::Displacement, "pdispon" | "pdispset") => Some(true),
        (ModalSwitch::Displacement, "pdispoff") => Some(false),
        (ModalSwitch::Displacement, _) => None,
        (ModalSwitch::Lines, _) => of("confl"),
        (ModalSwitch::Joints, _) => of("confj"),
    }
}

/// True if a statement may run other routines or leave this one: all except instructions known to do neither.
pub(crate) fn leads_elsewhere(tokens: &[Token], instruction: Option<&Instruction<'_>>) -> bool {
    const STAY: &str = "accset clkreset clkstart clkstop confj confl const decr eoffsoff eoffson eoffsset gripload incr \
                        invertdo moveextj pdispoff pdispon pdispset pers pulsedo reset set setao setdo setgo singarea stop \
                        tperase tpwrite var velset waitdi waitdo waitrob waittime waituntil";
    let is_assignment = tokens.get(1).is_some_and(|it| it.is(ASSIGN) || it.is(b'.') || it.is(b'{'));
    match instruction {
        Some(it) => !is_assignment && layout(&it.name).is_none() && !is_one_of(STAY, &it.name),
        None => !tokens.is_empty(),
    }
}
