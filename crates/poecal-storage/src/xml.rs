//! XML texts and the attributes of their elements, with errors that state line and column.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;

use roxmltree::{Attribute, Document, Node, ParsingOptions};

use crate::limits::ResourceLimit;
use crate::numbers::LARGEST_NUMBER;
use poecal_numerics::error::{Error, ErrorKind, Result, position};

/// Largest number of attributes of an element: the parser compares each with all others.
const MOST_ATTRIBUTES: usize = 1000;

/// Byte offset of the first element with more attributes, if there is one.
fn crowded_element(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    // Start of the element, number of closed values, and quote of the current value.
    let (mut element, mut values, mut quote) = (None, 0, None);
    for at in memchr::memchr3_iter(b'<', b'"', b'\'', bytes) {
        match (bytes.get(at), quote) {
            // No value contains this character, even if a quote before it was not closed.
            (Some(b'<'), _) => (element, values, quote) = (Some(at), 0, None),
            (Some(sign), None) => quote = Some(*sign),
            (Some(sign), Some(open)) if *sign == open => {
                quote = None;
                values += 1;
            }
            _ => {}
        }
        if values > MOST_ATTRIBUTES && element.is_some_and(|start| bytes.get(start + 1) != Some(&b'!')) {
            return element;
        }
    }
    None
}

/// Byte offset of the first element beyond the limit of nesting: code that walks through a document may take a stack frame for each level.
fn deepest_element(text: &str) -> Option<usize> {
    let (bytes, most) = (text.as_bytes(), ResourceLimit::Nesting.most_held());
    let (mut at, mut depth) = (0, 0_usize);
    while let Some(open) = memchr::memchr(b'<', bytes.get(at..)?).map(|it| at + it) {
        let rest = text.get(open..)?;
        let skipped = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];
        if let Some((start, end)) = skipped.into_iter().find(|(start, _)| rest.starts_with(start)) {
            at = open + start.len() + rest.get(start.len()..)?.find(end)? + end.len();
            continue;
        }
        // No value of an attribute contains `<`, so that a tag that is not closed ends with the next one.
        let mut end = open + 1;
        let mut quote = None;
        while let Some(byte) = bytes.get(end).filter(|it| **it != b'<' && (**it != b'>' || quote.is_some())) {
            match quote {
                Some(sign) if sign == *byte => quote = None,
                None if matches!(byte, b'"' | b'\'') => quote = Some(*byte),
                _ => {}
            }
            end += 1;
        }
        let is_empty = bytes.get(end - 1) == Some(&b'/') && end > open + 1;
        match bytes.get(open + 1) {
            Some(b'/') => depth = depth.saturating_sub(1),
            Some(b'!') => {}
            _ if is_empty => {}
            _ => depth += 1,
        }
        if depth > most {
            return Some(open);
        }
        at = end;
    }
    None
}

/// A text whose prefixes are all declared. The colon of an undeclared prefix (`<sensor:camera>` in an old `<gazebo>`) is written as `_`. Such names
/// are those of unknown elements, and all byte offsets are kept.
pub fn declare_prefixes(text: &str) -> Cow<'_, str> {
    // A text that will be refused needs no list of its prefixes.
    let colons = if is_beyond(text, ResourceLimit::Elements.value()) { Vec::new() } else { undeclared_prefixes(text) };
    if colons.is_empty() {
        return Cow::Borrowed(text);
    }
    let mut bytes = text.as_bytes().to_vec();
    for at in colons {
        if let Some(byte) = bytes.get_mut(at) {
            *byte = b'_';
        }
    }
    // A colon and an underscore have one byte each.
    String::from_utf8(bytes).map_or(Cow::Borrowed(text), Cow::Owned)
}

/// Byte offsets of the colons behind prefixes of elements and attributes that no `xmlns:` of the text declares.
fn undeclared_prefixes(text: &str) -> Vec<usize> {
    let bytes = text.as_bytes();
    let is_name = |byte: u8| byte.is_ascii_alphanumeric() || b"_-.".contains(&byte) || byte >= 0x80;
    let (mut declared, mut used) = (BTreeSet::from(["xml", "xmlns"]), Vec::new());
    let mut at = 0;
    while let Some(open) = memchr::memchr(b'<', bytes.get(at..).unwrap_or_default()).map(|it| at + it) {
        let rest = text.get(open..).unwrap_or("");
        let skipped = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>"), ("<!", ">")];
        if let Some((_, end)) = skipped.into_iter().find(|(start, _)| rest.starts_with(start)) {
            let Some(length) = rest.find(end) else { break };
            at = open + length + end.len();
            continue;
        }
        // Names of the tag, up to its end; quoted values contain none.
        at = open + 1;
        let mut quote = None;
        while let Some(&byte) = bytes.get(at) {
            match quote {
                Some(sign) => {
                    quote = (byte != sign).then_some(sign);
                    at += 1;
                }
                None if byte == b'>' || byte == b'<' => break,
                None if byte == b'"' || byte == b'\'' => {
                    quote = Some(byte);
                    at += 1;
                }
                None if is_name(byte) => {
                    let length = |from: usize| bytes.iter().skip(from).take_while(|it| is_name(**it)).count();
                    let end = at + length(at);
                    let prefix = text.get(at..end).unwrap_or("");
                    let name = end + 1 + length(end + 1);
                    if bytes.get(end) == Some(&b':') && name > end + 1 {
                        if prefix == "xmlns" {
                            declared.insert(text.get(end + 1..name).unwrap_or(""));
                        }
                        used.push((prefix, end));
                        at = name;
                    } else {
                        at = end;
                    }
                }
                None => at += 1,
            }
        }
    }
    used.retain(|(prefix, _)| !declared.contains(prefix));
    used.into_iter().map(|(_, at)| at).collect()
}

/// True if a text has more signs of elements and attributes than `most` elements need: the parser allocates memory for each before it counts.
fn is_beyond(text: &str, most: u64) -> bool {
    let count = |sign: u8| memchr::memchr_iter(sign, text.as_bytes()).count() as u64;
    count(b'<') > most.saturating_mul(2) || count(b'=') > most.saturating_mul(4)
}

/// An XML text, parsed; `expected` describes it in messages.
pub fn parsed<'a>(text: &'a str, path: &Path, expected: &str) -> Result<Document<'a>> {
    if let Some(offset) = crowded_element(text) {
        return Err(ErrorKind::Syntax
            .error(format!("found an element with more than 1000 attributes, expected {expected}"))
            .at_offset(path, text, offset));
    }
    if let Some(offset) = deepest_element(text) {
        return Err(ErrorKind::Syntax
            .error(ResourceLimit::Nesting.exceeded_error("each other"))
            .at_offset(path, text, offset));
    }
    if is_beyond(text, ResourceLimit::Elements.value()) {
        return Err(ErrorKind::Syntax.error(ResourceLimit::Elements.exceeded_error("an XML file")).in_file(path));
    }
    let nodes_limit = u32::try_from(ResourceLimit::Elements.value()).unwrap_or(u32::MAX);
    let options = ParsingOptions { nodes_limit, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| parser_error(&error, path, expected))
}

/// The name of the first element of a text; `None` if it does not begin as XML.
pub fn root_name(text: &str) -> Option<&str> {
    let mut rest = text.trim_start_matches('\u{feff}').trim_start();
    loop {
        let end = if rest.starts_with("<?") {
            "?>"
        } else if rest.starts_with("<!--") {
            "-->"
        } else if rest.starts_with("<!") {
            ">"
        } else {
            break;
        };
        rest = rest.split_once(end)?.1.trim_start();
    }
    let name = rest.strip_prefix('<')?;
    name.split(|c: char| c.is_whitespace() || c == '>' || c == '/').next()
}

/// The parser's message as one sentence with its position.
fn parser_error(error: &roxmltree::Error, path: &Path, expected: &str) -> Error {
    let place = error.pos();
    let (line, column) = (place.row as usize, place.col as usize);
    ErrorKind::Syntax.error(if let roxmltree::Error::UnknownNamespace(prefix, _) = error {
        format!(
            "found the prefix `{prefix}`, which is declared in another element alone, expected xmlns:{prefix}=\"…\" in the first element too"
        )
    } else if let roxmltree::Error::NodesLimitReached = error {
        ResourceLimit::Elements.exceeded_error("an XML file")
    } else if let roxmltree::Error::DtdDetected = error {
        format!("found a document type definition, expected {expected} without one")
    } else {
        let complaint = error.to_string().replace(&format!(" at {place}"), "");
        format!("found broken XML ({complaint}), expected {expected}")
    }).at_position(path, line, column)
}

/// A parsed XML text and the name of its file.
#[derive(Clone, Copy)]
pub struct XmlSource<'a> {
    /// The parsed text.
    pub document: &'a Document<'a>,
    /// The name of its file.
    pub path: &'a Path,
}

impl<'a> XmlSource<'a> {
    /// An error at a byte offset of the text.
    pub fn error_at(&self, offset: usize, message: String) -> Error {
        ErrorKind::Model.error(message).at_offset(self.path, self.document.input_text(), offset)
    }

    /// An error at the start of an element.
    pub fn error(&self, node: Node<'a, 'a>, message: impl Into<String>) -> Error {
        self.error_at(node.range().start, message.into())
    }

    /// The error at the start of an element, as a result.
    pub fn refuse<T>(&self, node: Node<'a, 'a>, message: impl Into<String>) -> Result<T> {
        Err(self.error(node, message))
    }

    /// The error of a text that is no URDF at all.
    pub fn syntax_error(&self, node: Node<'a, 'a>, message: impl Into<String>) -> Error {
        let text = self.document.input_text();
        ErrorKind::Syntax.error(message).at_offset(self.path, text, node.range().start)
    }

    /// The meaning of a word of an attribute; `of` describes the owner.
    pub fn meaning<T: Copy>(
        &self,
        node: Node<'a, 'a>,
        (name, word): (&str, &str),
        of: &str,
        words: &[(&str, T)],
        expected: &str,
    ) -> Result<T> {
        match words.iter().find(|(it, _)| *it == word) {
            Some((_, meant)) => Ok(*meant),
            None => self.refuse(node, format!("found {name}=\"{word}\" {of}, expected {expected}")),
        }
    }

    /// The first child element of this name.
    pub fn child(self, node: Node<'a, 'a>, name: &'static str) -> Option<Node<'a, 'a>> {
        self.children(node, name).next()
    }

    /// Child elements of this name.
    pub fn children(self, node: Node<'a, 'a>, name: &'static str) -> impl Iterator<Item = Node<'a, 'a>> {
        node.children().filter(move |child| child.is_element() && child.tag_name().name() == name)
    }

    /// The only child of this name: readers differ on which of two counts. A second one with the same values is ignored, unless elements of this
    /// name are rewritten (`anew`).
    pub fn only_child(
        self,
        node: Node<'a, 'a>,
        name: &'static str,
        of: &str,
        anew: bool,
    ) -> Result<Option<Node<'a, 'a>>> {
        let mut children = self.children(node, name);
        let first = children.next();
        let says = |child: Node<'a, 'a>| -> BTreeSet<(&'a str, &'a str)> {
            child.attributes().map(|attribute| (attribute.name(), attribute.value())).collect()
        };
        match children.find(|&second| anew || first.map(says) != Some(says(second))) {
            Some(second) => {
                let line = first.map_or(0, |first| position(self.document.input_text(), first.range().start).0);
                let message = format!(
                    "found a second <{name}> in {of}, expected one: the first is in line {line}, leave one out"
                );
                Err(self.error(second, message))
            }
            None => Ok(first),
        }
    }

    /// A required attribute, not empty; `of` names its owner.
    pub fn require_attribute(&self, node: Node<'a, 'a>, name: &str, of: &str) -> Result<(&'a str, Attribute<'a, 'a>)> {
        match node.attribute_node(name) {
            Some(attribute) if !attribute.value().trim().is_empty() => Ok((attribute.value(), attribute)),
            Some(attribute) => Err(self
                .error_at(attribute.range().start, format!("{of} has an empty attribute `{name}`, expected a value"))),
            None => Err(self.error(node, format!("{of} has no attribute `{name}`, expected {name}=\"...\""))),
        }
    }

    /// The only number of an attribute, if present.
    pub fn number(&self, node: Node<'a, 'a>, name: &str, of: &str) -> Result<Option<f64>> {
        self.numbers::<1>(node, name, of).map(|it| it.map(|[only]| only))
    }

    /// The numbers of an attribute, if present.
    pub fn numbers<const N: usize>(&self, node: Node<'a, 'a>, name: &str, of: &str) -> Result<Option<[f64; N]>> {
        self.numbers_up_to(node, name, of, LARGEST_NUMBER)
    }

    /// The numbers of an attribute that states limits, if present: these may be infinite, or of any size.
    pub fn bounds<const N: usize>(&self, node: Node<'a, 'a>, name: &str, of: &str) -> Result<Option<[f64; N]>> {
        self.numbers_up_to(node, name, of, f64::INFINITY)
    }

    fn numbers_up_to<const N: usize>(
        &self,
        node: Node<'a, 'a>,
        name: &str,
        of: &str,
        largest: f64,
    ) -> Result<Option<[f64; N]>> {
        let Some(attribute) = node.attribute_node(name) else { return Ok(None) };
        let range = attribute.range_value();
        let raw = self.document.input_text().get(range.clone()).unwrap_or("");
        let mut numbers = [0.0; N];
        let mut count = 0;
        let mut offset = range.start;
        for word in raw.split(|character: char| character.is_ascii_whitespace()) {
            if !word.is_empty() {
                let number = self.parsed(word, offset, (name, of), largest)?;
                if let Some(slot) = numbers.get_mut(count) {
                    *slot = number;
                }
                count += 1;
            }
            offset += word.len() + 1;
        }
        if count == N {
            return Ok(Some(numbers));
        }
        let numbers = if N == 1 { "1 number".to_owned() } else { format!("{N} numbers separated by spaces") };
        Err(self.error_at(
            range.start,
            format!("found {count} numbers in `{name}` of {of} (`{}`), expected {numbers}", raw.trim()),
        ))
    }

    fn parsed(&self, word: &str, offset: usize, (name, of): (&str, &str), largest: f64) -> Result<f64> {
        let found =
            |expected: &str| self.error_at(offset, format!("found `{word}` in `{name}` of {of}, expected {expected}"));
        if word.contains("${") || word.contains("$(") {
            return Err(found("a number: this is a xacro file, expand it first with `xacro robot.xacro > robot.urdf`"));
        }
        let number: f64 = word.parse().map_err(|_| found("a number"))?;
        if number.is_nan() || number.is_infinite() && largest.is_finite() {
            return Err(found("a finite number"));
        }
        if number.abs() > largest {
            return Err(found("a number of metres or radians below 1e6"));
        }
        Ok(number)
    }

    /// Byte offset after `<name`, where another attribute can be inserted.
    pub fn after_name(&self, node: Node<'a, 'a>) -> usize {
        let start = node.range().start;
        let tag = self.document.input_text().get(start..).unwrap_or("");
        let length = tag
            .find(|character: char| character.is_whitespace() || character == '/' || character == '>')
            .unwrap_or(tag.len());
        start + length
    }
}

/// Byte range of an attribute's value, without its quotes.
pub fn value_range(node: Node, name: &str) -> Option<Range<usize>> {
    node.attribute_node(name).map(|attribute| attribute.range_value())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits;

    #[test]
    fn prefixes_that_are_declared_nowhere_become_names_of_the_same_length() {
        let text = "<robot xmlns:a=\"u\"><a:b/><!-- <s:x/> --><s:camera t:size='s:1'>s:text</s:camera>\u{b5}</robot>";
        let readable = declare_prefixes(text);
        assert_eq!(
            readable,
            text.replace("<s:camera", "<s_camera").replace("/s:camera", "/s_camera").replace("t:size", "t_size")
        );
        assert!(parsed(&readable, Path::new("r"), "XML").is_ok() && parsed(text, Path::new("r"), "XML").is_err());
        for broken in ["<a:", "<a b:c=\"", "<!-- <a:b>", "<a:b<c:d>", "", "<:a/>", "<a:/>"] {
            assert_eq!(super::declare_prefixes(broken).len(), broken.len());
        }
    }

    #[test]
    fn texts_of_more_elements_than_there_may_be_are_refused_before_they_are_parsed() {
        let few = limits::current_limits().with_limit(ResourceLimit::Elements, 10);
        let of = |inside: &str| {
            let text = format!("<r>{inside}</r>");
            limits::run_with_limits(few, || parsed(&declare_prefixes(&text), Path::new("r"), "XML").map(|_| ()))
        };
        assert!(of(&"<a b='1' c='2'/>".repeat(8)).is_ok());
        for beyond in ["<a/>".repeat(19), "<s:a/>".repeat(19), "<a/>".repeat(11), "= ".repeat(41)] {
            let error = of(&beyond).unwrap_err();
            assert!(error.message().contains("limit `elements`"), "{error}");
        }
        assert!(is_beyond(&"<".repeat(21), 10) && !is_beyond(&"<".repeat(20), 10));
    }

    #[test]
    fn only_an_element_of_very_many_attributes_is_crowded() {
        let attributes = |count: usize| -> String { (0..count).map(|k| format!(" a{k}='\"1'")).collect() };
        let of = |count| format!("<robot>\n<!-- {} --><link{}/></robot>", "\"\" ".repeat(5000), attributes(count));
        assert_eq!(crowded_element(&of(1000)), None);
        let text = of(1001);
        assert_eq!(crowded_element(&text), text.find("<link"));
        assert_eq!(crowded_element("<robot name='r\"><link name=\"a\"/></robot>"), None);
    }
}
