//! Blocks of URScript: routines, threads, loops and branches.

use std::collections::{BTreeMap, BTreeSet};

use super::super::flow::Node;
use super::super::scan::{Kind, Rules, Scanner, Token, bracket};
use super::Step;
use crate::error::{Error, ErrorKind, Result};

/// Blocks within blocks.
const DEEPEST: usize = 100;

/// A program in its blocks.
pub(super) struct Program<S> {
    pub(super) main: Vec<Node<S>>,
    pub(super) routines: BTreeMap<String, Vec<Node<S>>>,
    pub(super) called: BTreeSet<String>,
    /// Number of nodes.
    pub(super) size: usize,
    /// Whether a thread moves the robot.
    pub(super) threads_move: bool,
    /// Whether a thread sets the tool.
    pub(super) threads_set: bool,
}

enum Block {
    Routine {
        name: String,
        is_thread: bool,
    },
    Loop,
    /// Arms that are complete, and whether there is one for all other cases.
    Branch(Vec<Vec<Node<Step>>>, bool),
}

/// Puts statements into blocks.
pub(super) struct Blocks {
    /// Open blocks, and the nodes of what is around each.
    open: Vec<(Block, Vec<Node<Step>>)>,
    nodes: Vec<Node<Step>>,
    program: Program<Step>,
}

/// Statements of a line: `if x: movej(q) end` are three.
pub(super) fn cut<'t>(text: &[u8], line: &'t [Token]) -> Vec<&'t [Token]> {
    let mut out = Vec::new();
    let (mut start, mut depth) = (0, 0_usize);
    for (at, token) in line.iter().enumerate() {
        let is_header = line.get(start).is_some_and(|it| HEADERS.iter().any(|word| it.text(text) == *word));
        match token.kind {
            Kind::Sign(b'(' | b'[' | b'{') => depth += 1,
            Kind::Sign(b')' | b']' | b'}') => depth = depth.saturating_sub(1),
            Kind::Sign(b':') if depth == 0 && is_header => {
                out.push(&line[start..=at]);
                start = at + 1;
            }
            Kind::Sign(b';') if depth == 0 => {
                out.push(&line[start..at]);
                start = at + 1;
            }
            Kind::Word if depth == 0 && ["end", "else", "elif"].contains(&token.text(text)) && at > start => {
                out.push(&line[start..at]);
                start = at;
            }
            Kind::Word | Kind::Number(..) | Kind::Text | Kind::Sign(_) | Kind::LineEnd => {}
        }
        if token.kind == Kind::Word && token.text(text) == "end" && depth == 0 && start == at {
            out.push(&line[start..=at]);
            start = at + 1;
        }
    }
    if start < line.len() {
        out.push(&line[start..]);
    }
    out
}

const HEADERS: [&str; 7] = ["def", "thread", "sec", "while", "if", "elif", "else"];

/// Name and parameters of a routine's first line.
pub(super) fn header<'t>(text: &'t [u8], tokens: &'t [Token]) -> Option<(&'t str, &'t [Token])> {
    let [word, name, rest @ ..] = tokens else { return None };
    if !["def", "thread", "sec"].contains(&word.text(text)) {
        return None;
    }
    let parameters = bracket(rest, b'(', b')').map_or(&rest[..0], |it| it.0);
    Some((name.text(text), parameters))
}

impl Blocks {
    /// Reads a text; `statement` makes nodes of each statement and of each condition.
    pub(super) fn read(
        text: &[u8],
        rules: &Rules,
        statement: &mut dyn FnMut(&[Token], &mut Vec<Node<Step>>),
    ) -> Result<Program<Step>> {
        let program = Program {
            main: Vec::new(),
            routines: BTreeMap::new(),
            called: BTreeSet::new(),
            size: 0,
            threads_move: false,
            threads_set: false,
        };
        let mut blocks = Blocks { open: Vec::new(), nodes: Vec::new(), program };
        let mut scanner = Scanner::new(text, rules);
        let mut line = Vec::new();
        while scanner.statement(&mut line).is_some() {
            for tokens in cut(text, &line) {
                blocks.statement(text, tokens, statement)?;
            }
        }
        while !blocks.open.is_empty() {
            blocks.end();
        }
        blocks.program.main = blocks.nodes;
        Ok(blocks.program)
    }

    fn statement(
        &mut self,
        text: &[u8],
        tokens: &[Token],
        make: &mut dyn FnMut(&[Token], &mut Vec<Node<Step>>),
    ) -> Result<()> {
        let Some(first) = tokens.first() else { return Ok(()) };
        let word = first.text(text);
        if self.open.len() >= DEEPEST {
            let message = format!(
                "line {}: found blocks within more than {DEEPEST} others, expected fewer",
                first.line
            );
            return Err(Error::new(ErrorKind::Syntax, message));
        }
        if let Some((name, _)) = header(text, tokens) {
            self.begin(Block::Routine { name: name.to_owned(), is_thread: word == "thread" });
            return Ok(());
        }
        let mut nodes = Vec::new();
        if !matches!(word, "else" | "end" | "break" | "continue" | "halt") && !first.is(b'$') {
            make(tokens, &mut nodes);
        }
        self.program.size += 1 + nodes.len();
        for node in &nodes {
            if let Node::Call(name) = node {
                self.program.called.insert(name.clone());
            }
        }
        self.note_threads(&nodes);
        let acts = !nodes.is_empty();
        match word {
            "while" => {
                self.begin(Block::Loop);
                self.nodes.extend(nodes);
            }
            "if" => {
                self.nodes.extend(nodes);
                self.begin(Block::Branch(Vec::new(), false));
            }
            "elif" | "else" => {
                let is_else = word == "else";
                if let Some((Block::Branch(arms, has_else), _)) = self.open.last_mut() {
                    arms.push(std::mem::take(&mut self.nodes));
                    *has_else |= is_else;
                }
                // A condition that acts has acted if a later one is asked.
                self.nodes.extend(nodes);
                if acts {
                    self.nodes.push(Node::Label);
                }
            }
            "end" => self.end(),
            "break" | "continue" | "return" | "halt" => {
                self.nodes.extend(nodes);
                self.nodes.push(Node::Leave);
            }
            _ => self.nodes.extend(nodes),
        }
        Ok(())
    }

    fn note_threads(&mut self, nodes: &[Node<Step>]) {
        let is_thread = self.open.iter().any(|(it, _)| matches!(it, Block::Routine { is_thread: true, .. }));
        if !is_thread {
            return;
        }
        for node in nodes {
            match node {
                Node::Step(Step::Tool(_) | Step::Moving(_)) => self.program.threads_set = true,
                Node::Step(Step::Move { .. } | Step::Away) => self.program.threads_move = true,
                // What it calls is not looked into.
                Node::Call(_) => (self.program.threads_set, self.program.threads_move) = (true, true),
                Node::Either(_) | Node::Loop(_) | Node::Leave | Node::Label => {}
            }
        }
    }

    fn begin(&mut self, block: Block) {
        self.program.size += 1;
        self.open.push((block, std::mem::take(&mut self.nodes)));
    }

    fn end(&mut self) {
        let Some((block, around)) = self.open.pop() else { return };
        let inside = std::mem::replace(&mut self.nodes, around);
        match block {
            Block::Loop => self.nodes.push(Node::Loop(inside)),
            Block::Branch(mut arms, has_else) => {
                arms.push(inside);
                if !has_else {
                    arms.push(Vec::new());
                }
                self.nodes.push(Node::Either(arms));
            }
            Block::Routine { name, is_thread } => {
                let mut body = inside;
                if is_thread {
                    // It runs beside the program, which may have set any tool.
                    body.insert(0, Node::Step(Step::Tool(super::super::parsed::Setting::Unknown)));
                }
                self.program.routines.insert(name, body);
            }
        }
    }
}
