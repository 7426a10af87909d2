//! Data of RAPID: declarations, their visibility, and their use.

use std::collections::HashMap;

use super::super::scan::{Token, TokenKind, cut, is_one_of};
use super::outline::{RapidOutline, RapidStatement, Routine};
use super::tokens::{ASSIGN, RapidValue, lower_case, token_text, value};

/// Kinds of data that matter here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RapidDataKind {
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
pub(crate) struct AssignedValue {
    pub(crate) line: usize,
    /// Its name in the text.
    pub(crate) to: String,
    pub(crate) is_function: bool,
}

/// Largest number of different routines that are kept for one item.
const MOST_GIVEN: usize = 32;

/// Data by its declaration.
#[derive(Clone, Debug)]
pub(crate) struct DataDeclaration {
    pub(crate) sort: RapidDataKind,
    /// Its name in the text.
    pub(crate) name: String,
    pub(crate) line: usize,
    /// Number of dimensions of an array.
    pub(crate) dimensions: usize,
    pub(crate) value: Option<RapidValue>,
    /// Line of the first statement that changes it.
    pub(crate) changed: Option<usize>,
    /// Routines, instructions and functions that receive it, with the line of each.
    pub(crate) given: Vec<AssignedValue>,
    /// True if another declaration has the same name and visibility.
    pub(crate) is_double: bool,
}

impl DataDeclaration {
    fn new(sort: RapidDataKind, name: String, line: usize) -> Self {
        let (dimensions, value, changed, given) = (0, None, None, Vec::new());
        DataDeclaration { sort, name, line, dimensions, value, changed, given, is_double: false }
    }
}

/// Visibility of data: a routine, a module, everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum DataScope {
    Routine(usize),
    Module(usize),
    Everywhere,
}

/// All data of a file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Declarations {
    pub(crate) data: Vec<DataDeclaration>,
    places: HashMap<(DataScope, String), usize>,
}

impl Declarations {
    /// Reads the declarations among a file's statements.
    pub(crate) fn read(outline: &RapidOutline, tokens: &[Token], text: &[u8]) -> Self {
        let mut out = Declarations::default();
        for (index, routine) in outline.routines.iter().enumerate() {
            for name in &routine.parameters {
                out.add(DataScope::Routine(index), DataDeclaration::new(RapidDataKind::Parameter, name.clone(), 0));
            }
        }
        for statement in &outline.statements {
            let own = tokens.get(statement.tokens.clone()).unwrap_or_default();
            if let Some((data, is_local)) = declaration(own, text) {
                let seen = match statement.routine {
                    Some(routine) => DataScope::Routine(routine),
                    None if is_local => DataScope::Module(statement.module),
                    None => DataScope::Everywhere,
                };
                out.add(seen, data);
            }
        }
        out
    }

    fn add(&mut self, seen: DataScope, data: DataDeclaration) {
        let key = (seen, data.name.to_ascii_lowercase());
        match self.places.get(&key).and_then(|&at| self.data.get_mut(at)) {
            Some(other) => {
                other.is_double = true;
                // The declaration that counts is ambiguous: neither is corrected.
                self.data.push(DataDeclaration { is_double: true, ..data });
            }
            None => {
                self.places.insert(key, self.data.len());
                self.data.push(data);
            }
        }
    }

    /// The data of a name (in lower case) that a statement sees.
    pub(crate) fn find(&self, name: &str, statement: &RapidStatement) -> Option<usize> {
        let routine = statement.routine.map(DataScope::Routine);
        let places = routine.into_iter().chain([DataScope::Module(statement.module), DataScope::Everywhere]);
        places.into_iter().find_map(|seen| self.places.get(&(seen, name.to_owned())).copied())
    }

    /// Records the use of data by a statement, except moves to it.
    pub(crate) fn follow(&mut self, statement: &RapidStatement, tokens: &[Token], text: &[u8]) {
        let own = tokens.get(statement.tokens.clone()).unwrap_or_default();
        if declaration(own, text).is_some() {
            self.note_arguments(own, statement, text);
            return;
        }
        let Some(at) = own.iter().position(|it| it.is(ASSIGN)) else { return };
        // Matches `name := …`, `name.trans.x := …`, `name{3} := …`, but no option of an instruction.
        let head = own.get(..at).unwrap_or_default();
        let is_assignment = head.first().is_some_and(|it| it.kind == TokenKind::Word)
            && (head.len() == 1 || head.get(1).is_some_and(|it| it.is(b'.') || it.is(b'{')));
        if is_assignment && let Some(first) = head.first() {
            self.change(&lower_case(text, first), statement);
            self.note_arguments(own.get(at..).unwrap_or_default(), statement, text);
        }
    }

    /// Records that a statement changes data.
    pub(crate) fn change(&mut self, name: &str, statement: &RapidStatement) {
        if let Some(data) = self.find(name, statement).and_then(|at| self.data.get_mut(at)) {
            data.changed.get_or_insert(statement.line);
        }
    }

    /// Records that a statement passes data to a routine or function.
    pub(crate) fn give(&mut self, name: &str, to: &str, is_function: bool, statement: &RapidStatement) {
        let Some(data) = self.find(name, statement).and_then(|at| self.data.get_mut(at)) else { return };
        let is_known = data.given.iter().any(|it| it.to.eq_ignore_ascii_case(to));
        if !is_known && data.given.len() < MOST_GIVEN {
            data.given.push(AssignedValue { line: statement.line, to: to.to_owned(), is_function });
        }
    }

    /// A receiver that may change a tool or a work object. It is a routine outside the file, or one that changes one of its parameters or passes it
    /// on. Functions of the controller do not.
    pub(crate) fn changes_it<'d>(
        &self,
        data: &'d DataDeclaration,
        outline: &RapidOutline,
    ) -> Option<&'d AssignedValue> {
        let mut routines = data.given.iter().filter(|it| !it.is_function);
        routines.find(|it| {
            let named = |routine: &(usize, &Routine)| it.to.eq_ignore_ascii_case(&routine.1.name);
            let Some((routine, of)) = outline.routines.iter().enumerate().find(named) else { return true };
            let parameter = |name: &String| self.places.get(&(DataScope::Routine(routine), name.clone()));
            let own = of.parameters.iter().filter_map(parameter).filter_map(|&at| self.data.get(at));
            data.given.len() >= MOST_GIVEN || own.into_iter().any(|it| it.changed.is_some() || !it.given.is_empty())
        })
    }

    /// Records the data that functions in an expression receive, except functions that only offset a target or measure it.
    pub(crate) fn note_arguments(&mut self, tokens: &[Token], statement: &RapidStatement, text: &[u8]) {
        let mut open: Vec<Option<String>> = Vec::new();
        for (at, token) in tokens.iter().enumerate() {
            let before = at.checked_sub(1).and_then(|it| tokens.get(it));
            match token.kind {
                TokenKind::Sign(b'(') => {
                    open.push(before.filter(|it| it.kind == TokenKind::Word).map(|it| token_text(text, it)));
                }
                TokenKind::Sign(b')') => {
                    open.pop();
                }
                TokenKind::Word => {
                    let is_field = before.is_some_and(|it| it.is(b'.') || it.is(b'\\'));
                    if let Some(Some(function)) = open.last()
                        && !is_field
                        && !is_one_of(HARMLESS, &function.to_ascii_lowercase())
                    {
                        let function = function.clone();
                        self.give(&lower_case(text, token), &function, true, statement);
                    }
                }
                TokenKind::Number(..) | TokenKind::Text | TokenKind::Sign(_) | TokenKind::LineEnd => {}
            }
        }
    }
}

/// Functions whose result stays right if their target is corrected.
const HARMLESS: &str = "offs reltool distance valtostr";

/// A declaration, and true if it is `LOCAL`.
fn declaration(tokens: &[Token], text: &[u8]) -> Option<(DataDeclaration, bool)> {
    let mut rest = tokens;
    let mut is_local = false;
    let word = |rest: &mut &[Token]| {
        let (first, others) = rest.split_first()?;
        if first.kind != TokenKind::Word {
            return None;
        }
        *rest = others;
        Some((lower_case(text, first), first.clone()))
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
        "robtarget" => RapidDataKind::Target,
        "jointtarget" => RapidDataKind::Joints,
        "tooldata" => RapidDataKind::Tool,
        "wobjdata" => RapidDataKind::WorkObject,
        _ => RapidDataKind::Other,
    };
    let mut dimensions = 0;
    let at = rest.iter().position(|it| it.is(ASSIGN)).unwrap_or(rest.len());
    if let Some([open, inner @ .., close]) = rest.get(..at)
        && open.is(b'{')
        && close.is(b'}')
    {
        dimensions = cut(inner, b',')?.len();
    }
    let is_kept = sort != RapidDataKind::Other;
    let written_value = rest.get(at + 1..).filter(|it| is_kept && !it.is_empty());
    let value = written_value.map(|it| value(it, text, 0));
    Some((
        DataDeclaration { dimensions, value, ..DataDeclaration::new(sort, token_text(text, &name), name.line) },
        is_local,
    ))
}
