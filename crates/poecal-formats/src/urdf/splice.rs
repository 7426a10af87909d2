//! Changes a text at a few positions; all other bytes stay.

use std::ops::Range;

use super::urdf_joints::JointSpans;
use poecal_storage::numbers::format_shortest;

/// Replacements in a text.
pub(crate) struct Splice<'a> {
    text: &'a str,
    edits: Vec<(Range<usize>, String)>,
}

impl<'a> Splice<'a> {
    pub(crate) fn new(text: &'a str) -> Self {
        Splice { text, edits: Vec::new() }
    }

    fn insert(&mut self, at: usize, new: String) {
        self.edits.push((at..at, new));
    }

    /// Sets an attribute: its value if it has a `range`, otherwise the whole attribute after the element's name.
    fn set(&mut self, range: Option<&Range<usize>>, after_name: usize, name: &str, value: String) {
        match range {
            Some(range) => self.edits.push((range.clone(), value)),
            None => self.insert(after_name, format!(" {name}=\"{value}\"")),
        }
    }

    /// Sets the passed values of `<origin>`, and the element itself if there is none.
    pub(crate) fn set_origin(&mut self, place: &JointSpans, xyz: Option<String>, rpy: Option<String>) {
        if let Some(after_name) = place.origin {
            if let Some(xyz) = xyz {
                self.set(place.xyz.as_ref(), after_name, "xyz", xyz);
            }
            if let Some(rpy) = rpy {
                self.set(place.rpy.as_ref(), after_name, "rpy", rpy);
            }
            return;
        }
        let attribute =
            |name: &str, value: Option<String>| value.map_or(String::new(), |value| format!(" {name}=\"{value}\""));
        let attributes = attribute("xyz", xyz) + &attribute("rpy", rpy);
        let space = self.space_before(place.first_child);
        self.insert(place.first_child, format!("<origin{attributes}/>{space}"));
    }

    /// Sets the joint's type.
    pub(crate) fn set_kind(&mut self, place: &JointSpans, kind: &str) {
        self.edits.extend(place.kind.clone().map(|range| (range, kind.to_owned())));
    }

    /// Sets `<axis xyz>`, and the element itself if there is none.
    pub(crate) fn set_axis(&mut self, place: &JointSpans, xyz: String) {
        match place.axis {
            Some(after_name) => self.set(place.axis_xyz.as_ref(), after_name, "xyz", xyz),
            None => {
                let space = self.space_before(place.first_child);
                self.insert(place.first_child, format!("<axis xyz=\"{xyz}\"/>{space}"));
            }
        }
    }

    /// Adds a link and its fixed joint after a joint's element, with the same indentation. Names are escaped.
    pub(crate) fn add_link(&mut self, after: &JointSpans, parent: &str, link: &str, xyz: &str, rpy: &str) {
        let outer = self.space_before(after.element.start);
        let inner = self.space_before(after.first_child);
        self.insert(
            after.element.end,
            format!(
                "{outer}<link name=\"{link}\"/>{outer}<joint name=\"{link}_joint\" type=\"fixed\">\
                 {inner}<parent link=\"{parent}\"/>{inner}<child link=\"{link}\"/>\
                 {inner}<origin xyz=\"{xyz}\" rpy=\"{rpy}\"/>{outer}</joint>"
            ),
        );
    }

    /// The line break and indentation before a byte.
    fn space_before(&self, at: usize) -> &'a str {
        let before = self.text.get(..at).unwrap_or("");
        let space = before.get(before.trim_end().len()..).unwrap_or("");
        let line_break = space.rfind("\r\n").or_else(|| space.rfind('\n')).unwrap_or(0);
        space.get(line_break..).unwrap_or("")
    }

    /// The changed text.
    pub(crate) fn apply(mut self) -> String {
        // The sort is stable: insertions at one position keep their order.
        self.edits.sort_by_key(|(range, _)| range.start);
        let mut text = String::with_capacity(self.text.len() + 64 * self.edits.len());
        let mut done = 0;
        for (range, new) in &self.edits {
            text.push_str(self.text.get(done..range.start).unwrap_or(""));
            text.push_str(new);
            done = range.end;
        }
        text.push_str(self.text.get(done..).unwrap_or(""));
        text
    }
}

/// Three numbers as an attribute value.
pub(crate) fn format_triple(numbers: [f64; 3]) -> String {
    numbers.map(format_shortest).join(" ")
}

/// A name as an attribute value.
pub fn escape_attribute(name: &str) -> String {
    let mut text = String::with_capacity(name.len());
    for character in name.chars() {
        match character {
            '&' => text.push_str("&amp;"),
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '"' => text.push_str("&quot;"),
            '\t' => text.push_str("&#9;"),
            '\n' => text.push_str("&#10;"),
            '\r' => text.push_str("&#13;"),
            other => text.push(other),
        }
    }
    text
}
