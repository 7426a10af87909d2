//! Motions of the section `/MN`.

use std::collections::HashMap;
use std::ops::Range;

use super::super::scan::{Token, TokenKind, excerpt};
use super::super::unchanged_statements::UnchangedStatement;

/// A motion to a position.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FanucMotion {
    pub(crate) line: usize,
    /// True if the path is straight or an arc.
    pub(crate) is_straight: bool,
    /// True for `INC`.
    pub(crate) is_incremental: bool,
    /// True for `COORD` or `RTCP`.
    pub(crate) is_coordinated: bool,
    /// The active user frame and tool, if the statements before determine them.
    pub(crate) frame: Option<u32>,
    pub(crate) tool: Option<u32>,
}

/// Largest number of different motions to positions with a computed number that are kept.
const MOST: usize = 16;

/// Instructions that concern positions.
pub(crate) struct Instructions<'a> {
    text: &'a [u8],
    /// The instruction that has not ended.
    open: Vec<Token>,
    frame: Option<u32>,
    tool: Option<u32>,
    /// Positions and the motions to them, in the order of the text.
    pub(crate) moves: Vec<(u32, FanucMotion)>,
    of_position: HashMap<u32, Vec<usize>>,
    /// Motions to a position whose number is computed.
    any: Vec<FanucMotion>,
    pub(crate) listed: Vec<UnchangedStatement>,
}

impl<'a> Instructions<'a> {
    pub(crate) fn new(text: &'a [u8]) -> Self {
        Instructions {
            text,
            open: Vec::new(),
            frame: None,
            tool: None,
            moves: Vec::new(),
            of_position: HashMap::new(),
            any: Vec::new(),
            listed: Vec::new(),
        }
    }

    /// The motions that may lead to a position.
    pub(crate) fn moves_to(&self, position: u32) -> Vec<&FanucMotion> {
        let own = self.of_position.get(&position).into_iter().flatten();
        own.filter_map(|&it| self.moves.get(it)).map(|(_, of)| of).chain(&self.any).collect()
    }

    /// Reads a line of the section: `12: instruction ;`, or a continuation of the line before.
    pub(crate) fn line(&mut self, line: Range<usize>, number: usize) {
        let bytes = self.text.get(line.clone()).unwrap_or_default();
        let digits = bytes.iter().take_while(|it| it.is_ascii_whitespace() || it.is_ascii_digit()).count();
        if bytes.get(digits) != Some(&b':') {
            return;
        }
        if bytes.iter().take(digits).any(u8::is_ascii_digit) && !self.open.is_empty() {
            // The instruction before has no end.
            let instruction = std::mem::take(&mut self.open);
            self.instruction(&instruction);
        }
        let start = digits + 1;
        let rest = bytes.get(start..).unwrap_or_default().trim_ascii_start();
        // Remarks, and disabled instructions, are ignored.
        if self.open.is_empty() && [b"!".as_slice(), b"//", b"--"].iter().any(|it| rest.starts_with(it)) {
            return;
        }
        for token in super::tokens(self.text, line.start + start..line.end, number) {
            if token.is(b';') {
                let instruction = std::mem::take(&mut self.open);
                self.instruction(&instruction);
            } else if token.kind != TokenKind::LineEnd {
                self.open.push(token);
            }
        }
    }

    fn instruction(&mut self, tokens: &[Token]) {
        let text = self.text;
        let Some(first) = tokens.first() else { return };
        let is = |token: &Token, word: &str| token.is_word(text, word);
        let way = ["J", "L", "C", "A", "S"].iter().find(|it| is(first, it));
        let leads = tokens.get(1).is_some_and(|it| is(it, "P") || is(it, "PR"));
        if let Some(way) = way.filter(|_| leads) {
            self.read_motion(tokens, *way != "J");
            return;
        }
        let set = |name: &str| match tokens {
            [word, equals, value @ ..] if is(word, name) && equals.is(b'=') => Some(super::whole_number(value)),
            [word, ..] if is(word, name) => Some(None),
            _ => None,
        };
        if let Some(frame) = set("UFRAME_NUM") {
            self.frame = frame;
        } else if let Some(tool) = set("UTOOL_NUM") {
            self.tool = tool;
        } else if !is(first, "WAIT") && !is(first, "DO") && !is(first, "RO") && !is(first, "R") {
            // Any other instruction may be a jump target, or set them.
            (self.frame, self.tool) = (None, None);
        }
    }

    fn read_motion(&mut self, tokens: &[Token], is_straight: bool) {
        let text = self.text;
        let has = |word: &str| tokens.iter().any(|it| it.is_word(text, word));
        let line = tokens.first().map_or(0, |it| it.line);
        let of = FanucMotion {
            line,
            is_straight,
            is_incremental: has("INC"),
            is_coordinated: has("COORD") || has("RTCP"),
            frame: self.frame,
            tool: self.tool,
        };
        let offset = ["OFFSET", "TOOL_OFFSET", "VOFFSET"].into_iter().find(|it| has(it));
        let mut rest = tokens.get(1..).unwrap_or_default();
        // An arc's instruction has two positions.
        while let Some((word, after)) = rest.split_first() {
            let inside = super::super::scan::bracket(after, b'[', b']');
            let is_register = word.is_word(text, "PR");
            let (Some((inside, others)), true) = (inside, is_register || word.is_word(text, "P")) else {
                break;
            };
            let length = rest.len() - others.len();
            let name = excerpt(text, rest.get(..length).unwrap_or_default());
            let line = word.line;
            let of = FanucMotion { line, ..of.clone() };
            rest = others;
            let mut list = |reason: &str| {
                self.listed.push(UnchangedStatement { line, name: name.clone(), reason: reason.to_owned() });
            };
            if is_register {
                list("a position register: its value is not in the file");
                continue;
            }
            if offset.is_some() {
                list("displaced by an offset, which is left as it is: at most the position itself is corrected");
            }
            if let Some(position) = inside.get(..1).and_then(super::whole_number) {
                self.of_position.entry(position).or_default().push(self.moves.len());
                self.moves.push((position, of));
                continue;
            }
            let is_known = self.any.iter().any(|it| *it == FanucMotion { line: it.line, ..of.clone() });
            if !is_known && self.any.len() < MOST {
                self.any.push(of);
            }
        }
    }
}
