//! Values of URScript that are stated in numbers, and the variables that have them.

use std::collections::{BTreeMap, BTreeSet};

use super::super::axes::ControllerAxes;
use super::super::parsed_program::Number;
use super::super::scan::{LexicalRules, Scanner, Token, TokenKind, bracket, is_one_of, parts, signed_number};
use super::blocks::{cut, header};
use super::reason;

/// Kind and contents of an expression.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum UrScriptValue {
    /// A pose `p[x, y, z, rx, ry, rz]`, all in numbers.
    Pose(Vec<Number>),
    /// A list with a number for each of the robot's readings.
    Joints(Vec<Number>),
    /// A pose or list that is not of numbers only, with the defect.
    Broken(&'static str),
    /// A variable.
    Name(String),
    /// Anything else.
    Other,
}

#[derive(Clone, Debug)]
struct UrScriptVariable {
    assignments: usize,
    line: usize,
    value: UrScriptValue,
}

/// The variables and routines of a program.
#[derive(Clone, Debug, Default)]
pub(crate) struct UrScriptVariables {
    known: BTreeMap<String, UrScriptVariable>,
    /// Names of routines and threads.
    pub(crate) routines: BTreeSet<String>,
}

impl UrScriptVariables {
    /// The variables of a text.
    pub(crate) fn from_text(text: &[u8], rules: &LexicalRules, axes: &ControllerAxes) -> Self {
        let mut out = UrScriptVariables::default();
        let mut scanner = Scanner::new(text, rules);
        let mut line = Vec::new();
        while scanner.statement(&mut line).is_some() {
            for tokens in cut(text, &line) {
                if let Some((name, parameters)) = header(text, tokens) {
                    out.routines.insert(name.to_owned());
                    for parameter in parameters.iter().filter(|it| it.kind == TokenKind::Word) {
                        out.assign(parameter.text(text), parameter.line, UrScriptValue::Other, 2);
                    }
                    continue;
                }
                let rest = match tokens {
                    [word, rest @ ..] if is_one_of("global local", word.text(text)) => rest,
                    all => all,
                };
                let Some(name) = rest.first().filter(|it| it.kind == TokenKind::Word) else { continue };
                if let Some((_, after)) = bracket(&rest[1..], b'[', b']') {
                    if is_assigned(after) {
                        out.assign(name.text(text), name.line, UrScriptValue::Other, 2);
                    }
                } else if is_assigned(&rest[1..]) {
                    let value = out.value(text, &rest[2..], axes);
                    out.assign(name.text(text), name.line, value, 1);
                }
            }
        }
        out
    }

    fn assign(&mut self, name: &str, line: usize, value: UrScriptValue, times: usize) {
        let new = || UrScriptVariable { assignments: 0, line, value };
        self.known.entry(name.to_owned()).or_insert_with(new).assignments += times;
    }

    /// Line in which a variable is assigned.
    pub(crate) fn line(&self, name: &str) -> usize {
        self.known.get(name).map_or(0, |it| it.line)
    }

    /// The value of a variable that is assigned once, or the reason why it has none.
    pub(crate) fn of_name(&self, name: &str) -> Result<UrScriptValue, String> {
        match self.known.get(name) {
            None => Err(reason::ABSENT.to_owned()),
            Some(it) if it.assignments > 1 => Err(reason::SEVERAL.to_owned()),
            Some(it) => Ok(it.value.clone()),
        }
    }

    /// Kind and contents of an expression.
    pub(crate) fn value(&self, text: &[u8], tokens: &[Token], axes: &ControllerAxes) -> UrScriptValue {
        let list = |tokens: &[Token]| {
            let (inside, rest) = bracket(tokens, b'[', b']')?;
            let all = parts(inside);
            let numbers: Option<Vec<Number>> = all.iter().map(|it| element(text, it)).collect();
            rest.is_empty().then_some((all.len(), numbers))
        };
        match tokens {
            [word] if word.kind == TokenKind::Word => UrScriptValue::Name(word.text(text).to_owned()),
            [p, rest @ ..] if p.is_word(text, "p") && !rest.is_empty() => match list(rest) {
                None => UrScriptValue::Other,
                Some((6, Some(numbers))) => UrScriptValue::Pose(numbers),
                Some(_) => UrScriptValue::Broken(reason::EXPRESSIONS),
            },
            _ => match list(tokens) {
                None => UrScriptValue::Other,
                Some((count, _)) if count != axes.count() => UrScriptValue::Broken(reason::COUNT),
                Some((_, numbers)) => numbers.map_or(UrScriptValue::Broken(reason::EXPRESSIONS), UrScriptValue::Joints),
            },
        }
    }
}

fn is_assigned(tokens: &[Token]) -> bool {
    matches!(tokens, [sign, value, ..] if sign.is(b'=') && !value.is(b'='))
}

/// A number, or `d2r(number)`, with its sign.
fn element(text: &[u8], tokens: &[Token]) -> Option<Number> {
    if let Some(number) = signed_number(tokens) {
        return Some(number);
    }
    let (sign, rest) = match tokens {
        [sign, rest @ ..] if sign.is(b'-') => (-1.0, rest),
        all => (1.0, all),
    };
    let [word, rest @ ..] = rest else { return None };
    let (inside, []) = bracket(rest, b'(', b')')? else { return None };
    let number = signed_number(inside).filter(|_| word.text(text) == "d2r")?;
    Some(Number { scale: sign * 1.0_f64.to_radians(), ..number })
}
