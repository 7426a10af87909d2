//! Blocks of URScript: routines, threads, loops and branches.

use super::super::build::ProgramBlocks;
use super::super::flow::FlowNode;
use super::super::parsed_program::ActiveFrame;
use super::super::scan::{LexicalRules, Scanner, Token, TokenKind, bracket, is_one_of, outside_brackets};
use super::UrScriptStep;
use poecal_numerics::error::Result;

/// Makes nodes of a statement.
type NodeMaker<'m> = &'m mut dyn FnMut(&[Token], &mut Vec<FlowNode<UrScriptStep>>);

/// A program in its blocks.
pub(crate) struct Program {
    pub(crate) main: Vec<FlowNode<UrScriptStep>>,
    pub(crate) blocks: ProgramBlocks<UrScriptStep>,
    /// True if a thread moves the robot.
    pub(crate) threads_move: bool,
    /// True if a thread sets the tool.
    pub(crate) threads_set: bool,
    /// Number of open blocks around the present thread.
    thread: Option<usize>,
}

/// Statements of a line: `if x: movej(q) end` has three.
pub(crate) fn cut<'t>(text: &[u8], line: &'t [Token]) -> Vec<&'t [Token]> {
    let mut out = Vec::new();
    let mut start = 0;
    for (at, token) in outside_brackets(line) {
        let word = if token.kind == TokenKind::Word { token.text(text) } else { "" };
        let is_header = line.get(start).is_some_and(|it| is_one_of(HEADERS, it.text(text)));
        if token.is(b';') || is_one_of("end else elif", word) && at > start {
            out.push(&line[start..at]);
            start = at + usize::from(word.is_empty());
        }
        if token.is(b':') && is_header || word == "end" && start == at {
            out.push(&line[start..=at]);
            start = at + 1;
        }
    }
    if start < line.len() {
        out.push(&line[start..]);
    }
    out
}

const HEADERS: &str = "def thread sec while if elif else";

/// Name and parameters of a routine's first line.
pub(crate) fn header<'t>(text: &'t [u8], tokens: &'t [Token]) -> Option<(&'t str, &'t [Token])> {
    let [word, name, rest @ ..] = tokens else { return None };
    if !is_one_of("def thread sec", word.text(text)) {
        return None;
    }
    let parameters = bracket(rest, b'(', b')').map_or(&rest[..0], |it| it.0);
    Some((name.text(text), parameters))
}

impl Program {
    /// Reads a text; `make` makes nodes of each statement and of each condition.
    pub(crate) fn read(text: &[u8], rules: &LexicalRules, make: NodeMaker<'_>) -> Result<Self> {
        let blocks = ProgramBlocks::new();
        let mut program = Program { main: Vec::new(), blocks, threads_move: false, threads_set: false, thread: None };
        let mut scanner = Scanner::new(text, rules);
        let mut line = Vec::new();
        while scanner.statement(&mut line).is_some() {
            for tokens in cut(text, &line) {
                program.statement(text, tokens, make)?;
            }
        }
        program.main = program.blocks.finish();
        Ok(program)
    }

    fn statement(&mut self, text: &[u8], tokens: &[Token], make: NodeMaker<'_>) -> Result<()> {
        let Some(first) = tokens.first() else { return Ok(()) };
        let (word, line) = (first.text(text), first.line);
        if let Some((name, _)) = header(text, tokens) {
            let depth = self.blocks.depth();
            self.blocks.begin_routine(name, line)?;
            if word == "thread" {
                // It runs in parallel with the program, which may have set any tool.
                self.thread.get_or_insert(depth);
                self.blocks.push([FlowNode::Step(UrScriptStep::Tool(ActiveFrame::Unknown))]);
            }
            return Ok(());
        }
        let mut nodes = Vec::new();
        if !matches!(word, "else" | "end" | "break" | "continue" | "halt") && !first.is(b'$') {
            make(tokens, &mut nodes);
        }
        self.note_threads(&nodes);
        match word {
            "while" => {
                self.blocks.begin_loop(line)?;
                self.blocks.push(nodes);
            }
            "if" => {
                self.blocks.push(nodes);
                self.blocks.begin_branch(line)?;
            }
            "elif" | "else" => {
                self.blocks.arm(word == "else");
                // A condition with effects has already run when a later one is evaluated.
                let label = (!nodes.is_empty()).then_some(FlowNode::Label);
                self.blocks.push(nodes.into_iter().chain(label));
            }
            "end" => {
                self.blocks.end();
                self.thread = self.thread.filter(|it| self.blocks.depth() > *it);
            }
            "break" | "continue" | "return" | "halt" => {
                self.blocks.push(nodes.into_iter().chain([FlowNode::Leave]));
            }
            _ => self.blocks.push(nodes),
        }
        Ok(())
    }

    fn note_threads(&mut self, nodes: &[FlowNode<UrScriptStep>]) {
        if self.thread.is_none() {
            return;
        }
        for node in nodes {
            match node {
                FlowNode::Step(UrScriptStep::Tool(_) | UrScriptStep::Moving(_)) => self.threads_set = true,
                FlowNode::Step(UrScriptStep::Move { .. } | UrScriptStep::Away) => self.threads_move = true,
                // The called routine is not examined.
                FlowNode::Call(_) => (self.threads_set, self.threads_move) = (true, true),
                FlowNode::Either(_) | FlowNode::Loop(_) | FlowNode::Leave | FlowNode::Label => {}
            }
        }
    }
}
