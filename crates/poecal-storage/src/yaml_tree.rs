//! Documents of YAML and JSON as trees, each part with its position.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::path::Path;

use granit_parser::{Event, Parser, Span};
use serde::de::IgnoredAny;

use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_numerics::text::escape_invisible;

/// Largest depth of nested lists and mappings.
const DEEPEST: usize = 64;

/// A part of a document.
#[derive(Debug)]
pub struct YamlNode {
    /// Kind and content of the part.
    pub kind: NodeKind,
    /// Line of its beginning, from 1.
    pub line: usize,
    /// Column of its beginning.
    pub column: usize,
    /// Its tag: handle and name.
    pub tag: Option<Box<(String, String)>>,
}

/// A text, list or mapping.
#[derive(Debug)]
pub enum NodeKind {
    /// A word or number.
    Text(String),
    /// A list.
    List(Vec<YamlNode>),
    /// Keys with their values.
    Map(Vec<(String, YamlNode)>),
}

impl YamlNode {
    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<&YamlNode> {
        match &self.kind {
            NodeKind::Map(entries) => entries.iter().find(|(own, _)| own == key).map(|(_, node)| node),
            NodeKind::Text(_) | NodeKind::List(_) => None,
        }
    }

    /// The entries of a list; `None` for anything else.
    pub fn list(&self) -> Option<&[YamlNode]> {
        match &self.kind {
            NodeKind::List(entries) => Some(entries),
            NodeKind::Text(_) | NodeKind::Map(_) => None,
        }
    }

    /// The text of a word or number.
    pub fn text(&self) -> Option<&str> {
        match &self.kind {
            NodeKind::Text(text) => Some(text),
            NodeKind::List(_) | NodeKind::Map(_) => None,
        }
    }

    /// True if a number is marked as degrees; an error describes an invalid mark.
    pub(crate) fn is_in_degrees(&self) -> std::result::Result<bool, String> {
        match self.tag.as_ref().map(|tag| (tag.0.as_str(), tag.1.as_str())) {
            // These are xacro's marks; others would mean other numbers.
            None | Some(("tag:yaml.org,2002:", _) | ("!", "radians")) => Ok(false),
            Some(("!", "degrees")) => Ok(true),
            Some((_, name)) => Err(format!("the unknown tag `!{}`", escape_invisible(name))),
        }
    }

    /// An error at its position.
    pub fn error(&self, path: &Path, message: impl Into<String>) -> Error {
        Error::new(ErrorKind::Measurement, message).at_position(path, self.line, self.column)
    }
}

/// All documents of a text: YAML with `---` between them, or JSON, one value after the other. `expected` describes the file in messages.
pub fn documents(text: &str, path: &Path, expected: &str) -> Result<Vec<YamlNode>> {
    let text = text.trim_start_matches('\u{feff}');
    match json_values(text, path, expected)? {
        Some(values) => {
            let mut found = Vec::new();
            for (before, value) in values {
                found.extend(of_yaml(value, path, (before, expected))?);
            }
            Ok(found)
        }
        None => of_yaml(text, path, (0, expected)),
    }
}

/// The values of a text of JSON, each with the number of lines before it; `None` for YAML, which may begin like JSON.
fn json_values<'a>(text: &'a str, path: &Path, expected: &str) -> Result<Option<Vec<(usize, &'a str)>>> {
    if !text.trim_start().starts_with(['{', '[']) {
        return Ok(None);
    }
    let mut values = serde_json::Deserializer::from_str(text).into_iter::<IgnoredAny>();
    let (mut found, mut start, mut lines) = (Vec::new(), 0, 0);
    while let Some(value) = values.next() {
        let rest = text.get(start..).unwrap_or_default();
        if let Err(error) = value {
            let words: String = rest.chars().filter(|it| !it.is_whitespace()).take(3).collect();
            if !words.starts_with("{\"") && words != "[{\"" {
                return Ok(None);
            }
            let message = format!("found broken JSON ({}), expected {expected}", escape_invisible(&error.to_string()));
            return Err(Error::new(ErrorKind::Syntax, message).at_line(path, error.line()));
        }
        let piece = rest.get(..values.byte_offset() - start).unwrap_or_default();
        found.push((lines, piece));
        lines += piece.matches('\n').count();
        start = values.byte_offset();
    }
    Ok(Some(found))
}

impl OpenNode {
    /// True if a key comes next.
    fn wants_key(&self) -> bool {
        matches!(self.node.kind, NodeKind::Map(_)) && self.key.is_none()
    }
}

/// A list or mapping that is still open.
struct OpenNode {
    node: YamlNode,
    /// The key whose value comes next.
    key: Option<String>,
    /// All keys of the mapping.
    seen: BTreeSet<String>,
}

/// The text with its directive as a comment: OpenCV's is invalid YAML, and the parser reads no other.
fn without_directive(text: &str) -> Cow<'_, str> {
    let rest = text.trim_start_matches('\u{feff}').strip_prefix("%YAML");
    rest.map_or(Cow::Borrowed(text), |rest| Cow::Owned(format!("#{rest}")))
}

/// The documents of YAML, with `before` lines above it.
pub(crate) fn of_yaml(text: &str, path: &Path, (before, expected): (usize, &str)) -> Result<Vec<YamlNode>> {
    let refuse = |span: &Span, found: &str| {
        let message = format!("found {found}, expected {expected}");
        let (line, column) = (before + span.start.line(), span.start.col() + 1);
        Err(Error::new(ErrorKind::Syntax, message).at_position(path, line, column))
    };
    let (mut open, mut found): (Vec<OpenNode>, Vec<YamlNode>) = (Vec::new(), Vec::new());
    let text = without_directive(text);
    for event in Parser::new_from_str(&text) {
        let (event, span) = event.map_err(|error| {
            let (place, message) = (error.marker(), escape_invisible(&error.info()).into_owned());
            let message = format!("found broken YAML ({message}), expected {expected}");
            Error::new(ErrorKind::Syntax, message).at_position(path, before + place.line(), place.col() + 1)
        })?;
        let node = |kind: NodeKind| {
            let (line, column) = (before + span.start.line(), span.start.col() + 1);
            YamlNode { kind, line, column, tag: None }
        };
        match event {
            Event::Scalar(text, _, _, tag) => match open.last_mut() {
                Some(OpenNode { node: YamlNode { kind: NodeKind::Map(_), .. }, key: key @ None, seen }) => {
                    if !seen.insert(text.to_string()) {
                        return refuse(&span, &format!("the key `{}` twice", escape_invisible(&text)));
                    }
                    *key = Some(text.to_string());
                }
                _ => {
                    let tag = tag.map(|it| Box::new((it.handle().to_owned(), it.suffix().to_owned())));
                    close(YamlNode { tag, ..node(NodeKind::Text(text.to_string())) }, &mut open, &mut found);
                }
            },
            Event::MappingStart(..) | Event::SequenceStart(..) => {
                if open.last().is_some_and(OpenNode::wants_key) {
                    return refuse(&span, "a key that is no text");
                }
                if open.len() > DEEPEST {
                    return refuse(&span, "more than 64 mappings in each other");
                }
                let is_map = matches!(event, Event::MappingStart(..));
                let kind = if is_map { NodeKind::Map(Vec::new()) } else { NodeKind::List(Vec::new()) };
                open.push(OpenNode { node: node(kind), key: None, seen: BTreeSet::new() });
            }
            Event::MappingEnd | Event::SequenceEnd => {
                if let Some(OpenNode { node, .. }) = open.pop() {
                    close(node, &mut open, &mut found);
                }
            }
            Event::Alias(_) | Event::UnresolvedAlias(_) => {
                return refuse(&span, "a reference to another place of the file");
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

/// Adds a part that has ended to its parent, or to the documents.
fn close(node: YamlNode, open: &mut [OpenNode], found: &mut Vec<YamlNode>) {
    match open.last_mut() {
        None => found.push(node),
        Some(OpenNode { node: outer, key, .. }) => match &mut outer.kind {
            NodeKind::List(entries) => entries.push(node),
            NodeKind::Map(entries) => entries.extend(key.take().map(|key| (key, node))),
            NodeKind::Text(_) => {}
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nodes_of_text(text: &str) -> Vec<YamlNode> {
        documents(text, Path::new("x"), "a message").unwrap()
    }

    #[test]
    fn documents_of_yaml_and_json_are_the_same_trees() {
        for text in [
            "a: {b: [1, 2.5]}\nc: 'd'\n---\na: {b: []}\n---\n",
            "{\"a\": {\"b\": [1,\n\t2.5]}, \"c\": \"d\"}\n{\"a\":{\"b\":[]}}\n",
            "{\n  \"a\": {\"b\": [1, 2.5]},\n  \"c\": \"d\"\n}{\"a\":{\"b\":[]}}",
        ] {
            let found = nodes_of_text(text);
            let list = |at: usize| found[at].get("a").unwrap().get("b").unwrap().list().unwrap();
            assert_eq!(list(0)[1].text(), Some("2.5"), "{text}");
            assert_eq!(found[0].get("c").and_then(YamlNode::text), Some("d"));
            assert!(list(1).is_empty());
        }
        assert_eq!(nodes_of_text("{\"a\":1}\n\n{\"a\":[2]}")[1].get("a").map(|it| it.line), Some(3));
    }

    #[test]
    fn what_is_no_tree_is_told_with_its_place() {
        let deep = format!("{}{}", "[".repeat(80), "]".repeat(80));
        for (text, part) in [
            ("a: *b", "x:1:4: found"),
            ("a: 1\na: 2", "x:2:1: found the key `a` twice"),
            ("{\"a\": ", "x:1:"),
            ("? [a]\n: b", "a key that is no text"),
            (deep.as_str(), "more than 64"),
        ] {
            let error = documents(text, Path::new("x"), "a message").unwrap_err().to_string();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
