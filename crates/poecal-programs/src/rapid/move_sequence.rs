//! Moves to targets, in the order of the text.

use std::collections::HashMap;

use super::declarations::Declarations;
use super::outline::RapidStatement;
use super::tokens::RapidValue;

/// A tool or a work object of a move.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum MoveFrame {
    /// `tool0` or `wobj0`.
    BuiltIn,
    /// Data of the file.
    Data(usize),
    /// A name that is not declared there, or no name.
    Unknown(String),
}

impl MoveFrame {
    /// The tool or work object by its text in a move.
    pub(crate) fn from_written(written: &str, statement: &RapidStatement, declared: &Declarations) -> Self {
        let name = written.to_ascii_lowercase();
        match declared.find(&name, statement) {
            Some(data) => MoveFrame::Data(data),
            None if matches!(name.as_str(), "tool0" | "wobj0") => MoveFrame::BuiltIn,
            None => MoveFrame::Unknown(written.to_owned()),
        }
    }
}

/// Statements of a move on its target.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RapidMove {
    pub(crate) line: usize,
    pub(crate) tool: MoveFrame,
    pub(crate) object: MoveFrame,
    /// Line of a program displacement that may be active.
    pub(crate) displaced: Option<usize>,
    /// True if a `ConfL\EllipseDistance` or `ConfJ\Off` may be active.
    pub(crate) is_not_followed: bool,
    pub(crate) is_straight: bool,
}

impl RapidMove {
    fn says_as(&self, other: &RapidMove) -> bool {
        *self == RapidMove { line: self.line, ..other.clone() }
    }
}

/// Largest number of different moves to all elements of an array that are kept: three already disagree.
const MOST: usize = 4;

/// Position of numbers: data and the indices of an element, or a target in a move.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum TargetReference {
    Data(usize, Vec<usize>),
    InPlace(usize),
}

/// A move and its predecessor, if this is always the same.
#[derive(Clone, Debug)]
pub(crate) struct MoveSequence {
    pub(crate) to: TargetReference,
    pub(crate) of: RapidMove,
    pub(crate) after: Option<usize>,
}

/// All moves of a file to targets with numbers, in the order of the text.
#[derive(Clone, Debug, Default)]
pub(crate) struct RapidMoves {
    pub(crate) going: Vec<MoveSequence>,
    /// Moves to any element of an array.
    pub(crate) to_any: HashMap<usize, Vec<RapidMove>>,
    pub(crate) in_place: Vec<(String, RapidValue, bool)>,
}

impl RapidMoves {
    /// Adds a move to declared data. Returns its number, unless it goes to an unknown element.
    pub(crate) fn add_to_data(
        &mut self,
        data: usize,
        indices: Option<Vec<Option<usize>>>,
        of: RapidMove,
        after: Option<usize>,
    ) -> Option<usize> {
        let element: Option<Vec<usize>> = indices.unwrap_or_default().into_iter().collect();
        if let Some(element) = element {
            return Some(self.add(TargetReference::Data(data, element), of, after));
        }
        let any = self.to_any.entry(data).or_default();
        if any.len() < MOST && !any.iter().any(|it| it.says_as(&of)) {
            any.push(of);
        }
        None
    }

    /// Adds a move to a target in its own text. Returns its number.
    pub(crate) fn in_place(
        &mut self,
        name: String,
        value: RapidValue,
        is_joints: bool,
        of: RapidMove,
        after: Option<usize>,
    ) -> usize {
        self.in_place.push((name, value, is_joints));
        self.add(TargetReference::InPlace(self.in_place.len() - 1), of, after)
    }

    fn add(&mut self, to: TargetReference, of: RapidMove, after: Option<usize>) -> usize {
        self.going.push(MoveSequence { to, of, after });
        self.going.len() - 1
    }
}
