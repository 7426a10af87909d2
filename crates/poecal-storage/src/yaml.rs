//! YAML as its values, each with its keys and its place.

use std::collections::BTreeSet;
use std::path::Path;

use granit_parser::{Event, Parser, Span};

use super::numbers::LARGEST_NUMBER;
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_numerics::text::visible;

/// A value of a mapping.
#[derive(Debug)]
pub struct Value {
    /// The keys that lead to it.
    pub keys: Vec<String>,
    /// Its text; of a list, dots in brackets.
    pub(crate) text: String,
    /// Whether it is marked as degrees.
    in_degrees: bool,
    line: usize,
    column: usize,
}

impl Value {
    fn new(open: &[Open], span: &Span, text: &str, in_degrees: bool) -> Self {
        let keys = open.iter().filter_map(Open::key).collect();
        let (line, column) = (span.start.line(), span.start.col() + 1);
        Value { keys, text: text.to_owned(), in_degrees, line, column }
    }

    /// An error at the value.
    pub fn error(&self, path: &Path, message: String) -> Error {
        ErrorKind::Model.error(message).at(path, self.line, self.column)
    }

    /// Its number.
    pub fn number(&self, path: &Path) -> Result<f64> {
        let found = |expected: &str| {
            let message = format!("found `{}` for `{}`, expected {expected}", self.text, self.keys.join("."));
            self.error(path, message)
        };
        let number: f64 = self.text.parse().map_err(|_| found("a number"))?;
        if !number.is_finite() {
            return Err(found("a finite number"));
        }
        if number.abs() > LARGEST_NUMBER {
            return Err(found("a number of metres or radians below 1e6"));
        }
        Ok(if self.in_degrees { number.to_radians() } else { number })
    }
}

/// The values of the mappings of a text, in its order; a list is one without its entries. `expected` describes the file in messages.
pub fn values(text: &str, path: &Path, expected: &str) -> Result<Vec<Value>> {
    let error = |span: &Span, found: &str| {
        ErrorKind::Syntax.error(format!("found {found}, expected {expected}")).at(
            path,
            span.start.line(),
            span.start.col() + 1,
        )
    };
    let mut open: Vec<Open> = Vec::new();
    let mut found = Vec::new();
    let mut has_begun = false;
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|error| {
            let place = error.marker();
            ErrorKind::Syntax
                .error(format!("found broken YAML ({}), expected {expected}", visible(&error.info())))
                .at(path, place.line(), place.col() + 1)
        })?;
        match event {
            Event::Scalar(text, _, _, tag) => {
                let tag = tag.as_ref().map(|tag| (tag.handle(), tag.suffix()));
                let value = scalar(&mut open, &text, tag).map_err(|it| error(&span, &it))?;
                if let Some(in_degrees) = value {
                    found.push(Value::new(&open, &span, &text, in_degrees));
                    close_value(&mut open);
                }
            }
            Event::MappingStart(..) | Event::SequenceStart(..) => {
                if let Some(Open::Map { key: None, .. }) = open.last() {
                    return Err(error(&span, "a key that is no text"));
                }
                if open.len() > DEEPEST {
                    return Err(error(&span, "more than 64 mappings in each other"));
                }
                let is_list = matches!(event, Event::SequenceStart(..));
                if is_list && open.iter().all(|it| matches!(it, Open::Map { .. })) && !open.is_empty() {
                    found.push(Value::new(&open, &span, "[...]", false));
                }
                open.push(if is_list { Open::List } else { Open::Map { key: None, seen: BTreeSet::new() } });
            }
            Event::MappingEnd | Event::SequenceEnd => {
                open.pop();
                close_value(&mut open);
            }
            Event::Alias(_) | Event::UnresolvedAlias(_) => {
                return Err(error(&span, "a reference to another place of the file"));
            }
            Event::DocumentStart(..) if std::mem::replace(&mut has_begun, true) => {
                return Err(error(&span, "a second document"));
            }
            Event::StreamStart
            | Event::StreamEnd
            | Event::DocumentStart(..)
            | Event::DocumentEnd
            | Event::Anchor(..)
            | _ => {}
        }
    }
    Ok(found)
}

/// Most mappings in each other.
const DEEPEST: usize = 64;

/// A mapping or list that has begun.
enum Open {
    Map {
        /// The key whose value comes next.
        key: Option<String>,
        seen: BTreeSet<String>,
    },
    List,
}

impl Open {
    fn key(&self) -> Option<String> {
        match self {
            Open::Map { key, .. } => key.clone(),
            Open::List => None,
        }
    }
}

/// Takes a text where a key or a value comes next; of a value of a mapping, whether it is marked as degrees, and what is wrong with it.
fn scalar(
    open: &mut [Open],
    text: &str,
    tag: Option<(&str, &str)>,
) -> std::result::Result<Option<bool>, String> {
    match open.last_mut() {
        Some(Open::Map { key: key @ None, seen }) => {
            if !seen.insert(text.to_owned()) {
                return Err(format!("the key `{}` twice", visible(text)));
            }
            *key = Some(text.to_owned());
            Ok(None)
        }
        Some(Open::Map { .. }) => match tag {
            // As xacro reads them; others would be other numbers.
            None | Some(("tag:yaml.org,2002:", _) | ("!", "radians")) => Ok(Some(false)),
            Some(("!", "degrees")) => Ok(Some(true)),
            Some((_, name)) => Err(format!("the unknown tag `!{}`", visible(name))),
        },
        Some(Open::List) => Ok(None),
        None => Err("a text alone".to_owned()),
    }
}

/// The value of the innermost key has ended.
fn close_value(open: &mut [Open]) {
    if let Some(Open::Map { key, .. }) = open.last_mut() {
        *key = None;
    }
}

/// A number or word of a file with all the keys and places in lists that lead to it.
#[derive(Clone, Debug)]
pub struct Leaf {
    /// Keys, and numbers of places in lists.
    pub path: Vec<String>,
    /// Its text.
    pub text: String,
    /// Its line.
    pub line: usize,
}

/// All numbers and words of a text, entries of lists too; the directive of OpenCV, which is no YAML, and tags are passed over.
pub fn leaves(text: &str, path: &Path, expected: &str) -> Result<Vec<Leaf>> {
    let text = match text.strip_prefix("%YAML:") {
        Some(rest) => format!("#{rest}"),
        None => text.to_owned(),
    };
    let text = text.replacen("\n---", "\n#--", 1);
    // Each open mapping with the key whose value comes next, each open list with the number of its next entry.
    let mut open: Vec<Nesting> = Vec::new();
    let mut found = Vec::new();
    for event in Parser::new_from_str(&text) {
        let (event, span) = event.map_err(|error| {
            let place = error.marker();
            let message = format!("found broken YAML ({}), expected {expected}", visible(&error.info()));
            Error::new(ErrorKind::Syntax, message).at(path, place.line(), place.col() + 1)
        })?;
        match event {
            Event::Scalar(text, ..) => match open.last_mut() {
                Some(Nesting::Map(key @ None)) => *key = Some(text.to_string()),
                _ => {
                    let keys = open.iter().map(Nesting::step).collect();
                    found.push(Leaf { path: keys, text: text.to_string(), line: span.start.line() });
                    next(&mut open);
                }
            },
            Event::MappingStart(..) | Event::SequenceStart(..) if open.len() > DEEPEST => {
                let message =
                    format!("found more than {DEEPEST} mappings in each other, expected {expected}");
                return Err(Error::new(ErrorKind::Syntax, message).at_line(path, span.start.line()));
            }
            Event::MappingStart(..) => open.push(Nesting::Map(None)),
            Event::SequenceStart(..) => open.push(Nesting::List(0)),
            Event::MappingEnd | Event::SequenceEnd => {
                open.pop();
                next(&mut open);
            }
            Event::StreamStart
            | Event::StreamEnd
            | Event::DocumentStart(..)
            | Event::DocumentEnd
            | Event::Alias(_)
            | Event::UnresolvedAlias(_)
            | Event::Anchor(..)
            | _ => {}
        }
    }
    Ok(found)
}

/// A mapping or list that has begun.
enum Nesting {
    Map(Option<String>),
    List(usize),
}

impl Nesting {
    fn step(&self) -> String {
        match self {
            Nesting::Map(key) => key.clone().unwrap_or_default(),
            Nesting::List(at) => at.to_string(),
        }
    }
}

/// The value of the innermost key or place has ended.
fn next(open: &mut [Nesting]) {
    match open.last_mut() {
        Some(Nesting::Map(key)) => *key = None,
        Some(Nesting::List(at)) => *at += 1,
        None => {}
    }
}
