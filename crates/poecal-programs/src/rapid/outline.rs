//! Routines, blocks and statements of RAPID.

use std::ops::Range;

use super::super::scan::{Token, TokenKind, bracket, cut, is_one_of};
use super::tokens::lower_case;

/// A statement that ends with a semicolon, and its position in the outline.
#[derive(Clone, Debug)]
pub(crate) struct RapidStatement {
    /// Its tokens, without the semicolon.
    pub(crate) tokens: Range<usize>,
    pub(crate) line: usize,
    /// Index of its routine.
    pub(crate) routine: Option<usize>,
    pub(crate) module: usize,
    /// Index of its block.
    pub(crate) block: usize,
    /// True if control may come here other than from the statement before: a label, or the end of a block before it.
    pub(crate) is_entry: bool,
}

/// A routine: its name and its parameters, in lower case.
#[derive(Clone, Debug)]
pub(crate) struct Routine {
    pub(crate) name: String,
    pub(crate) parameters: Vec<String>,
}

/// A file by its statements.
#[derive(Clone, Debug, Default)]
pub(crate) struct RapidOutline {
    pub(crate) statements: Vec<RapidStatement>,
    pub(crate) routines: Vec<Routine>,
    /// Blocks, each after the one around it.
    pub(crate) blocks: Vec<StatementBlock>,
}

/// A block of statements: a routine's own, or a branch, a loop, a handler of errors in it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StatementBlock {
    /// The outermost block around it.
    outermost: usize,
    /// The first block after it and those within.
    end: usize,
}

impl RapidOutline {
    /// True if a block is another one or is inside it.
    pub(crate) fn is_in(&self, block: usize, other: usize) -> bool {
        block >= other && self.blocks.get(other).is_some_and(|it| block < it.end)
    }

    /// The outermost block around a block.
    pub(crate) fn outermost_block(&self, block: usize) -> usize {
        self.blocks.get(block).map_or(block, |it| it.outermost)
    }
}

/// Reads a file's statements; heads of routines, loops and branches, which are no statements, only determine positions of statements.
pub(crate) fn outline(tokens: &[Token], text: &[u8]) -> RapidOutline {
    let reader = OutlineReader {
        tokens,
        text,
        at: 0,
        out: RapidOutline { blocks: vec![StatementBlock { outermost: 0, end: 1 }], ..RapidOutline::default() },
        open: vec![0],
        routine: None,
        module: 0,
        is_entry: true,
    };
    reader.all()
}

struct OutlineReader<'a> {
    tokens: &'a [Token],
    text: &'a [u8],
    at: usize,
    out: RapidOutline,
    /// Open blocks, the innermost last.
    open: Vec<usize>,
    routine: Option<usize>,
    module: usize,
    is_entry: bool,
}

impl OutlineReader<'_> {
    fn word(&self, at: usize) -> Option<String> {
        self.tokens.get(at).filter(|it| it.kind == TokenKind::Word).map(|it| lower_case(self.text, it))
    }

    fn is_word(&self, at: usize, words: &str) -> bool {
        self.word(at).is_some_and(|it| is_one_of(words, &it))
    }

    fn is(&self, at: usize, sign: u8) -> bool {
        self.tokens.get(at).is_some_and(|it| it.is(sign))
    }

    fn all(mut self) -> RapidOutline {
        while self.at < self.tokens.len() {
            self.next();
        }
        self.out
    }

    fn next(&mut self) {
        let Some(word) = self.word(self.at) else {
            // A call by a text between percent signs, or the rest of a placeholder.
            if self.is(self.at, b';') {
                self.at += 1
            } else {
                self.statement(self.at)
            }
            return;
        };
        if self.is(self.at + 1, b':') {
            // The word is a label, or `DEFAULT:`.
            if word == "default" {
                self.sibling();
            }
            self.is_entry = true;
            self.at += 2;
        } else {
            self.keyword(&word);
        }
    }

    /// Reads a part that begins with a word.
    fn keyword(&mut self, word: &str) {
        match word {
            "module" => {
                self.module += 1;
                self.at += 2;
                self.skip_brackets();
            }
            "endmodule" | "endproc" | "endfunc" | "endtrap" => {
                self.routine = None;
                self.leave_all();
                self.at += 1;
            }
            "local" | "task" if self.is_word(self.at + 1, "proc func trap record") => {
                self.at += 1;
            }
            "proc" | "trap" => self.routine(self.at + 1),
            "func" => self.routine(self.at + 2),
            "record" => self.skip_behind(|it| it.is_word(it.at, "endrecord")),
            "if" => self.branch(),
            "elseif" => {
                self.sibling();
                self.skip_behind_in_statement("then");
            }
            "else" => {
                self.sibling();
                self.at += 1;
            }
            "for" | "while" => {
                self.enter();
                self.skip_behind_in_statement("do");
            }
            "test" => {
                self.enter();
                self.at += 1;
                self.skip(|it| it.is_word(it.at, "case default endtest") || it.is(it.at, b';'));
            }
            "case" => {
                self.sibling();
                self.skip_behind(|it| it.is(it.at, b':') || it.is(it.at, b';'));
            }
            "endif" | "endfor" | "endwhile" | "endtest" => {
                self.leave();
                self.at += 1;
            }
            "error" | "undo" | "backward" if self.routine.is_some() => {
                // Control may come from anywhere in the routine: a block of its own.
                self.leave_all();
                self.enter();
                self.at += 1;
                self.skip_brackets();
            }
            _ => self.statement(self.at),
        }
    }

    fn enter(&mut self) {
        self.is_entry = true;
        let block = self.out.blocks.len();
        let around = self.open.last().copied().filter(|it| *it != 0);
        let outermost = around.map_or(block, |it| self.out.outermost_block(it));
        self.out.blocks.push(StatementBlock { outermost, end: usize::MAX });
        self.open.push(block);
    }

    fn leave(&mut self) {
        self.is_entry = true;
        if self.open.len() > 1 {
            let end = self.out.blocks.len();
            if let Some(block) = self.open.pop().and_then(|it| self.out.blocks.get_mut(it)) {
                block.end = end;
            }
        }
    }

    /// Leaves all blocks.
    fn leave_all(&mut self) {
        while self.open.len() > 1 {
            self.leave();
        }
    }

    fn sibling(&mut self) {
        self.leave();
        self.enter();
    }

    /// Reads the head of a routine whose name is at an index.
    fn routine(&mut self, at: usize) {
        let name = self.word(at).unwrap_or_default();
        self.at = at + 1;
        let start = self.at + 1;
        self.skip_brackets();
        let inner = self.tokens.get(start..self.at.saturating_sub(1)).unwrap_or_default();
        let mut parameters = Vec::new();
        for part in cut(inner, b',').unwrap_or_default() {
            // Parameters are like `\switch a | switch b`, `VAR num x{*}`: the last word of each is the name.
            for one in part.split(|it| it.is(b'|')) {
                let words = one.iter().take_while(|it| !it.is(b'{')).filter(|it| it.kind == TokenKind::Word);
                parameters.extend(words.last().map(|it| lower_case(self.text, it)));
            }
        }
        self.routine = Some(self.out.routines.len());
        self.out.routines.push(Routine { name, parameters });
        self.leave_all();
        self.enter();
    }

    /// Reads `IF … THEN`, or `IF condition instruction;`.
    fn branch(&mut self) {
        self.enter();
        let mut start = None;
        let mut at = self.at + 1;
        while let Some(token) = self.tokens.get(at) {
            if token.is(b';') {
                break;
            }
            if let Some(word) = self.word(at) {
                if word == "then" {
                    self.at = at + 1;
                    return;
                }
                let is_operator = |word: &str| is_one_of("and or xor not div mod if", word);
                let follows_value = self.tokens.get(at - 1).is_some_and(|before| match before.kind {
                    TokenKind::Word => !is_operator(&lower_case(self.text, before)),
                    TokenKind::Number(..) | TokenKind::Text | TokenKind::Sign(b')' | b'}' | b']') => true,
                    TokenKind::Sign(_) | TokenKind::LineEnd => false,
                });
                if start.is_none() && follows_value && !is_operator(&word) {
                    start = Some(at);
                }
            }
            at += 1;
        }
        self.statement(start.unwrap_or(self.at));
        self.leave();
    }

    /// Reads the statement that begins at an index, to its semicolon.
    fn statement(&mut self, start: usize) {
        let rest = self.tokens.get(start..).unwrap_or_default();
        let end = start + rest.iter().position(|it| it.is(b';')).unwrap_or(rest.len());
        self.out.statements.push(RapidStatement {
            tokens: start..end,
            line: self.tokens.get(start).map_or(0, |it| it.line),
            routine: self.routine,
            module: self.module,
            block: self.open.last().copied().unwrap_or(0),
            is_entry: std::mem::take(&mut self.is_entry),
        });
        self.at = end + 1;
    }

    /// Advances until the condition holds, or to the end.
    fn skip(&mut self, is_end: impl Fn(&Self) -> bool) {
        while self.at < self.tokens.len() && !is_end(self) {
            self.at += 1;
        }
    }

    /// Advances until the condition holds, and beyond this token.
    fn skip_behind(&mut self, is_end: impl Fn(&Self) -> bool) {
        self.skip(is_end);
        self.at += 1;
    }

    /// Advances behind a word, or to the end of the statement.
    fn skip_behind_in_statement(&mut self, word: &str) {
        self.skip(|it| it.is(it.at, b';') || it.is_word(it.at, word));
        self.at += usize::from(self.is_word(self.at, word));
    }

    fn skip_brackets(&mut self) {
        if self.is(self.at, b'(') {
            let rest = self.tokens.get(self.at..).unwrap_or_default();
            self.at = self.tokens.len() - bracket(rest, b'(', b')').map_or(0, |(_, behind)| behind.len());
        }
    }
}
