//! Data of RAPID: declarations, their visibility, and their use.

use std::collections::HashMap;

use super::super::scan::{Kind, Token, cut, is_one_of};
use super::outline::{Outline, Routine, Statement};
use super::tokens::{ASSIGN, Value, lower, value, written};

/// Kinds of data that matter here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sort {
    Target,
    Joints,
    Tool,
    WorkObject,
    /// A parameter of a routine: its value depends on the call.
    Parameter,
    /// Anything else, which hides data of the same name.
    Other,
}

/// A receiver of data.
#[derive(Clone, Debug)]
pub(crate) struct Given {
    pub(crate) line: usize,
    /// Its name in the text.
    pub(crate) to: String,
    pub(crate) is_function: bool,
}

/// Largest number of different routines that are kept for one item.
const MOST_GIVEN: usize = 32;

/// Data by its declaration.
#[derive(Clone, Debug)]
pub(crate) struct Data {
    pub(crate) sort: Sort,
    /// Its name in the text.
    pub(crate) name: String,
    pub(crate) line: usize,
    /// Number of dimensions of an array.
    pub(crate) dimensions: usize,
    pub(crate) value: Option<Value>,
    /// Line of the first statement that changes it.
    pub(crate) changed: Option<usize>,
    /// Routines, instructions and functions that receive it, with the line of each.
    pub(crate) given: Vec<Given>,
    /// True if another declaration has the same name and visibility.
    pub(crate) is_double: bool,
}

impl Data {
    fn new(sort: Sort, name: String, line: usize) -> Self {
        let (dimensions, value, changed, given) = (0, None, None, Vec::new());
        Data { sort, name, line, dimensions, value, changed, given, is_double: false }
    }
}

/// Visibility of data: a routine, a module, everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Seen {
    Routine(usize),
    Module(usize),
    Everywhere,
}

/// All data of a file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Declared {
    pub(crate) data: Vec<Data>,
    places: HashMap<(Seen, String), usize>,
}

impl Declared {
    /// Reads the declarations among a file's statements.
    pub(crate) fn read(outline: &Outline, tokens: &[Token], text: &[u8]) -> Self {
        let mut out = Declared::default();
        for (index, routine) in outline.routines.iter().enumerate() {
            for name in &routine.parameters {
                out.add(Seen::Routine(index), Data::new(Sort::Parameter, name.clone(), 0));
            }
        }
        for statement in &outline.statements {
            let own = tokens.get(statement.tokens.clone()).unwrap_or_default();
            if let Some((data, is_local)) = declaration(own, text) {
                let seen = match statement.routine {
                    Some(routine) => Seen::Routine(routine),
                    None if is_local => Seen::Module(statement.module),
                    None => Seen::Everywhere,
                };
                out.add(seen, data);
            }
        }
        out
    }

    fn add(&mut self, seen: Seen, data: Data) {
        let key = (seen, data.name.to_ascii_lowercase());
        match self.places.get(&key).and_then(|&at| self.data.get_mut(at)) {
            Some(other) => {
                other.is_double = true;
                // The declaration that counts is ambiguous: neither is corrected.
                self.data.push(Data { is_double: true, ..data });
            }
            None => {
                self.places.insert(key, self.data.len());
                self.data.push(data);
            }
        }
    }

    /// The data of a name (in lower case) that a statement sees.
    pub(crate) fn find(&self, name: &str, statement: &Statement) -> Option<usize> {
        let routine = statement.routine.map(Seen::Routine);
        let places = routine.into_iter().chain([Seen::Module(statement.module), Seen::Everywhere]);
        places.into_iter().find_map(|seen| self.places.get(&(seen, name.to_owned())).copied())
    }

    /// Records the use of data by a statement, except moves to it.
    pub(crate) fn follow(&mut self, statement: &Statement, tokens: &[Token], text: &[u8]) {
        let own = tokens.get(statement.tokens.clone()).unwrap_or_default();
        if declaration(own, text).is_some() {
            self.handed(own, statement, text);
            return;
        }
        let Some(at) = own.iter().position(|it| it.is(ASSIGN)) else { return };
        // Matches `name := …`, `name.trans.x := …`, `name{3} := …`, but no option of an instruction.
        let head = own.get(..at).unwrap_or_default();
        let is_assignment = head.first().is_some_and(|it| it.kind == Kind::Word)
            && (head.len() == 1 || head.get(1).is_some_and(|it| it.is(b'.') || it.is(b'{')));
        if is_assignment && let Some(first) = head.first() {
            self.change(&lower(text, first), statement);
            self.handed(own.get(at..).unwrap_or_default(), statement, text);
        }
    }

    /// Records that a statement changes data.
    pub(crate) fn change(&mut self, name: &str, statement: &Statement) {
        if let Some(data) = self.find(name, statement).and_then(|at| self.data.get_mut(at)) {
            data.changed.get_or_insert(statement.line);
        }
    }

    /// Records that a statement passes data to a routine or function.
    pub(crate) fn give(&mut self, name: &str, to: &str, is_function: bool, statement: &Statement) {
        let Some(data) = self.find(name, statement).and_then(|at| self.data.get_mut(at)) else { return };
        let is_known = data.given.iter().any(|it| it.to.eq_ignore_ascii_case(to));
        if !is_known && data.given.len() < MOST_GIVEN {
            data.given.push(Given { line: statement.line, to: to.to_owned(), is_function });
        }
    }

    /// A receiver that may change a tool or a work object. It is a routine outside the file, or one that changes one of its parameters or passes it
    /// on. Functions of the controller do not.
    pub(crate) fn changes_it<'d>(&self, data: &'d Data, outline: &Outline) -> Option<&'d Given> {
        let mut routines = data.given.iter().filter(|it| !it.is_function);
        routines.find(|it| {
            let named = |routine: &(usize, &Routine)| it.to.eq_ignore_ascii_case(&routine.1.name);
            let Some((routine, of)) = outline.routines.iter().enumerate().find(named) else { return true };
            let parameter = |name: &String| self.places.get(&(Seen::Routine(routine), name.clone()));
            let own = of.parameters.iter().filter_map(parameter).filter_map(|&at| self.data.get(at));
            data.given.len() >= MOST_GIVEN
                || own.into_iter().any(|it| it.changed.is_some() || !it.given.is_empty())
        })
    }

    /// Records the data that functions in an expression receive, except functions that only offset a target or measure it.
    pub(crate) fn handed(&mut self, tokens: &[Token], statement: &Statement, text: &[u8]) {
        let mut open: Vec<Option<String>> = Vec::new();
        for (at, token) in tokens.iter().enumerate() {
            let before = at.checked_sub(1).and_then(|it| tokens.get(it));
            match token.kind {
                Kind::Sign(b'(') => {
                    open.push(before.filter(|it| it.kind == Kind::Word).map(|it| written(text, it)));
                }
                Kind::Sign(b')') => {
                    open.pop();
                }
                Kind::Word => {
                    let is_field = before.is_some_and(|it| it.is(b'.') || it.is(b'\\'));
                    if let Some(Some(function)) = open.last()
                        && !is_field
                        && !is_one_of(HARMLESS, &function.to_ascii_lowercase())
                    {
                        let function = function.clone();
                        self.give(&lower(text, token), &function, true, statement);
                    }
                }
                Kind::Number(..) | Kind::Text | Kind::Sign(_) | Kind::LineEnd => {}
            }
        }
    }
}

/// Functions whose result stays right if their target is corrected.
const HARMLESS: &str = "offs reltool distance valtostr";

/// A declaration, and true if it is `LOCAL`.
fn declaration(tokens: &[Token], text: &[u8]) -> Option<(Data, bool)> {
    let mut rest = tokens;
    let mut is_local = false;
    let word = |rest: &mut &[Token]| {
        let (first, others) = rest.split_first()?;
        if first.kind != Kind::Word {
            return None;
        }
        *rest = others;
        Some((lower(text, first), first.clone()))
    };
    let (mut head, _) = word(&mut rest)?;
    if head == "local" || head == "task" {
        is_local = head == "local";
        head = word(&mut rest)?.0;
    }
    if !is_one_of("const pers var", &head) {
        return None;
    }
    let (kind, _) = word(&mut rest)?;
    let (_, name) = word(&mut rest)?;
    let sort = match kind.as_str() {
        "robtarget" => Sort::Target,
        "jointtarget" => Sort::Joints,
        "tooldata" => Sort::Tool,
        "wobjdata" => Sort::WorkObject,
        _ => Sort::Other,
    };
    let mut dimensions = 0;
    let at = rest.iter().position(|it| it.is(ASSIGN)).unwrap_or(rest.len());
    if let Some([open, inner @ .., close]) = rest.get(..at)
        && open.is(b'{')
        && close.is(b'}')
    {
        dimensions = cut(inner, b',')?.len();
    }
    let is_kept = sort != Sort::Other;
    let written_value = rest.get(at + 1..).filter(|it| is_kept && !it.is_empty());
    let value = written_value.map(|it| value(it, text, 0));
    Some((Data { dimensions, value, ..Data::new(sort, written(text, &name), name.line) }, is_local))
}
