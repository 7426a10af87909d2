//! YAML as its values, each with its keys and its position.

use std::path::Path;

use super::numbers::LARGEST_NUMBER;
use super::yaml_tree::{NodeKind, YamlNode, documents, of_yaml};
use poecal_numerics::error::{Error, ErrorKind, Result};

/// A value of a mapping.
#[derive(Debug)]
pub struct YamlValue {
    /// The keys that lead to it.
    pub keys: Vec<String>,
    /// Its text; for a list, dots in brackets.
    pub(crate) text: String,
    /// True if it is marked as degrees.
    in_degrees: bool,
    line: usize,
    column: usize,
}

impl YamlValue {
    fn new(keys: &[&str], node: &YamlNode, text: &str, in_degrees: bool) -> Self {
        let keys = keys.iter().map(|it| (*it).to_owned()).collect();
        YamlValue { keys, text: text.to_owned(), in_degrees, line: node.line, column: node.column }
    }

    /// An error at the value.
    pub fn error(&self, path: &Path, message: String) -> Error {
        ErrorKind::Model.error(message).at_position(path, self.line, self.column)
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

/// The values of the mappings of a text, in its order; a list is one value, without its entries. `expected` describes the file in messages.
pub fn values(text: &str, path: &Path, expected: &str) -> Result<Vec<YamlValue>> {
    let refuse = |node: &YamlNode, found: &str| {
        let message = format!("found {found}, expected {expected}");
        ErrorKind::Syntax.error(message).at_position(path, node.line, node.column)
    };
    let documents = of_yaml(text, path, (0, expected))?;
    if let Some(second) = documents.get(1) {
        return Err(refuse(second, "a second document"));
    }
    let mut found = Vec::new();
    let Some(root) = documents.first() else { return Ok(found) };
    if let NodeKind::Text(_) = root.kind {
        return Err(refuse(root, "a text alone"));
    }
    let values = values_of(root, (&mut Vec::new(), false), &mut found);
    values.map_err(|(node, words)| refuse(node, &words))?;
    Ok(found)
}

/// Collects the values below a node with these keys; the flag is true if a list contains the node.
fn values_of<'n>(
    node: &'n YamlNode,
    (keys, is_in_list): (&mut Vec<&'n str>, bool),
    found: &mut Vec<YamlValue>,
) -> std::result::Result<(), (&'n YamlNode, String)> {
    match &node.kind {
        NodeKind::Text(text) => {
            let in_degrees = node.is_in_degrees().map_err(|words| (node, words))?;
            found.push(YamlValue::new(keys, node, text, in_degrees));
        }
        NodeKind::List(entries) => {
            if !is_in_list && !keys.is_empty() {
                found.push(YamlValue::new(keys, node, "[...]", false));
            }
            for entry in entries.iter().filter(|it| it.text().is_none()) {
                values_of(entry, (keys, true), found)?;
            }
        }
        NodeKind::Map(entries) => {
            for (key, value) in entries {
                keys.push(key);
                values_of(value, (keys, is_in_list), found)?;
                keys.pop();
            }
        }
    }
    Ok(())
}

/// A number or word of a file with all the keys and list indices that lead to it.
#[derive(Clone, Debug)]
pub struct YamlLeaf {
    /// Keys, and list indices.
    pub path: Vec<String>,
    /// Its text.
    pub text: String,
    /// Its line.
    pub line: usize,
}

/// All numbers and words of a text, including entries of lists; tags are ignored.
pub fn leaves(text: &str, path: &Path, expected: &str) -> Result<Vec<YamlLeaf>> {
    Ok(trees(text, path, expected)?.concat())
}

/// The numbers and words of each document of YAML, or value of JSON.
pub fn trees(text: &str, path: &Path, expected: &str) -> Result<Vec<Vec<YamlLeaf>>> {
    let all = documents(text, path, expected)?;
    let trees = all.iter().map(|document| {
        let mut found = Vec::new();
        leaves_of(document, &mut Vec::new(), &mut found);
        found
    });
    Ok(trees.collect())
}

fn leaves_of(node: &YamlNode, steps: &mut Vec<String>, found: &mut Vec<YamlLeaf>) {
    match &node.kind {
        NodeKind::Text(text) => {
            found.push(YamlLeaf { path: steps.clone(), text: text.clone(), line: node.line });
        }
        NodeKind::List(entries) => {
            for (at, entry) in entries.iter().enumerate() {
                steps.push(at.to_string());
                leaves_of(entry, steps, found);
                steps.pop();
            }
        }
        NodeKind::Map(entries) => {
            for (key, value) in entries {
                steps.push(key.clone());
                leaves_of(value, steps, found);
                steps.pop();
            }
        }
    }
}
