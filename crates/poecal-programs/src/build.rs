//! Puts statements into the blocks of a program.

use std::collections::{BTreeMap, BTreeSet};

use super::flow::Node;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::limits::Limit;

/// A program in its blocks, during and after reading.
#[derive(Clone, Debug)]
pub(crate) struct Blocks<S> {
    /// Open blocks, each with the nodes of its parent.
    open: Vec<(Block<S>, Vec<Node<S>>)>,
    nodes: Vec<Node<S>>,
    /// Routines of the program by name.
    pub(crate) routines: BTreeMap<String, Vec<Node<S>>>,
    /// Names that are called.
    pub(crate) called: BTreeSet<String>,
    /// Number of nodes.
    pub(crate) size: usize,
}

#[derive(Clone, Debug)]
enum Block<S> {
    Routine(String),
    Loop,
    /// Complete arms, and true if there is one for all other cases.
    Branch(Vec<Vec<Node<S>>>, bool),
}

impl<S> Blocks<S> {
    pub(crate) fn new() -> Self {
        Blocks {
            open: Vec::new(),
            nodes: Vec::new(),
            routines: BTreeMap::new(),
            called: BTreeSet::new(),
            size: 0,
        }
    }

    /// Number of open blocks.
    pub(crate) fn depth(&self) -> usize {
        self.open.len()
    }

    /// Adds nodes at the present position.
    pub(crate) fn push(&mut self, nodes: impl IntoIterator<Item = Node<S>>) {
        for node in nodes {
            if let Node::Call(name) = &node
                && !self.called.contains(name)
            {
                self.called.insert(name.clone());
            }
            self.size += 1;
            self.nodes.push(node);
        }
    }

    fn begin(&mut self, block: Block<S>, line: usize) -> Result<()> {
        if self.open.len() >= Limit::Nesting.most_held() {
            let message = Limit::Nesting.exceeded("blocks in each other");
            return Err(ErrorKind::Syntax.error(message).at_line("program", line));
        }
        self.size += 1;
        self.open.push((block, std::mem::take(&mut self.nodes)));
        Ok(())
    }

    /// Begins a routine.
    pub(crate) fn begin_routine(&mut self, name: &str, line: usize) -> Result<()> {
        self.begin(Block::Routine(name.to_owned()), line)
    }

    /// Begins a loop.
    pub(crate) fn begin_loop(&mut self, line: usize) -> Result<()> {
        self.begin(Block::Loop, line)
    }

    /// Begins a branch with its first arm.
    pub(crate) fn begin_branch(&mut self, line: usize) -> Result<()> {
        self.begin(Block::Branch(Vec::new(), false), line)
    }

    /// Begins another arm of the branch, possibly the one for all other cases.
    pub(crate) fn arm(&mut self, is_else: bool) {
        if let Some((Block::Branch(arms, has_else), _)) = self.open.last_mut() {
            arms.push(std::mem::take(&mut self.nodes));
            *has_else |= is_else;
        }
    }

    /// Ends a block.
    pub(crate) fn end(&mut self) {
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
            Block::Routine(name) => {
                self.routines.entry(name).or_default().extend(inside);
            }
        }
    }

    /// Ends the text: closes open blocks, and returns the nodes outside of routines.
    pub(crate) fn finish(&mut self) -> Vec<Node<S>> {
        while !self.open.is_empty() {
            self.end();
        }
        std::mem::take(&mut self.nodes)
    }
}
