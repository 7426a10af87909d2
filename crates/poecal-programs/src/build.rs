//! Puts statements into the blocks of a program.

use std::collections::{BTreeMap, BTreeSet};

use super::flow::FlowNode;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::limits::ResourceLimit;

/// A program in its blocks, during and after reading.
#[derive(Clone, Debug)]
pub(crate) struct ProgramBlocks<S> {
    /// Open blocks, each with the nodes of its parent.
    open: Vec<(OpenBlock<S>, Vec<FlowNode<S>>)>,
    nodes: Vec<FlowNode<S>>,
    /// Routines of the program by name.
    pub(crate) routines: BTreeMap<String, Vec<FlowNode<S>>>,
    /// Names that are called.
    pub(crate) called: BTreeSet<String>,
    /// Number of nodes.
    pub(crate) size: usize,
}

#[derive(Clone, Debug)]
enum OpenBlock<S> {
    Routine(String),
    Loop,
    /// Complete arms, and true if there is one for all other cases.
    Branch(Vec<Vec<FlowNode<S>>>, bool),
}

impl<S> ProgramBlocks<S> {
    pub(crate) fn new() -> Self {
        ProgramBlocks {
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
    pub(crate) fn push(&mut self, nodes: impl IntoIterator<Item = FlowNode<S>>) {
        for node in nodes {
            if let FlowNode::Call(name) = &node
                && !self.called.contains(name)
            {
                self.called.insert(name.clone());
            }
            self.size += 1;
            self.nodes.push(node);
        }
    }

    fn begin(&mut self, block: OpenBlock<S>, line: usize) -> Result<()> {
        if self.open.len() >= ResourceLimit::Nesting.most_held() {
            let message = ResourceLimit::Nesting.exceeded_error("blocks in each other");
            return Err(ErrorKind::Syntax.error(message).at_line("program", line));
        }
        self.size += 1;
        self.open.push((block, std::mem::take(&mut self.nodes)));
        Ok(())
    }

    /// Begins a routine.
    pub(crate) fn begin_routine(&mut self, name: &str, line: usize) -> Result<()> {
        self.begin(OpenBlock::Routine(name.to_owned()), line)
    }

    /// Begins a loop.
    pub(crate) fn begin_loop(&mut self, line: usize) -> Result<()> {
        self.begin(OpenBlock::Loop, line)
    }

    /// Begins a branch with its first arm.
    pub(crate) fn begin_branch(&mut self, line: usize) -> Result<()> {
        self.begin(OpenBlock::Branch(Vec::new(), false), line)
    }

    /// Begins another arm of the branch, possibly the one for all other cases.
    pub(crate) fn arm(&mut self, is_else: bool) {
        if let Some((OpenBlock::Branch(arms, has_else), _)) = self.open.last_mut() {
            arms.push(std::mem::take(&mut self.nodes));
            *has_else |= is_else;
        }
    }

    /// Ends a block.
    pub(crate) fn end(&mut self) {
        let Some((block, around)) = self.open.pop() else { return };
        let inside = std::mem::replace(&mut self.nodes, around);
        match block {
            OpenBlock::Loop => self.nodes.push(FlowNode::Loop(inside)),
            OpenBlock::Branch(mut arms, has_else) => {
                arms.push(inside);
                if !has_else {
                    arms.push(Vec::new());
                }
                self.nodes.push(FlowNode::Either(arms));
            }
            OpenBlock::Routine(name) => {
                self.routines.entry(name).or_default().extend(inside);
            }
        }
    }

    /// Ends the text: closes open blocks, and returns the nodes outside of routines.
    pub(crate) fn finish(&mut self) -> Vec<FlowNode<S>> {
        while !self.open.is_empty() {
            self.end();
        }
        std::mem::take(&mut self.nodes)
    }
}
