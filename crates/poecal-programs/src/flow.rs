//! The order of statements: calls, branches and loops of a program, followed in the order of execution.

use std::collections::{BTreeMap, BTreeSet};

use super::parsed::Setting;

/// A part of a program. `S` is a statement of the language.
#[derive(Clone, Debug)]
pub(crate) enum Node<S> {
    /// A statement.
    Step(S),
    /// One of several parts; an empty one if none may run.
    Either(Vec<Vec<Node<S>>>),
    /// A part that runs any number of times.
    Loop(Vec<Node<S>>),
    /// A call of a routine by its name.
    Call(String),
    /// The rest of the loop or routine may be skipped here.
    Leave,
    /// A jump may lead here from elsewhere.
    Label,
}

/// State at a point of the program, as far as it is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct State {
    /// The last motion, if it is always this one.
    pub(crate) last: Option<usize>,
    /// The tool.
    pub(crate) tool: Setting,
    /// The frame.
    pub(crate) frame: Setting,
}

impl State {
    /// The state after one of two paths.
    fn joined(self, other: State) -> State {
        let same = |one: Setting, other: Setting| if one == other { one } else { Setting::Unknown };
        State {
            last: if self.last == other.last { self.last } else { None },
            tool: same(self.tool, other.tool),
            frame: same(self.frame, other.frame),
        }
    }

    /// The state after an unknown routine.
    pub(crate) fn lost(self) -> State {
        let any = |it: Setting| if it == Setting::Unset { it } else { Setting::Unknown };
        State { last: None, tool: any(self.tool), frame: any(self.frame) }
    }
}

/// Largest depth of calls that are followed.
const DEEPEST: usize = 24;
/// Largest depth of loops that are followed twice.
const MOST_LOOPS: usize = 5;

/// Follows a program. `step` is called with each statement in the order of execution, and changes the state.
pub(crate) struct Walk<'w, S> {
    routines: &'w BTreeMap<String, Vec<Node<S>>>,
    /// True if routines outside the file may move the robot and set tools.
    others_act: bool,
    step: &'w mut dyn FnMut(&S, &mut State),
    called: BTreeSet<String>,
    depth: usize,
    loops: usize,
    /// Number of statements that may still be visited.
    left: usize,
    /// Number of changes of tool or frame so far.
    changes: usize,
    leaves: usize,
}

impl<'w, S> Walk<'w, S> {
    /// A walk over a program with these routines, of `size` statements.
    pub(crate) fn new(
        routines: &'w BTreeMap<String, Vec<Node<S>>>,
        size: usize,
        others_act: bool,
        step: &'w mut dyn FnMut(&S, &mut State),
    ) -> Self {
        // Every statement is visited a few times: twice in a loop, and once in each call.
        let left = 8 * size + 10_000;
        Walk {
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
    pub(crate) fn run(&mut self, main: &[Node<S>], called: &BTreeSet<String>, open: &dyn Fn(&str) -> bool) {
        self.part(main, State::default());
        for (name, body) in self.routines {
            if open(name) || !called.contains(name) {
                self.called.insert(name.clone());
                self.routine(body, State::default());
            }
        }
        for (name, body) in self.routines {
            if self.called.insert(name.clone()) {
                self.routine(body, State::default().lost());
            }
        }
    }

    fn part(&mut self, nodes: &[Node<S>], mut state: State) -> State {
        for node in nodes {
            state = self.node(node, state);
        }
        state
    }

    fn node(&mut self, node: &Node<S>, mut state: State) -> State {
        self.left = self.left.saturating_sub(1);
        match node {
            Node::Step(statement) => {
                let before = (state.tool, state.frame);
                (self.step)(statement, &mut state);
                self.changes += usize::from(before != (state.tool, state.frame));
                state
            }
            Node::Either(arms) => {
                let ends: Vec<State> = arms.iter().map(|arm| self.part(arm, state)).collect();
                ends.into_iter().reduce(State::joined).unwrap_or(state)
            }
            Node::Loop(body) => self.repeated(body, state),
            Node::Call(name) => self.call(name, state),
            Node::Leave => {
                self.leaves += 1;
                state
            }
            Node::Label => state.lost(),
        }
    }

    /// The state after a part that may have been left early.
    fn unsure(&self, changes: usize, state: State) -> State {
        if self.changes > changes { state.lost() } else { State { last: None, ..state } }
    }

    fn repeated(&mut self, body: &[Node<S>], state: State) -> State {
        if self.left == 0 || self.loops >= MOST_LOOPS {
            let end = self.part(body, state.lost());
            return state.lost().joined(end.lost());
        }
        let (changes, leaves) = (self.changes, self.leaves);
        self.loops += 1;
        let once = self.part(body, state);
        // The second pass begins with the state at the end of the first; a third would equal the second.
        let start = if self.leaves > leaves { self.unsure(changes, once) } else { once };
        let again = if start == state { once } else { self.part(body, start) };
        self.loops -= 1;
        let end = state.joined(once).joined(again);
        if self.leaves > leaves { self.unsure(changes, end) } else { end }
    }

    fn call(&mut self, name: &str, state: State) -> State {
        let Some(body) = self.routines.get(name) else {
            return if self.others_act { state.lost() } else { state };
        };
        if self.depth >= DEEPEST || self.left == 0 {
            return state.lost();
        }
        if !self.called.contains(name) {
            self.called.insert(name.to_owned());
        }
        self.routine(body, state)
    }

    fn routine(&mut self, body: &[Node<S>], state: State) -> State {
        let (changes, leaves) = (self.changes, std::mem::take(&mut self.leaves));
        self.depth += 1;
        let end = self.part(body, state);
        self.depth -= 1;
        let is_left = std::mem::replace(&mut self.leaves, leaves) > 0;
        if is_left { self.unsure(changes, end) } else { end }
    }
}
