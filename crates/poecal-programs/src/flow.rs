//! The order of statements: calls, branches and loops of a program, followed in the order of execution.

use std::collections::{BTreeMap, BTreeSet};

use super::parsed_program::ActiveFrame;

/// A part of a program. `S` is a statement of the language.
#[derive(Clone, Debug)]
pub(crate) enum FlowNode<S> {
    /// A statement.
    Step(S),
    /// One of several parts; an empty one if none may run.
    Either(Vec<Vec<FlowNode<S>>>),
    /// A part that runs any number of times.
    Loop(Vec<FlowNode<S>>),
    /// A call of a routine by its name.
    Call(String),
    /// The rest of the loop or routine may be skipped here.
    Leave,
    /// A jump may lead here from elsewhere.
    Label,
}

/// State at a point of the program, as far as it is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct FlowState {
    /// The last motion, if it is always this one.
    pub(crate) last: Option<usize>,
    /// The tool.
    pub(crate) tool: ActiveFrame,
    /// The frame.
    pub(crate) frame: ActiveFrame,
}

impl FlowState {
    /// The state after one of two paths.
    fn join(self, other: FlowState) -> FlowState {
        let same = |one: ActiveFrame, other: ActiveFrame| if one == other { one } else { ActiveFrame::Unknown };
        FlowState {
            last: if self.last == other.last { self.last } else { None },
            tool: same(self.tool, other.tool),
            frame: same(self.frame, other.frame),
        }
    }

    /// The state after an unknown routine.
    pub(crate) fn after_unknown_routine(self) -> FlowState {
        let any = |it: ActiveFrame| if it == ActiveFrame::Unset { it } else { ActiveFrame::Unknown };
        FlowState { last: None, tool: any(self.tool), frame: any(self.frame) }
    }
}

/// Largest depth of calls that are followed.
const DEEPEST: usize = 24;
/// Largest depth of loops that are followed twice.
const MOST_LOOPS: usize = 5;

/// Follows a program. `step` is called with each statement in the order of execution, and changes the state.
pub(crate) struct FlowWalk<'w, S> {
    routines: &'w BTreeMap<String, Vec<FlowNode<S>>>,
    /// True if routines outside the file may move the robot and set tools.
    others_act: bool,
    step: &'w mut dyn FnMut(&S, &mut FlowState),
    called: BTreeSet<String>,
    depth: usize,
    loops: usize,
    /// Number of statements that may still be visited.
    left: usize,
    /// Number of changes of tool or frame so far.
    changes: usize,
    leaves: usize,
}

impl<'w, S> FlowWalk<'w, S> {
    /// A walk over a program with these routines, of `size` statements.
    pub(crate) fn new(
        routines: &'w BTreeMap<String, Vec<FlowNode<S>>>,
        size: usize,
        others_act: bool,
        step: &'w mut dyn FnMut(&S, &mut FlowState),
    ) -> Self {
        // Every statement is visited a few times: twice in a loop, and once in each call.
        let left = 8 * size + 10_000;
        FlowWalk {
            routines,
            others_act,
            step,
            called: BTreeSet::new(),
            depth: 0,
            loops: 0,
            left,
            changes: 0,
            leaves: 0,
        }
    }

    /// Follows `main`, then the routines that nothing in the file calls or that others may call, then the rest.
    pub(crate) fn run(&mut self, main: &[FlowNode<S>], called: &BTreeSet<String>, open: &dyn Fn(&str) -> bool) {
        self.part(main, FlowState::default());
        for (name, body) in self.routines {
            if open(name) || !called.contains(name) {
                self.called.insert(name.clone());
                self.routine(body, FlowState::default());
            }
        }
        for (name, body) in self.routines {
            if self.called.insert(name.clone()) {
                self.routine(body, FlowState::default().after_unknown_routine());
            }
        }
    }

    fn part(&mut self, nodes: &[FlowNode<S>], mut state: FlowState) -> FlowState {
        for node in nodes {
            state = self.node(node, state);
        }
        state
    }

    fn node(&mut self, node: &FlowNode<S>, mut state: FlowState) -> FlowState {
        self.left = self.left.saturating_sub(1);
        match node {
            FlowNode::Step(statement) => {
                let before = (state.tool, state.frame);
                (self.step)(statement, &mut state);
                self.changes += usize::from(before != (state.tool, state.frame));
                state
            }
            FlowNode::Either(arms) => {
                let ends: Vec<FlowState> = arms.iter().map(|arm| self.part(arm, state)).collect();
                ends.into_iter().reduce(FlowState::join).unwrap_or(state)
            }
            FlowNode::Loop(body) => self.repeat_body(body, state),
            FlowNode::Call(name) => self.call(name, state),
            FlowNode::Leave => {
                self.leaves += 1;
                state
            }
            FlowNode::Label => state.after_unknown_routine(),
        }
    }

    /// The state after a part that may have been left early.
    fn after_early_exit(&self, changes: usize, state: FlowState) -> FlowState {
        if self.changes > changes { state.after_unknown_routine() } else { FlowState { last: None, ..state } }
    }

    fn repeat_body(&mut self, body: &[FlowNode<S>], state: FlowState) -> FlowState {
        if self.left == 0 || self.loops >= MOST_LOOPS {
            let end = self.part(body, state.after_unknown_routine());
            return state.after_unknown_routine().join(end.after_unknown_routine());
        }
        let (changes, leaves) = (self.changes, self.leaves);
        self.loops += 1;
        let once = self.part(body, state);
        // The second pass begins with the state at the end of the first; a third would equal the second.
        let start = if self.leaves > leaves { self.after_early_exit(changes, once) } else { once };
        let again = if start == state { once } else { self.part(body, start) };
        self.loops -= 1;
        let end = state.join(once).join(again);
        if self.leaves > leaves { self.after_early_exit(changes, end) } else { end }
    }

    fn call(&mut self, name: &str, state: FlowState) -> FlowState {
        let Some(body) = self.routines.get(name) else {
            return if self.others_act { state.after_unknown_routine() } else { state };
        };
        if self.depth >= DEEPEST || self.left == 0 {
            return state.after_unknown_routine();
        }
        if !self.called.contains(name) {
            self.called.insert(name.to_owned());
        }
        self.routine(body, state)
    }

    fn routine(&mut self, body: &[FlowNode<S>], state: FlowState) -> FlowState {
        let (changes, leaves) = (self.changes, std::mem::take(&mut self.leaves));
        self.depth += 1;
        let end = self.part(body, state);
        self.depth -= 1;
        let is_left = std::mem::replace(&mut self.leaves, leaves) > 0;
        if is_left { self.after_early_exit(changes, end) } else { end }
    }
}
